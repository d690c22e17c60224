"""`spec/lfslab.ksy`, compiled to Python, on the files in `spec/vectors`.

It has to take every valid file and find in it what our Python reader finds, and to refuse every invalid one that breaks a rule
which the language of Kaitai Struct can express. `kaitai_slab.py`, which decodes by way of it, has to find each slab's texels.

    python check_kaitai.py
"""

import json
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

import numpy as np
from kaitaistruct import KaitaiStruct, KaitaiStructError, ValidationFailedError

import kaitai_slab
import lfslab

SPEC = Path(lfslab.__file__).parents[1]
VECTORS = SPEC / "vectors"

# The message ids of the rules that the description holds a file to, and files that it takes all the same: a checksum is wrong.
EXPRESSED = set(
    """
    foreign header.magic header.version header.truncated header.file-length header.directory-offset header.entry-count
    header.reserved
    entry.tag entry.flags entry.critical entry.packing entry.subject entry.offset entry.stored-length entry.raw-length
    entry.reserved entry.order file.padding file.tail
    geom.cell geom.slab-count geom.face geom.face-order geom.encoding geom.transfer geom.plane geom.axis geom.focal-depth
    geom.tiling geom.reserved geom.length
    crop.length crop.window crop.nothing mask.length mask.bits mask.nothing slab.no-camera
    tile.zstd tile.finite
    meta.count meta.order meta.key meta.value
    """.split()
)
EXCEPTIONS = {"zstd-checksum-wrong"}
# Those of rules that `kaitai_slab.py` holds a file to by itself, and of rules that no reader needs look at (§2.3).
DECODED = set("entry.checksum header.checksum header.directory-checksum tile.zstd tile.codec tile.finite".split())
UNSEEN = {"tile.alpha", "tile.opaque", "tile.padding"}


def compiled(folder: Path) -> type[KaitaiStruct]:
    """The description as a Python class, whose module lies in the folder."""
    script = Path(__file__).parent / "compile.js"
    subprocess.run(["node", str(script), str(SPEC / "lfslab.ksy"), "python", str(folder)], check=True)
    return kaitai_slab.description(folder)


# Kept until the end, so that the lines of an error can be shown.
FOLDER = tempfile.TemporaryDirectory()
DESCRIPTION = compiled(Path(FOLDER.name))


def parse(file: bytes) -> KaitaiStruct:
    """The file with all its instances fetched; an error if the description does not allow it."""
    parsed = DESCRIPTION.from_bytes(file)
    parsed._fetch_instances()
    return parsed


def evaluate(node: object, seen: set[int]) -> None:
    """Asks for every value below a node, as a viewer of files does; fetching leaves out those that are computed."""
    if isinstance(node, list):
        for item in node:
            evaluate(item, seen)
    elif isinstance(node, KaitaiStruct) and id(node) not in seen:
        seen.add(id(node))
        computed = [name for name, member in vars(type(node)).items() if isinstance(member, property)]
        for name in [*vars(node), *computed]:
            if not name.startswith("_"):
                evaluate(getattr(node, name), seen)


def is_refused(file: bytes) -> bool:
    """Whether the description does not allow the file. Any other error is one of the description's own."""
    try:
        parse(file)
    except (ValidationFailedError, EOFError):
        return True
    return False


def facts(parsed: KaitaiStruct) -> list:
    """Slabs, tiles and metadata as the description finds them."""
    slabs = parsed.geom.slabs
    return [
        [
            (s.face, s.texel_encoding, s.plane, s.focal_depth, s.cameras_per_tile_s, s.cameras_per_tile_t, s.stored_cameras)
            for s in slabs
        ],
        [(a.first, a.step, a.count) for s in slabs for a in (s.s, s.t, s.u, s.v)],
        [(s.index, t.number, t.packing, t.raw_length, t.offset) for s in slabs for t in s.tiles],
        {m.key.text: m.value.text for e in parsed.directory if e.tag.text == "META" for m in e.payload.entries},
    ]


def facts_of_reader(light_field: lfslab.LightField) -> list:
    """The same as our Python reader finds them."""
    slabs = light_field.slabs
    return [
        [(s.face, s.encoding, s.plane, s.focal_depth, s.tile_s, s.tile_t, s.stored.sum()) for s in slabs],
        [tuple(a) for s in slabs for a in (s.s, s.t, s.u, s.v)],
        [(slab, tile, e.packing, e.raw, e.offset) for (slab, tile), (e, _) in light_field.tiles.items()],
        light_field.metadata,
    ]


def check_valid(path: Path) -> None:
    file = path.read_bytes()
    parsed = parse(file)
    evaluate(parsed, set())
    found, expected = facts(parsed), facts_of_reader(lfslab.LightField(file))
    assert found == expected, f"{path.name}: {found}, not {expected}"


def digests(file: bytes) -> list[str]:
    """Of each slab, as `kaitai_slab.py` decodes it."""
    slabs = kaitai_slab.light_field(DESCRIPTION, file).geom.slabs
    return [kaitai_slab.digest(kaitai_slab.texels(slab)) for slab in slabs]


def is_decoded(file: bytes) -> bool:
    """Whether `kaitai_slab.py` finds nothing wrong with the file."""
    try:
        digests(file)
    except (KaitaiStructError, EOFError, ValueError):
        return False
    return True


def check_decoded(entry: dict) -> None:
    """`kaitai_slab.py` refuses what it has to, and decodes other files to what the index says or else our reader."""
    name, rule = entry["name"], entry.get("id")
    file = (VECTORS / ("valid" if entry["valid"] else "invalid") / f"{name}.lfslab").read_bytes()
    if rule in DECODED:
        assert not is_decoded(file), entry
    elif entry["valid"] or rule in UNSEEN:
        expected = entry.get("digests") or [lfslab.LightField(file).digest(0)]
        found = digests(file)
        assert found == expected, f"{name}: {found}, not {expected}"


def check_command() -> None:
    """The program `kaitai_slab.py` writes and prints what our reader finds."""
    file, out = VECTORS / "valid" / "mixed-encodings.lfslab", Path(FOLDER.name) / "texels.npy"
    command = [sys.executable, kaitai_slab.__file__, FOLDER.name, str(file), "--slab", "2", "--digest", "--out", str(out)]
    printed = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout
    light_field = lfslab.LightField(file.read_bytes())
    assert printed.split() == [light_field.digest(2)], printed
    assert np.array_equal(np.load(out), light_field.texels(2))


def check_invalid(entries: list[dict]) -> None:
    """Prints how many of the invalid files the description refuses, and which rules are beyond it."""
    refused, taken = Counter(), Counter()
    for entry in entries:
        is_seen = is_refused((VECTORS / "invalid" / f"{entry['name']}.lfslab").read_bytes())
        assert is_seen or entry["id"] not in EXPRESSED or entry["name"] in EXCEPTIONS, entry
        (refused if is_seen else taken)[entry["id"]] += 1
    assert refused.keys() >= EXPRESSED, f"no file breaks {EXPRESSED - refused.keys()}"
    ids = f"{len(EXPRESSED)} of {len(refused | taken)} message ids"
    print(f"{refused.total()} of {len(entries)} invalid files refused, among them those of {ids}")
    print("taken:", ", ".join(f"{count} {rule}" for rule, count in sorted(taken.items())))


def main() -> None:
    index = json.loads((VECTORS / "index.json").read_text("utf-8"))
    valid = [entry for entry in index if entry["valid"]]
    for entry in valid:
        check_valid(VECTORS / "valid" / f"{entry['name']}.lfslab")
    print(f"{len(valid)} valid files parsed")
    for entry in index:
        check_decoded(entry)
    check_command()
    slabs = sum(len(entry["digests"]) for entry in valid)
    print(f"{slabs} slabs of valid files decoded")
    check_invalid([entry for entry in index if not entry["valid"]])


main()
