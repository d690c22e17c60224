"""Geometry, windows, masks and metadata of `.lfslab` files (§5, §6, §8)."""

import math
import re
import struct
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from container import require, support

GEOM = struct.Struct("<3d3fI")
SLAB = struct.Struct("<4Bf" + "ffI" * 4 + "fII")
BLOCK_BYTES = {1: 8, 2: 64, 3: 96}  # of each texel encoding, §7.2
TRANSFER = {1: 0, 2: 0, 3: 1}  # of each texel encoding, §5.5
MAX_CAMERAS = 1 << 26  # of a slab; this reader's own bound, §10


class Axis(NamedTuple):
    first: float
    step: float
    count: int


class Slab:
    """A slab: its record in `GEOM`, and what `CROP` and `MASK` say of it."""

    def __init__(self, record: bytes):
        fields = SLAB.unpack(record)
        self.face, self.encoding, self.transfer, reserved, self.plane = fields[:5]
        self.s, self.t, self.u, self.v = axes = [Axis(*fields[at : at + 3]) for at in (5, 8, 11, 14)]
        self.focal_depth, self.tile_s, self.tile_t = fields[17:]
        support(self.encoding in BLOCK_BYTES, f"§5.4: texel encoding {self.encoding}")
        support(self.transfer == TRANSFER[self.encoding], f"§5.5: transfer function {self.transfer}")
        require(self.face <= 5, "§5.3: face")
        require(reserved == 0, "§5.10: reserved byte")
        require(all(map(math.isfinite, fields)), "§2.1: a number is not finite")
        require(all(axis.step > 0 and 1 <= axis.count <= 65536 for axis in axes), "§5.7: step or count")
        with np.errstate(all="ignore"):
            require(all(math.isfinite(last(axis)) for axis in axes), "§5.7: last sample")
            require(self.focal_depth_is_right(), "§5.8: focal depth")
        require(1 <= self.tile_s <= self.s.count and 1 <= self.tile_t <= self.t.count, "§5.9: cameras per tile")
        support(self.s.count * self.t.count <= MAX_CAMERAS, "§10: more cameras than this reader takes")
        # Windows of each s and t, in blocks, and whether camera [t, s] is stored (§6).
        self.columns = [range(-(-self.u.count // 4))] * self.s.count
        self.rows = [range(-(-self.v.count // 4))] * self.t.count
        self.stored = np.ones((self.t.count, self.s.count), bool)

    def focal_depth_is_right(self) -> bool:
        depth = np.float32(self.focal_depth)
        if depth == 0:
            return not np.signbit(depth)
        pairs = (self.s, self.u), (self.t, self.v)
        return depth > 0 and all(np.isfinite(np.float32(a.step) / depth / np.float32(b.step)) for a, b in pairs)

    def crop(self, chunk: bytes) -> None:
        """§6.1."""
        require(len(chunk) == 8 * (self.s.count + self.t.count), "§6.1: length")
        records = list(struct.iter_unpack("<II", chunk))
        whole = self.columns + self.rows
        require(all(first + number <= len(all_) for (first, number), all_ in zip(records, whole)), "§6.1: window")
        require(all(number > 0 or first == 0 for first, number in records), "§6.1: place of an empty window")
        windows = [range(first, first + number) for first, number in records]
        require(windows != whole, "§6.1: nothing is left out")
        self.columns, self.rows = windows[: self.s.count], windows[self.s.count :]
        self.stored = np.logical_and.outer(*(list(map(bool, axis)) for axis in (self.rows, self.columns)))

    def mask(self, chunk: bytes) -> None:
        """§6.2."""
        require(len(chunk) == -(-self.stored.size // 8), "§6.2: length")
        bits = np.unpackbits(np.frombuffer(chunk, np.uint8), bitorder="little").astype(bool)
        stored = bits[: self.stored.size].reshape(self.stored.shape)
        require(not bits[self.stored.size :].any(), "§6.2: bits beyond the last camera")
        require(not (stored & ~self.stored).any(), "§6.2: a camera with an empty window")
        require((stored != self.stored).any(), "§6.2: nothing is left out")
        self.stored = stored

    def tiles(self) -> list[int]:
        """The numbers of the tiles that hold a stored camera (§7.1), once the rules that need windows and mask are met."""
        require(self.stored.any(), "§6.3: no camera is stored")
        starts_s, starts_t = (range(0, n, g) for n, g in ((self.s.count, self.tile_s), (self.t.count, self.tile_t)))
        require(len(starts_s) * len(starts_t) < 1 << 32, "§5.9: number of tiles")
        for windows, starts, g in (self.columns, starts_s, self.tile_s), (self.rows, starts_t, self.tile_t):
            require(all(4 * sum(map(len, windows[at : at + g])) < 1 << 32 for at in starts), "§5.9: size of a picture")
        rows = np.logical_or.reduceat(self.stored, starts_t, axis=0)
        return np.flatnonzero(np.logical_or.reduceat(rows, starts_s, axis=1)).tolist()

    def cameras(self, tile: int) -> tuple[range, range]:
        """The s and the t of a tile's cameras (§7.1)."""
        j, i = divmod(tile, -(-self.s.count // self.tile_s))
        s, t = i * self.tile_s, j * self.tile_t
        return range(s, min(s + self.tile_s, self.s.count)), range(t, min(t + self.tile_t, self.t.count))

    def windows(self, tile: int) -> tuple[list[range], list[range]]:
        """The windows of a tile's columns and rows, in blocks."""
        s, t = self.cameras(tile)
        return self.columns[s.start : s.stop], self.rows[t.start : t.stop]

    def window(self, s: int, t: int) -> tuple[slice, slice]:
        """The texels along v and u that are there of camera (s, t): none if it is not stored."""
        if not self.stored[t, s]:
            return slice(0, 0), slice(0, 0)
        pairs = (self.rows[t], self.v.count), (self.columns[s], self.u.count)
        v, u = (slice(4 * blocks.start, min(4 * blocks.stop, count)) for blocks, count in pairs)
        return v, u

    def raw_length(self, tile: int) -> int:
        """§7.2."""
        width, height = (sum(map(len, windows)) for windows in self.windows(tile))
        return width * height * BLOCK_BYTES[self.encoding]


def last(axis: Axis) -> np.float32:
    return np.float32(axis.first) + np.float32(axis.count - 1) * np.float32(axis.step)


def geometry(chunk: bytes) -> list[Slab]:
    """The slabs of `GEOM` (§5)."""
    require(len(chunk) >= GEOM.size, "§5.11: length")
    *cell, count = GEOM.unpack_from(chunk)
    require(all(map(math.isfinite, cell)), "§2.1: a number is not finite")
    require(min(cell[3:]) > 0, "§5.1: half extent")
    require(1 <= count <= 6, "§5.2: slab count")
    require(len(chunk) == GEOM.size + count * SLAB.size, "§5.11: length")
    slabs = [Slab(chunk[at : at + SLAB.size]) for at in range(GEOM.size, len(chunk), SLAB.size)]
    require(all(a.face < b.face for a, b in pairwise(slabs)), "§5.3: order of faces")
    return slabs


def metadata(chunk: bytes) -> dict[str, str]:
    """The entries of `META` (§8)."""
    require(4 <= len(chunk) <= 1 << 20, "§8: length")
    entries, at = [], 4
    for _ in range(int.from_bytes(chunk[:4], "little")):
        require(at + 6 <= len(chunk), "§8.2: an entry is cut off")
        key_length, value_length = struct.unpack_from("<HI", chunk, at)
        key, value, at = at + 6, at + 6 + key_length, at + 6 + key_length + value_length
        require(at <= len(chunk), "§8.2: an entry is cut off")
        entries.append((chunk[key:value], text(chunk[value:at])))
    keys = [key for key, _ in entries]
    require(len(keys) >= 1, "§8.1: no entry")
    require(at == len(chunk), "§8.2: bytes after the last entry")
    require(all(a < b for a, b in pairwise(keys)), "§8.2: order of keys")
    require(all(re.fullmatch(rb"[a-z0-9._-]{1,64}", key) for key in keys), "§8.3: key")
    return {key.decode(): value for key, value in entries}


def text(value: bytes) -> str:
    """§8.4."""
    require(len(value) <= 65536, "§8.4: length of a value")
    try:
        decoded = value.decode("utf-8")
    except UnicodeDecodeError as error:
        raise ValueError(f"§8.4: {error}") from error
    require(not re.search("[\x00-\x08\x0b-\x1f\x7f]", decoded), "§8.4: control character")
    return decoded
