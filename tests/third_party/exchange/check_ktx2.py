"""KTX2 files as ktx-parse reads them and zstd unpacks them: header, descriptor, and every byte of every slice.

    python check_ktx2.py SAMPLES
"""

import base64
import json
import subprocess
from pathlib import Path

import zstandard

from samples import FOLDER, samples

# From the Khronos Data Format Specification and vulkan_core.h: vkFormat, typeSize, colorModel, transferFunction, edge of a
# block less 1, bytes of a block, and (offset, length less 1, channel and qualifiers, lower, upper) of the samples.
FLOATS = (0xBF800000, 0x3F800000)
FORMATS = {
    "bc1": (132, 1, 128, 2, 3, 8, [(0, 63, 0, 0, 0xFFFFFFFF)]),
    "rgba8": (43, 1, 1, 2, 0, 4, [(0, 7, 0, 0, 255), (8, 7, 1, 0, 255), (16, 7, 2, 0, 255), (24, 7, 15 + 16, 0, 255)]),
    "rgba16f": (97, 2, 1, 1, 0, 8, [(16 * i, 15, 0xC0 + c, *FLOATS) for i, c in enumerate((0, 1, 2, 15))]),
}


def dump(file: Path) -> dict:
    command = ["node", str(Path(__file__).parent / "ktx2_dump.mjs"), str(file)]
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)


def check(sample: dict) -> None:
    ktx, (width, height, depth) = dump(FOLDER / sample["file"]), sample["size"]
    vk_format, type_size, model, transfer, edge, block_bytes, channels = FORMATS[sample["format"]]
    assert (ktx["vkFormat"], ktx["typeSize"]) == (vk_format, type_size), ktx
    assert (ktx["pixelWidth"], ktx["pixelHeight"], ktx["pixelDepth"]) == (width, height, depth), ktx
    assert (ktx["layerCount"], ktx["faceCount"], ktx["levelCount"]) == (0, 1, 1), ktx
    assert ktx["supercompressionScheme"] == (2 if sample["zstd"] else 0), ktx
    assert list(ktx["keyValue"]) == ["KTXorientation", "KTXwriter"] and ktx["keyValue"]["KTXorientation"] == "rdi"
    (dfd,) = ktx["dataFormatDescriptor"]
    assert (dfd["colorModel"], dfd["colorPrimaries"], dfd["transferFunction"], dfd["flags"]) == (model, 1, transfer, 0)
    assert dfd["texelBlockDimension"] == [edge, edge, 0, 0], dfd
    assert dfd["bytesPlane"] == [block_bytes, 0, 0, 0, 0, 0, 0, 0], dfd
    names = ("bitOffset", "bitLength", "channelType", "sampleLower", "sampleUpper")
    found = [tuple(channel[name] & 0xFFFFFFFF for name in names) for channel in dfd["samples"]]
    assert found == channels, found
    (level,) = ktx["levels"]
    data, expected = base64.b64decode(level["data"]), (FOLDER / sample["expected"]).read_bytes()
    assert level["uncompressedByteLength"] == len(expected)
    if sample["zstd"]:
        data = zstandard.ZstdDecompressor().decompress(data)
    slice_bytes = len(expected) // depth
    for z in range(depth):
        part = slice(z * slice_bytes, (z + 1) * slice_bytes)
        assert data[part] == expected[part], f"slice {z}"
    assert len(data) == len(expected)


for each in samples("ktx2"):
    check(each)
    print(each["file"], "ok")
