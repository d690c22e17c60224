"""Decodes a slab of an `.lfslab` file by way of `../lfslab.ksy`. It needs kaitaistruct, numpy, zstandard and xxhash.

    kaitai-struct-compiler --target python --outdir COMPILED ../lfslab.ksy
    python kaitai_slab.py COMPILED FILE --slab N --out N.npy    the texels of a slab
    python kaitai_slab.py COMPILED FILE --slab N --digest       a checksum of them

The description says what lies where. What it cannot do is done here: checksums are compared, tiles are unpacked, and the
windows of their pictures put in place. Rules for what a slab does not need are not looked at; `lfslab.py` holds a file to all.
"""

import argparse
import importlib.util
import math
import sys
from collections.abc import Iterator
from itertools import accumulate
from pathlib import Path

import numpy as np
import xxhash
from kaitaistruct import KaitaiStruct, KaitaiStructError

import bc1
import tile_codec
import zstd_frame

DTYPE = {"bc1": np.dtype("u1"), "rgba8": np.dtype("u1"), "rgb16f": np.dtype("<f2")}
MAX_VALUES = 1 << 32  # of a slab, left out or not; this reader's own bound, §10


def description(folder: Path) -> type[KaitaiStruct]:
    """The compiled description in a folder, under a name that is not that of our own reader."""
    spec = importlib.util.spec_from_file_location("lfslab_ksy", folder / "lfslab.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.Lfslab


def light_field(lfslab: type[KaitaiStruct], file: bytes) -> KaitaiStruct:
    """The file as `lfslab` describes it, with the right checksums (§3.7, §3.8, §4.8)."""
    parsed = lfslab.from_bytes(file)
    header, directory = parsed.header, file[64 : 64 + 48 * parsed.header.entry_count]
    covered = [(header.header_checksum, file[:56]), (header.directory_checksum, directory)]
    for e in parsed.directory:
        head, payload = directory[48 * e.index :][:16], file[e.offset : e.offset + e.stored_length]
        covered.append((e.checksum, head + payload))
    if any(xxhash.xxh64_intdigest(content) != checksum for checksum, content in covered):
        raise ValueError("§2.3: a checksum is wrong")
    return parsed


def texels(slab: KaitaiStruct) -> np.ndarray:
    """The texels [t, s, v, u, channel] of a slab, red, green and blue as they are stored; zero where none are stored."""
    shape = [axis.count for axis in (slab.t, slab.s, slab.v, slab.u)] + [3]
    if math.prod(shape) > MAX_VALUES:
        raise ValueError("§10: more texels than this reader takes")
    texels = np.zeros(shape, DTYPE[slab.texel_encoding.name])
    all_columns, all_rows = windows(slab)
    for tile in slab.tiles:
        columns, rows = all_columns[tile.first_s : tile.last_s + 1], all_rows[tile.first_t : tile.last_t + 1]
        image = picture(slab, tile, columns, rows)
        for t, (v, y) in enumerate(spans(rows, slab.v.count), tile.first_t):
            for s, (u, x) in enumerate(spans(columns, slab.u.count), tile.first_s):
                if slab.mask is None or slab.mask.stored[t * slab.s.count + s]:
                    texels[t, s, v, u] = image[y, x]
    return texels


def windows(slab: KaitaiStruct) -> tuple[list[range], ...]:
    """The windows of a slab's columns and rows, in blocks (§6.1)."""
    if slab.crop is None:
        return [range(slab.blocks_u)] * slab.s.count, [range(slab.blocks_v)] * slab.t.count
    return tuple([range(w.first, w.first + w.blocks) for w in axis] for axis in (slab.crop.columns, slab.crop.rows))


def spans(windows: list[range], count: int) -> Iterator[tuple[slice, slice]]:
    """Which of an image's `count` texels each window has, and where they lie in the picture (§7.2)."""
    for window, before in zip(windows, accumulate(map(len, windows), initial=0)):
        start, stop = 4 * window.start, min(4 * window.stop, count)
        yield slice(start, stop), slice(4 * before, 4 * before + stop - start)


def picture(slab: KaitaiStruct, tile: KaitaiStruct, columns: list[range], rows: list[range]) -> np.ndarray:
    """The picture [y, x, channel] of a tile (§7.2)."""
    raw = tile._root.directory[tile.index].payload
    if tile.packing.name == "zstd":
        raw = zstd_frame.unpack(raw, range(tile.raw_length, tile.raw_length + 1))
    elif tile.packing.name == "tile_codec":
        raw = tile_codec.decode(raw, columns, rows)
    encoding = slab.texel_encoding.name
    if encoding == "bc1":
        return bc1.decode(raw, tile.blocks_wide, tile.blocks_high)
    picture = np.frombuffer(raw, DTYPE[encoding]).reshape(4 * tile.blocks_high, 4 * tile.blocks_wide, -1)
    if not np.isfinite(picture).all():
        raise ValueError("§7.9: a texel is not finite")
    return picture[..., :3]


def digest(texels: np.ndarray) -> str:
    """XXH64 of all texels by t, s, v, u, zero where one is not stored: the digest of `spec/vectors`."""
    return xxhash.xxh64(texels.tobytes()).hexdigest()


def main() -> None:
    parser = argparse.ArgumentParser(description="Decodes a slab of an .lfslab file.")
    parser.add_argument("compiled", type=Path, help="the folder of lfslab.ksy compiled to Python")
    parser.add_argument("file", type=Path)
    parser.add_argument("--slab", type=int, choices=range(6), default=0, help="its number")
    parser.add_argument("--out", type=Path, help="write the texels [t, s, v, u, channel] here, as .npy")
    parser.add_argument("--digest", action="store_true", help="print XXH64 of the texels")
    arguments = parser.parse_args()
    try:
        slabs = light_field(description(arguments.compiled), arguments.file.read_bytes()).geom.slabs
        if arguments.slab >= len(slabs):
            raise ValueError(f"there is no slab {arguments.slab}, the last one is {len(slabs) - 1}")
        decoded = texels(slabs[arguments.slab])
    except (KaitaiStructError, EOFError, ValueError) as error:
        sys.exit(f"{arguments.file}: {error}")
    if arguments.out:
        np.save(arguments.out, decoded)
    if arguments.digest:
        print(digest(decoded))


if __name__ == "__main__":
    main()
