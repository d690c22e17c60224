"""A reader of `.lfslab` files, written from their specification (`lfslab-1.0.md`) alone. It needs numpy, zstandard and xxhash.

    python lfslab.py FILE                         what the file holds
    python lfslab.py FILE --slab N --out N.npy    the texels of a slab
    python lfslab.py FILE --digest                a checksum of each slab's texels

A file that breaks a rule raises `ValueError`, one that this reader does not know enough for raises `container.Unsupported`;
both name the clause.
"""

import argparse
import math
import sys
from itertools import accumulate
from pathlib import Path

import numpy as np
import xxhash

import bc1
import container
import content
import tile_codec
import zstd_frame
from container import require, support

DTYPE = {1: np.dtype("u1"), 2: np.dtype("u1"), 3: np.dtype("<f2")}
MAX_VALUES = 1 << 32  # of a slab, left out or not; this reader's own bound, §10


class LightField:
    """An opened file: everything that §3 to §6 and §8 say has been checked, and the checksums of all tiles."""

    def __init__(self, file: bytes):
        entries = container.directory(file)
        chunks = [(entry, container.payload(file, entry)) for entry in entries if entry.tag in container.FLAGS]
        self.slabs = content.geometry(chunks[0][1])
        self.metadata: dict[str, str] = {}
        self.tiles: dict[tuple[int, int], tuple[container.Entry, bytes]] = {}
        for entry, chunk in chunks[1:]:
            require(entry.slab < len(self.slabs), "§4.4: slab")
            slab = self.slabs[entry.slab]
            if entry.tag == b"META":
                self.metadata = content.metadata(chunk)
            elif entry.tag == b"CROP":
                slab.crop(chunk)
            elif entry.tag == b"MASK":
                slab.mask(chunk)
            else:
                self.tiles[entry.slab, entry.tile] = entry, chunk
        expected = [(number, tile) for number, slab in enumerate(self.slabs) for tile in slab.tiles()]
        require(list(self.tiles) == expected, "§4.10: tiles")
        for (slab, tile), (entry, _) in self.tiles.items():
            require(entry.raw == self.slabs[slab].raw_length(tile), "§4.7: raw length of a tile")
            require(entry.packing != 2 or self.slabs[slab].encoding == 1, "§4.3: packing")
        require(sum(entry.raw for entry, _ in self.tiles.values()) < 1 << 64, "§5.9: length of all tiles")

    def texels(self, number: int) -> np.ndarray:
        """The texels [t, s, v, u, channel] of a slab, red, green and blue as they are stored; zero where none are stored."""
        slab = self.slabs[number]
        shape = [axis.count for axis in (slab.t, slab.s, slab.v, slab.u)] + [3]
        support(math.prod(shape) <= MAX_VALUES, "§10: more texels than this reader takes")
        texels = np.zeros(shape, DTYPE[slab.encoding])
        for tile in slab.tiles():
            (tile_s, tile_t), windows = slab.cameras(tile), slab.windows(tile)
            lefts, tops = (list(accumulate(map(len, axis), initial=0)) for axis in windows)
            picture = self.picture(number, tile)
            for t, top in zip(tile_t, tops):
                for s, left in zip(tile_s, lefts):
                    v, u = slab.window(s, t)
                    x, y = 4 * left, 4 * top
                    texels[t, s, v, u] = picture[y : y + v.stop - v.start, x : x + u.stop - u.start]
        return texels

    def picture(self, number: int, tile: int) -> np.ndarray:
        """The picture [y, x, channel] of a tile (§7.2)."""
        slab, (entry, stored) = self.slabs[number], self.tiles[number, tile]
        columns, rows = slab.windows(tile)
        width, height = sum(map(len, columns)), sum(map(len, rows))
        if entry.packing == 0:
            raw = stored
        elif entry.packing == 1:
            raw = zstd_frame.unpack(stored, range(entry.raw, entry.raw + 1))
        else:
            raw = tile_codec.decode(stored, columns, rows)
        if slab.encoding == 1:
            return bc1.decode(raw, width, height)
        picture = np.frombuffer(raw, DTYPE[slab.encoding]).reshape(4 * height, 4 * width, -1)
        require(slab.encoding != 3 or np.isfinite(picture).all(), "§7.9: a texel is not finite")
        return picture[..., :3]

    def digest(self, number: int) -> str:
        """XXH64 of all texels by t, s, v, u, zero where one is not stored: the digest of `spec/vectors`."""
        return xxhash.xxh64(np.ascontiguousarray(self.texels(number)).tobytes()).hexdigest()


def main() -> None:
    parser = argparse.ArgumentParser(description="Reads .lfslab files.")
    parser.add_argument("file", type=Path)
    parser.add_argument("--slab", type=int, default=0, help="number of the slab for --out")
    parser.add_argument("--out", type=Path, help="write the texels [t, s, v, u, channel] here, as .npy")
    parser.add_argument("--digest", action="store_true", help="print XXH64 of the texels of each slab")
    arguments = parser.parse_args()
    try:
        show(LightField(arguments.file.read_bytes()), arguments)
    except (ValueError, container.Unsupported) as error:
        sys.exit(f"{arguments.file}: {'refused' if isinstance(error, ValueError) else 'unsupported'}: {error}")


def show(field: LightField, arguments: argparse.Namespace) -> None:
    if arguments.digest:
        print(*map(field.digest, range(len(field.slabs))), sep="\n")
    elif arguments.out:
        np.save(arguments.out, field.texels(arguments.slab))
    else:
        for key, value in field.metadata.items():
            print(f"{key}: {value}")
        for slab in field.slabs:
            counts = " × ".join(str(axis.count) for axis in (slab.s, slab.t, slab.u, slab.v))
            print(f"face {slab.face}: {counts}, encoding {slab.encoding}, {slab.stored.sum()} cameras stored")


if __name__ == "__main__":
    main()
