"""The list of samples that `lf-exchange/examples/export_samples.rs` writes."""

import json
import sys
from pathlib import Path

FOLDER = Path(sys.argv[1])


def samples(*kinds: str) -> list[dict]:
    """The samples of some kinds; there has to be one at least."""
    found = [s for s in json.loads((FOLDER / "samples.json").read_text())["samples"] if s["kind"] in kinds]
    assert found, f"no samples of {kinds}"
    return found
