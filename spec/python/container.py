"""Header and directory of `.lfslab` files (§3, §4)."""

import struct
from itertools import pairwise
from typing import NamedTuple

import xxhash

HEADER = struct.Struct("<12sHHQQI4sQ8sQ")
MAGIC = bytes.fromhex("8A4C4653 4C414200 0D0A1A0A")
CRITICAL, SAFE_TO_COPY = 1, 2
# The chunks that this reader knows, in the order of §4.10, with their flags.
FLAGS = {b"GEOM": CRITICAL, b"META": SAFE_TO_COPY, b"CROP": CRITICAL, b"MASK": CRITICAL, b"TILE": CRITICAL}


class Unsupported(Exception):
    """The file is not damaged, but has something that this reader does not know."""


class Entry(NamedTuple):
    """An entry of the directory (§4)."""

    tag: bytes
    flags: int
    packing: int
    reserved: int
    slab: int
    tile: int
    offset: int
    stored: int
    raw: int
    checksum: int

    def place(self) -> tuple:
        """What the entries are sorted by (§4.10)."""
        rank = list(FLAGS).index(self.tag) if self.tag in FLAGS else len(FLAGS)
        return rank, self.tag, self.slab, self.tile


ENTRY = struct.Struct("<4sHBBIIQQQQ")


def require(condition: bool, rule: str) -> None:
    if not condition:
        raise ValueError(rule)


def support(condition: bool, rule: str) -> None:
    if not condition:
        raise Unsupported(rule)


def directory(file: bytes) -> list[Entry]:
    """The entries of the directory, held to all rules of §3 and §4 that need no payload but its checksum."""
    require(file[:12] == MAGIC, "§3.1: not an .lfslab file")
    require(len(file) >= HEADER.size, "§3: the header is cut off")
    _, major, _, length, offset, count, reserved, checksum, reserved2, header_checksum = HEADER.unpack_from(file)
    support(major == 1, f"§3.2: version {major}")
    require(header_checksum == xxhash.xxh64_intdigest(file[:56]), "§3.8: header checksum")
    require(length == len(file), "§3.3: file length")
    require(offset == HEADER.size, "§3.4: directory offset")
    require(2 <= count <= 65536, "§3.5: entry count")
    require(not any(reserved + reserved2), "§3.6: reserved bytes")
    end = HEADER.size + count * ENTRY.size
    require(end <= len(file), "§3.5: the directory is cut off")
    require(checksum == xxhash.xxh64_intdigest(file[HEADER.size : end]), "§3.7: directory checksum")

    entries = [Entry(*fields) for fields in ENTRY.iter_unpack(file[HEADER.size : end])]
    for entry in entries:
        check_entry(entry)
    places = [entry.place() for entry in entries]
    require(entries[0].tag == b"GEOM", "§4.10: the first entry is not GEOM")
    require(all(a < b for a, b in pairwise(places)), "§4.10: order of entries")
    for entry in entries:
        end = check_payload(file, entry, end)
    require(end == len(file), "§4.5: bytes after the last payload")
    return entries


def check_entry(entry: Entry) -> None:
    known = entry.tag in FLAGS
    require(entry.tag.isascii() and entry.tag.isalnum(), "§4.1: tag")
    require(entry.flags in (0, CRITICAL, SAFE_TO_COPY), "§4.2: flags")
    support(known or entry.flags != CRITICAL, f"§4.2: critical chunk {entry.tag}")
    require(not known or entry.flags == FLAGS[entry.tag], "§4.2: flags")
    support(not known or entry.packing <= 2, f"§4.3: packing {entry.packing}")
    require(not known or entry.packing == 0 or entry.tag == b"TILE", "§4.3: packing")
    require(entry.slab == 0 or entry.tag not in (b"GEOM", b"META"), "§4.4: slab")
    require(entry.tile == 0 or not known or entry.tag == b"TILE", "§4.4: tile")
    require(entry.packing != 0 or entry.raw == entry.stored, "§4.7: raw length")
    require(entry.reserved == 0, "§4.9: reserved byte")


def check_payload(file: bytes, entry: Entry, end: int) -> int:
    """Where the payload ends; `end` is where what is before it ends."""
    start = -(-end // 64) * 64
    require(entry.offset == start, "§4.5: offset")
    require(not any(file[end:start]), "§4.5: padding")
    require(1 <= entry.stored <= len(file) - start, "§4.6: stored length")
    covered = ENTRY.pack(*entry)[:16] + payload(file, entry)
    require(entry.checksum == xxhash.xxh64_intdigest(covered), "§4.8: checksum")
    return start + entry.stored


def payload(file: bytes, entry: Entry) -> bytes:
    return file[entry.offset : entry.offset + entry.stored]
