"""DDS files as OpenImageIO reads them: kind, size, colour space, and every texel of the first slice or layer.

As of 3.2.2 OpenImageIO leaves all other slices of any volume black, reads one layer of arrays, and no half floats. The crate
`dds` reads all of these in `lf-exchange/tests/volumes.rs`; here their bytes are compared as they are stored.

    python check_dds.py SAMPLES
"""

import numpy as np
import OpenImageIO as oiio

from samples import FOLDER, samples


def decode_bc1(blocks: np.ndarray, width: int, height: int) -> np.ndarray:
    """Texels of one slice of opaque blocks, from the definition of BC1."""
    out = np.zeros((height, width, 3), np.float64)
    for i, block in enumerate(blocks.reshape(-1, 8)):
        ends = [int(block[0]) | int(block[1]) << 8, int(block[2]) | int(block[3]) << 8]
        colors = np.array([[(c >> 11) * 255 / 31, (c >> 5 & 63) * 255 / 63, (c & 31) * 255 / 31] for c in ends])
        palette = np.array([[1, 0], [0, 1], [2 / 3, 1 / 3], [1 / 3, 2 / 3]]) @ colors
        x, y = i % (width // 4) * 4, i // (width // 4) * 4
        for row in range(4):
            for column in range(4):
                out[y + row, x + column] = palette[int(block[4 + row]) >> 2 * column & 3]
    return out


def check(sample: dict) -> None:
    width, height, depth = sample["size"]
    volume = sample["kind"] == "dds-volume"
    dds = oiio.ImageInput.open(str(FOLDER / sample["file"]))
    assert dds, oiio.geterror()
    spec = dds.spec()
    assert (spec.width, spec.height, spec.depth) == (width, height, depth if volume else 1), spec
    assert spec.getattribute("textureformat") == ("Volume Texture" if volume else "Plain Texture")
    assert "srgb" in spec.getattribute("oiio:ColorSpace").lower()
    seen = np.asarray(dds.read_image("uint8")).reshape(spec.depth, height, width, -1).astype(np.float64)
    expected = np.frombuffer((FOLDER / sample["expected"]).read_bytes(), np.uint8).reshape(depth, -1)
    if sample["format"] == "bc1":
        # Decoders round in their own ways.
        assert np.abs(seen[0, :, :, :3] - decode_bc1(expected[0], width, height)).max() <= 1.01
    else:
        assert np.array_equal(seen[0], expected[0].reshape(height, width, 4))


for each in samples("dds-volume", "dds-array"):
    if each["format"] != "rgba16f":
        check(each)
    # Four bytes, a header of 124 and one of 20.
    assert (FOLDER / each["file"]).read_bytes()[148:] == (FOLDER / each["expected"]).read_bytes()
    print(each["file"], "ok")
