"""The Python reader on the test vectors: it decodes the valid files to their digests and refuses the others, each as it should."""

import json
from pathlib import Path

import container
import lfslab

VECTORS = Path(lfslab.__file__).parents[1] / "vectors"


def digests(field: lfslab.LightField) -> list[str]:
    """XXH64 of all texels of each slab by t, s, v, u, zero where none are stored."""
    return [field.digest(slab) for slab in range(len(field.slabs))]


def outcome(file: bytes) -> tuple[str, str | list[str]]:
    try:
        return "valid", digests(lfslab.LightField(file))
    except container.Unsupported as error:
        return "unsupported", str(error)
    except ValueError as error:
        return "malformed", str(error)


def fault(vector: dict) -> str | None:
    """What the reader says wrongly of a vector."""
    folder = "valid" if vector["valid"] else "invalid"
    kind, found = outcome((VECTORS / folder / f"{vector['name']}.lfslab").read_bytes())
    if vector["valid"]:
        return None if found == vector["digests"] else f"{kind}: {found}"
    # It looks at nothing of texels but that half floats are finite.
    if vector["stage"] == "texels" and "§7.9" not in vector["clauses"]:
        return None if kind == "valid" else f"{kind}: {found}"
    # Its own bounds may come first (§10), and it holds the content of the tile codec to a length as if by §7.5.
    clauses = [*vector["clauses"], "§10"] + ["§7.5"] * ("T.1" in vector["clauses"])
    named = any(str(found).startswith(f"{clause}: ") for clause in clauses)
    expected = "malformed" if vector["refusal"] in ("malformed", "foreign") else "unsupported"
    right = kind == expected or (kind == "unsupported" and str(found).startswith("§10: "))
    return None if named and right else f"{kind}: {found}, not {expected} by {vector['clauses']}"


vectors = json.loads((VECTORS / "index.json").read_text("utf-8"))
faults = {vector["name"]: fault(vector) for vector in vectors}
wrong = [f"{name}: {what}" for name, what in faults.items() if what]
assert vectors and not wrong, "\n".join(wrong)
