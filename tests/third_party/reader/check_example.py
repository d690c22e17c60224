"""The Python reader on the example that the specification prints: it decodes, and no damage to it goes unnoticed."""

import re
from pathlib import Path

import container
import lfslab

SPECIFICATION = Path(lfslab.__file__).parents[1] / "lfslab-1.0.md"


def example() -> bytes:
    dump = re.search(r"```hexdump\n(.*?)```", SPECIFICATION.read_text("utf-8"), re.DOTALL).group(1)
    return bytes.fromhex("".join(line.split(" ", 1)[1] for line in dump.splitlines()))


def is_refused(file: bytes) -> bool:
    try:
        lfslab.LightField(file).digest(0)
    except (ValueError, container.Unsupported):
        return True
    return False


file = example()
texels = lfslab.LightField(file).texels(0)
assert texels.shape == (1, 1, 4, 4, 3) and (texels == [255, 0, 0]).all(), texels
for length in range(len(file)):
    assert is_refused(file[:length]), f"cut to {length} bytes"
assert is_refused(file + b"\0"), "a byte more"
# The minor version may be any (§3.2), but the header's checksum covers it.
for at in range(len(file)):
    for bit in range(8):
        assert is_refused(file[:at] + bytes([file[at] ^ 1 << bit]) + file[at + 1 :]), f"bit {bit} of byte {at}"
