"""Packing 2 of `.lfslab` files: BC1 blocks predicted from neighbouring cameras, then zstd.

A plain decoder, clause by clause, of the section "Tile codec" of `codecs.md`.
"""

import struct
from itertools import accumulate, pairwise

import zstd_frame

Block = tuple[int, int, int]  # color0, color1, indices
ZERO: Block = (0, 0, 0)


class Stream:
    """One of the streams of T.1, read from its start."""

    def __init__(self, data: bytes):
        self.data, self.used = data, 0

    def number(self, length: int = 1) -> int:
        part = self.data[self.used : self.used + length]
        if len(part) < length:
            raise ValueError("T.1: a stream is too short")
        self.used += length
        return int.from_bytes(part, "little")


def streams_of(frame: bytes, blocks: int) -> list[Stream]:
    content = zstd_frame.unpack(frame, range(28, 28 + 11 * blocks + 1))
    ends = list(accumulate(struct.unpack_from("<7I", content), initial=28))
    if ends[-1] != len(content):
        raise ValueError("T.1: the streams do not fill the content")
    return [Stream(content[start:end]) for start, end in pairwise(ends)]


def decode(frame: bytes, columns: list[range], rows: list[range]) -> bytes:
    """The BC1 blocks of a tile's picture in raster order; `columns` and `rows` are the windows of T.2, in blocks."""
    lefts, tops = (list(accumulate(map(len, windows), initial=0)) for windows in (columns, rows))
    width, height = lefts[-1], tops[-1]
    streams = streams_of(frame, width * height)
    picture = [ZERO] * (width * height)
    context = [3] * len(columns)
    for y in span(rows):
        grid_t = [t for t, window in enumerate(rows) if y in window]
        for x in span(columns):
            grid_s = [s for s, window in enumerate(columns) if x in window]
            cameras = [(i, j, s, t) for j, t in enumerate(grid_t) for i, s in enumerate(grid_s)]
            place, west, north = {}, {}, {}
            for i, j, s, t in cameras:
                here = (tops[t] + y - rows[t].start) * width + lefts[s] + x - columns[s].start
                above = picture[here - width] if y - 1 in rows[t] else None
                place[i, j] = here
                west[i, j] = picture[here - 1] if x - 1 in columns[s] else above or ZERO
                north[i, j] = above or west[i, j]
            cells = extension(west, north, len(grid_s), len(grid_t))
            for i, j, s, _ in cameras:
                up, left = cells[i, j - 1], cells[i - 1, j]
                kinds = (up, left, cells[i + 1, j - 1], cells[i - 1, j - 1], west[i, j], north[i, j], up, left)
                cells[i, j], context[s] = block(streams, context[s], kinds)
                picture[place[i, j]] = cells[i, j]
    if any(stream.used != len(stream.data) for stream in streams):
        raise ValueError("T.1: a stream is not used up")
    return b"".join(struct.pack("<HHI", *entry) for entry in picture)


def span(windows: list[range]) -> range:
    filled = [window for window in windows if window]
    return range(min(w.start for w in filled), max(w.stop for w in filled)) if filled else range(0)


def extension(west: dict, north: dict, m: int, n: int) -> dict[tuple[int, int], Block]:
    """T.2: C(s, t) above and beside the grid."""
    if m == 0 or n == 0:
        return {}
    sides = {(s, t): west[min(max(s, 0), m - 1), max(t, 0)] for s in (-1, m) for t in range(-1, n)}
    return sides | {(s, -1): north[s, 0] for s in range(m)}


def block(streams: list[Stream], context: int, kinds: tuple[Block, ...]) -> tuple[Block, int]:
    """T.4: the next block and the context of the one below."""
    mode = streams[context].number()
    source, kind = kinds[mode >> 4 & 1], mode >> 5
    color0, color1 = (endpoint(streams, near) if kind >= 6 else near for near in kinds[kind][:2])
    corrected = [row for row in range(4) if mode >> row & 1]
    correction = sum(streams[6].number() << 8 * row for row in corrected)
    return (color0, color1, predicted(color0, color1, source) ^ correction), min(len(corrected), 3)


def endpoint(streams: list[Stream], near: int) -> int:
    """T.5."""
    b = streams[4].number()
    if b == 255:
        return streams[5].number(2)
    if b >= 225:
        raise ValueError(f"T.5: step {b}")
    return (near + (b // 45 - 2) * 2048 + (b // 5 % 9 - 4) * 32 + b % 5 - 2) % 65536


def predicted(color0: int, color1: int, source: Block) -> int:
    """T.7."""
    near0, near1, indices = source
    if (color0, color1) == (near0, near1):
        return indices
    c1 = rho(color1)
    a = [x - y for x, y in zip(rho(color0), c1)]
    length, n, f = (sum(p * (x - y) for p, x, y in zip(a, rho(c), c1)) for c in (color0, near0, near1))
    m = [1 if q <= length else 3 if q <= 3 * length else 2 if q <= 5 * length else 0
         for q in (6 * n, 6 * f, 4 * n + 2 * f, 2 * n + 4 * f)]  # fmt: skip
    return sum(m[indices >> shift & 3] << shift for shift in range(0, 32, 2))


def rho(c: int) -> tuple[int, int, int]:
    return 2 * (c >> 11), c >> 5 & 63, 2 * (c & 31)
