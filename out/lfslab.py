# This is a generated file! Please edit source .ksy file and use kaitai-struct-compiler to rebuild
# type: ignore

import kaitaistruct
from kaitaistruct import KaitaiStruct, KaitaiStream, BytesIO
from enum import IntEnum


if getattr(kaitaistruct, 'API_VERSION', (0, 9)) < (0, 11):
    raise Exception("Incompatible Kaitai Struct Python API: 0.11 or later is required, but you have %s" % (kaitaistruct.__version__))

class Lfslab(KaitaiStruct):
    """One environment light field: a cell, one to six slabs of cameras around it, and the cameras' images in tiles.
    
    The text `lfslab-1.0.md` is normative, this description is not. Reading a file with it and fetching all instances holds the
    file to what the text asks of it, but for what this language cannot say: checksums, what is inside a zstd block and in the
    tile codec's streams, and rules for writers alone. Chunks with an unknown tag are left as bytes, and refused if critical.
    
    .. seealso::
       lfslab-1.0.md
    """

    class ChunkKind(IntEnum):
        geom = 0
        meta = 1
        crop = 2
        mask = 3
        tile = 4
        other = 5

    class Face(IntEnum):
        x_positive = 0
        x_negative = 1
        y_positive = 2
        y_negative = 3
        z_positive = 4
        z_negative = 5

    class Packing(IntEnum):
        none = 0
        zstd = 1
        tile_codec = 2

    class TexelEncoding(IntEnum):
        bc1 = 1
        rgba8 = 2
        rgb16f = 3

    class TransferFunction(IntEnum):
        srgb = 0
        linear = 1

    class ZstdBlockKind(IntEnum):
        raw = 0
        repeated = 1
        compressed = 2
    def __init__(self, _io, _parent=None, _root=None):
        super(Lfslab, self).__init__(_io)
        self._parent = _parent
        self._root = _root or self
        self._read()

    def _read(self):
        self.header = Lfslab.Header(self._io, self, self._root)
        self.directory = []
        for i in range(self.header.entry_count):
            self.directory.append(Lfslab.Entry(i, self._io, self, self._root))



    def _fetch_instances(self):
        pass
        self.header._fetch_instances()
        for i in range(len(self.directory)):
            pass
            self.directory[i]._fetch_instances()


    class Axis(KaitaiStruct):
        """Sample i lies at first + i·step. The last one is evaluated here without rounding the product, which makes a difference to
        what is within half a unit in the last place of the largest number.
        
        .. seealso::
           lfslab-1.0.md §5.7
        """
        def __init__(self, _io, _parent=None, _root=None):
            super(Lfslab.Axis, self).__init__(_io)
            self._parent = _parent
            self._root = _root
            self._read()

        def _read(self):
            self.first = self._io.read_f4le()
            if not self.first >= -(self._root.largest):
                raise kaitaistruct.ValidationLessThanError(-(self._root.largest), self.first, self._io, u"/types/axis/seq/0")
            if not self.first <= self._root.largest:
                raise kaitaistruct.ValidationGreaterThanError(self._root.largest, self.first, self._io, u"/types/axis/seq/0")
            self.step = self._io.read_f4le()
            _ = self.step
            if not  ((_ > 0) and (_ <= self._root.largest)) :
                raise kaitaistruct.ValidationExprError(self.step, self._io, u"/types/axis/seq/1")
            self.count = self._io.read_u4le()
            _ = self.count
            if not  ((_ >= 1) and (_ <= 65536) and ((_ - 1) * self.step < self._root.overflow) and (self.first + (_ - 1) * self.step < self._root.overflow)) :
                raise kaitaistruct.ValidationExprError(self.count, self._io, u"/types/axis/seq/2")


        def _fetch_instances(self):
            pass


    class Camera(KaitaiStruct):
        """Numbers of stored cameras, from which follows how many are in a tile. A type without bytes."""
        def __init__(self, stored, in_row_before, before, above, _io, _parent=None, _root=None):
            super(Lfslab.Camera, self).__init__(_io)
            self._parent = _parent
            self._root = _root
            self.stored = stored
            self.in_row_before = in_row_before
            self.before = before
            self.above = above
            self._read()

        def _read(self):
            pass


        def _fetch_instances(self):
            pass

        @property
        def in_row(self):
            if hasattr(self, '_m_in_row'):
                return self._m_in_row

            self._m_in_row = self.in_row_before + self.stored
            return getattr(self, '_m_in_row', None)

        @property
        def left(self):
            """In columns before this one, in rows up to and with this one."""
            if hasattr(self, '_m_left'):
                return self._m_left

            self._m_left = self.before + self.in_row_before
            return getattr(self, '_m_left', None)

        @property
        def through(self):
            """In rows and in columns up to and with this one."""
            if hasattr(self, '_m_through'):
                return self._m_through

            self._m_through = self.above + self.in_row
            return getattr(self, '_m_through', None)


    class Crop(KaitaiStruct):
        """Windows of a slab's images, in blocks of 4 texels.
        
        .. seealso::
           lfslab-1.0.md §6.1
        """
        def __init__(self, slab_index, _io, _parent=None, _root=None):
            super(Lfslab.Crop, self).__init__(_io)
            self._parent = _parent
            self._root = _root
            self.slab_index = slab_index
            self._read()

        def _read(self):
            self.columns = []
            for i in range(self.slab.s.count):
                self.columns.append(Lfslab.Window(self.slab.blocks_u, (0 if i == 0 else self.columns[i - 1].blocks_through), (0 if i == 0 else self.columns[i - 1].filled_through), self._io, self, self._root))

            self.rows = []
            for i in range(self.slab.t.count):
                self.rows.append(Lfslab.Window(self.slab.blocks_v, (0 if i == 0 else self.rows[i - 1].blocks_through), (0 if i == 0 else self.rows[i - 1].filled_through), self._io, self, self._root))

            self.rest = self._io.read_bytes_full()
            _ = self.rest
            if not  ((len(_) == 0) and ( ((self.columns[-1].blocks_through < self.slab.s.count * self.slab.blocks_u) or (self.rows[-1].blocks_through < self.slab.t.count * self.slab.blocks_v)) )) :
                raise kaitaistruct.ValidationExprError(self.rest, self._io, u"/types/crop/seq/2")


        def _fetch_instances(self):
            pass
            for i in range(len(self.columns)):
                pass
                self.columns[i]._fetch_instances()

            for i in range(len(self.rows)):
                pass
                self.rows[i]._fetch_instances()


        @property
        def slab(self):
            if hasattr(self, '_m_slab'):
                return self._m_slab

            self._m_slab = self._root.geom.slabs[self.slab_index]
            return getattr(self, '_m_slab', None)


    class Entry(KaitaiStruct):
        """An entry of the directory, and the chunk that it describes.
        
        .. seealso::
           lfslab-1.0.md §4
        """
        def __init__(self, index, _io, _parent=None, _root=None):
            super(Lfslab.Entry, self).__init__(_io)
            self._parent = _parent
            self._root = _root
            self.index = index
            self._read()

        def _read(self):
            self._raw_tag = self._io.read_bytes(4)
            _io__raw_tag = KaitaiStream(BytesIO(self._raw_tag))
            self.tag = Lfslab.Tag(_io__raw_tag, self, self._root)
            _ = self.tag
            if not (self.kind == Lfslab.ChunkKind.geom if self.index == 0 else  ((self.kind != Lfslab.ChunkKind.geom) and (int(self.kind) >= int(self.previous.kind))) ):
                raise kaitaistruct.ValidationExprError(self.tag, self._io, u"/types/entry/seq/0")
            self.flags = self._io.read_u2le()
            _ = self.flags
            if not (_ == 2 if self.kind == Lfslab.ChunkKind.meta else ( ((_ == 0) or (_ == 2))  if self.kind == Lfslab.ChunkKind.other else _ == 1)):
                raise kaitaistruct.ValidationExprError(self.flags, self._io, u"/types/entry/seq/1")
            self.packing = KaitaiStream.resolve_enum(Lfslab.Packing, self._io.read_u1())
            _ = self.packing
            if not  ((self.kind == Lfslab.ChunkKind.other) or (_ == Lfslab.Packing.none) or ( ((self.kind == Lfslab.ChunkKind.tile) and ( ((_ == Lfslab.Packing.zstd) or (_ == Lfslab.Packing.tile_codec)) )) )) :
                raise kaitaistruct.ValidationExprError(self.packing, self._io, u"/types/entry/seq/2")
            self.reserved = self._io.read_u1()
            if not self.reserved == 0:
                raise kaitaistruct.ValidationNotEqualError(0, self.reserved, self._io, u"/types/entry/seq/3")
            self.slab = self._io.read_u4le()
            _ = self.slab
            if not  ((self.kind == Lfslab.ChunkKind.other) or ((_ == 0 if  ((self.kind == Lfslab.ChunkKind.geom) or (self.kind == Lfslab.ChunkKind.meta))  else _ < self._root.geom.slab_count))) :
                raise kaitaistruct.ValidationExprError(self.slab, self._io, u"/types/entry/seq/4")
            self.tile = self._io.read_u4le()
            _ = self.tile
            if not  (( ((self.kind == Lfslab.ChunkKind.tile) or (self.kind == Lfslab.ChunkKind.other) or (_ == 0)) ) and ( ((self.index == 0) or (self.kind != self.previous.kind) or (self.is_after_previous)) )) :
                raise kaitaistruct.ValidationExprError(self.tile, self._io, u"/types/entry/seq/5")
            self.offset = self._io.read_u8le()
            if not self.offset == ((self.previous_end + 63) // 64) * 64:
                raise kaitaistruct.ValidationNotEqualError(((self.previous_end + 63) // 64) * 64, self.offset, self._io, u"/types/entry/seq/6")
            self.stored_length = self._io.read_u8le()
            _ = self.stored_length
            if not  ((_ >= 1) and (self.offset <= self._root._io.size()) and ((_ == self._root._io.size() - self.offset if self.is_last else _ <= self._root._io.size() - self.offset)) and ( ((self.kind != Lfslab.ChunkKind.meta) or (_ <= 1048576)) )) :
                raise kaitaistruct.ValidationExprError(self.stored_length, self._io, u"/types/entry/seq/7")
            self.raw_length = self._io.read_u8le()
            _ = self.raw_length
            if not  ((self.packing != Lfslab.Packing.none) or (_ == self.stored_length)) :
                raise kaitaistruct.ValidationExprError(self.raw_length, self._io, u"/types/entry/seq/8")
            self.checksum = self._io.read_u8le()


        def _fetch_instances(self):
            pass
            self.tag._fetch_instances()
            _ = self.padding
            if hasattr(self, '_m_padding'):
                pass
                for i in range(len(self._m_padding)):
                    pass


            _ = self.payload
            if hasattr(self, '_m_payload'):
                pass
                _on = self.kind
                if _on == Lfslab.ChunkKind.crop:
                    pass
                    self._m_payload._fetch_instances()
                elif _on == Lfslab.ChunkKind.geom:
                    pass
                    self._m_payload._fetch_instances()
                elif _on == Lfslab.ChunkKind.mask:
                    pass
                    self._m_payload._fetch_instances()
                elif _on == Lfslab.ChunkKind.meta:
                    pass
                    self._m_payload._fetch_instances()
                else:
                    pass


        @property
        def is_after_previous(self):
            """By tag, slab and tile; for two entries of the same kind."""
            if hasattr(self, '_m_is_after_previous'):
                return self._m_is_after_previous

            if self.index > 0:
                pass
                self._m_is_after_previous =  ((self.tag.text > self.previous.tag.text) or ( ((self.tag.text == self.previous.tag.text) and ( ((self.slab > self.previous.slab) or ( ((self.slab == self.previous.slab) and (self.tile > self.previous.tile)) )) )) )) 

            return getattr(self, '_m_is_after_previous', None)

        @property
        def is_last(self):
            if hasattr(self, '_m_is_last'):
                return self._m_is_last

            self._m_is_last = self.index + 1 == self._root.header.entry_count
            return getattr(self, '_m_is_last', None)

        @property
        def kind(self):
            if hasattr(self, '_m_kind'):
                return self._m_kind

            self._m_kind = (Lfslab.ChunkKind.geom if self.tag.text == u"GEOM" else (Lfslab.ChunkKind.meta if self.tag.text == u"META" else (Lfslab.ChunkKind.crop if self.tag.text == u"CROP" else (Lfslab.ChunkKind.mask if self.tag.text == u"MASK" else (Lfslab.ChunkKind.tile if self.tag.text == u"TILE" else Lfslab.ChunkKind.other)))))
            return getattr(self, '_m_kind', None)

        @property
        def padding(self):
            """
            .. seealso::
               lfslab-1.0.md §4.5
            """
            if hasattr(self, '_m_padding'):
                return self._m_padding

            _pos = self._io.pos()
            self._io.seek(self.previous_end)
            self._m_padding = []
            for i in range(self.offset - self.previous_end):
                self._m_padding.append(self._io.read_u1())
                if not self._m_padding[i] == 0:
                    raise kaitaistruct.ValidationNotEqualError(0, self._m_padding[i], self._io, u"/types/entry/instances/padding")

            self._io.seek(_pos)
            return getattr(self, '_m_padding', None)

        @property
        def payload(self):
            """As stored. `slab.tiles` tells what is in those of tiles."""
            if hasattr(self, '_m_payload'):
                return self._m_payload

            _pos = self._io.pos()
            self._io.seek(self.offset)
            _on = self.kind
            if _on == Lfslab.ChunkKind.crop:
                pass
                self._raw__m_payload = self._io.read_bytes(self.stored_length)
                _io__raw__m_payload = KaitaiStream(BytesIO(self._raw__m_payload))
                self._m_payload = Lfslab.Crop(self.slab, _io__raw__m_payload, self, self._root)
            elif _on == Lfslab.ChunkKind.geom:
                pass
                self._raw__m_payload = self._io.read_bytes(self.stored_length)
                _io__raw__m_payload = KaitaiStream(BytesIO(self._raw__m_payload))
                self._m_payload = Lfslab.Geom(_io__raw__m_payload, self, self._root)
            elif _on == Lfslab.ChunkKind.mask:
                pass
                self._raw__m_payload = self._io.read_bytes(self.stored_length)
                _io__raw__m_payload = KaitaiStream(BytesIO(self._raw__m_payload))
                self._m_payload = Lfslab.Mask(self.slab, _io__raw__m_payload, self, self._root)
            elif _on == Lfslab.ChunkKind.meta:
                pass
                self._raw__m_payload = self._io.read_bytes(self.stored_length)
                _io__raw__m_payload = KaitaiStream(BytesIO(self._raw__m_payload))
                self._m_payload = Lfslab.Meta(_io__raw__m_payload, self, self._root)
            else:
                pass
                self._m_payload = self._io.read_bytes(self.stored_length)
            self._io.seek(_pos)
            return getattr(self, '_m_payload', None)

        @property
        def previous(self):
            if hasattr(self, '_m_previous'):
                return self._m_previous

            if self.index > 0:
                pass
                self._m_previous = self._root.directory[self.index - 1]

            return getattr(self, '_m_previous', None)

        @property
        def previous_end(self):
            """Where the payload before this one ends, or the directory."""
            if hasattr(self, '_m_previous_end'):
                return self._m_previous_end

            self._m_previous_end = (64 + 48 * self._root.header.entry_count if self.index == 0 else self.previous.offset + self.previous.stored_length)
            return getattr(self, '_m_previous_end', None)


    class Geom(KaitaiStruct):
        """Cell and slabs.
        
        .. seealso::
           lfslab-1.0.md §5
        """
        def __init__(self, _io, _parent=None, _root=None):
            super(Lfslab.Geom, self).__init__(_io)
            self._parent = _parent
            self._root = _root
            self._read()

        def _read(self):
            self.center = []
            for i in range(3):
                self.center.append(self._io.read_f8le())
                if not self.center[i] >= -1.7976931348623157E+308:
                    raise kaitaistruct.ValidationLessThanError(-1.7976931348623157E+308, self.center[i], self._io, u"/types/geom/seq/0")
                if not self.center[i] <= 1.7976931348623157E+308:
                    raise kaitaistruct.ValidationGreaterThanError(1.7976931348623157E+308, self.center[i], self._io, u"/types/geom/seq/0")

            self.half_extent = []
            for i in range(3):
                self.half_extent.append(self._io.read_f4le())
                _ = self.half_extent[i]
                if not  ((_ > 0) and (_ <= self._root.largest)) :
                    raise kaitaistruct.ValidationExprError(self.half_extent[i], self._io, u"/types/geom/seq/1")

            self.slab_count = self._io.read_u4le()
            if not self.slab_count >= 1:
                raise kaitaistruct.ValidationLessThanError(1, self.slab_count, self._io, u"/types/geom/seq/2")
            if not self.slab_count <= 6:
                raise kaitaistruct.ValidationGreaterThanError(6, self.slab_count, self._io, u"/types/geom/seq/2")
            self.slabs = []
            for i in range(self.slab_count):
                self.slabs.append(Lfslab.Slab(i, self._io, self, self._root))

            self.rest = self._io.read_bytes_full()
            _ = self.rest
            if not len(_) == 0:
                raise kaitaistruct.ValidationExprError(self.rest, self._io, u"/types/geom/seq/4")


        def _fetch_instances(self):
            pass
            for i in range(len(self.center)):
                pass

            for i in range(len(self.half_extent)):
                pass

            for i in range(len(self.slabs)):
                pass
                self.slabs[i]._fetch_instances()



    class Header(KaitaiStruct):
        """
        .. seealso::
           lfslab-1.0.md §3
        """
        def __init__(self, _io, _parent=None, _root=None):
            super(Lfslab.Header, self).__init__(_io)
            self._parent = _parent
            self._root = _root
            self._read()

        def _read(self):
            self.magic = self._io.read_bytes(12)
            if not self.magic == b"\x8A\x4C\x46\x53\x4C\x41\x42\x00\x0D\x0A\x1A\x0A":
                raise kaitaistruct.ValidationNotEqualError(b"\x8A\x4C\x46\x53\x4C\x41\x42\x00\x0D\x0A\x1A\x0A", self.magic, self._io, u"/types/header/seq/0")
            self.major_version = self._io.read_u2le()
            if not self.major_version == 1:
                raise kaitaistruct.ValidationNotEqualError(1, self.major_version, self._io, u"/types/header/seq/1")
            self.minor_version = self._io.read_u2le()
            self.file_length = self._io.read_u8le()
            if not self.file_length == self._root._io.size():
                raise kaitaistruct.ValidationNotEqualError(self._root._io.size(), self.file_length, self._io, u"/types/header/seq/3")
            self.directory_offset = self._io.read_u8le()
            if not self.directory_offset == 64:
                raise kaitaistruct.ValidationNotEqualError(64, self.directory_offset, self._io, u"/types/header/seq/4")
            self.entry_count = self._io.read_u4le()
            _ = self.entry_count
            if not  ((_ >= 2) and (_ <= 65536) and (self.directory_offset + 48 * _ <= self.file_length)) :
                raise kaitaistruct.ValidationExprError(self.entry_count, self._io, u"/types/header/seq/5")
            self.reserved_36 = self._io.read_bytes(4)
            if not self.reserved_36 == b"\x00\x00\x00\x00":
                raise kaitaistruct.ValidationNotEqualError(b"\x00\x00\x00\x00", self.reserved_36, self._io, u"/types/header/seq/6")
            self.directory_checksum = self._io.read_u8le()
            self.reserved_48 = self._io.read_bytes(8)
            if not self.reserved_48 == b"\x00\x00\x00\x00\x00\x00\x00\x00":
                raise kaitaistruct.ValidationNotEqualError(b"\x00\x00\x00\x00\x00\x00\x00\x00", self.reserved_48, self._io, u"/types/header/seq/8")
            self.header_checksum = self._io.read_u8le()


        def _fetch_instances(self):
            pass


    class Mask(KaitaiStruct):
        """Which cameras of a slab are stored. Camera (s, t) has the number t·N_s + s.
        
        .. seealso::
           lfslab-1.0.md §6.2
        """
        def __init__(self, slab_index, _io, _parent=None, _root=None):
            super(Lfslab.Mask, self).__init__(_io)
            self._parent = _parent
            self._root = _root
            self.slab_index = slab_index
            self._read()

        def _read(self):
            self.stored = []
            for i in range(self.slab.s.count * self.slab.t.count):
                self.stored.append(self._io.read_bits_int_le(1) != 0)
                _ = self.stored[i]
                if not  (((not (_))) or ((not (self.slab.crop_search.is_found))) or ( ((self.slab.crop.columns[i % self.slab.s.count].blocks > 0) and (self.slab.crop.rows[i // self.slab.s.count].blocks > 0)) )) :
                    raise kaitaistruct.ValidationExprError(self.stored[i], self._io, u"/types/mask/seq/0")

            self.beyond = []
            for i in range(7 - (self.slab.s.count * self.slab.t.count + 7) % 8):
                self.beyond.append(self._io.read_bits_int_le(1) != 0)
                _ = self.beyond[i]
                if not (not (_)):
                    raise kaitaistruct.ValidationExprError(self.beyond[i], self._io, u"/types/mask/seq/1")

            self.cameras = []
            for i in range(self.slab.s.count * self.slab.t.count):
                self.cameras.append(Lfslab.Camera(int(self.stored[i]), (0 if i % self.slab.s.count == 0 else self.cameras[i - 1].in_row), (0 if i < self.slab.s.count else self.cameras[i - self.slab.s.count].left), (0 if i < self.slab.s.count else self.cameras[i - self.slab.s.count].through), self._io, self, self._root))

            self.rest = self._io.read_bytes_full()
            _ = self.rest
            if not  ((len(_) == 0) and (self.cameras[-1].through < self.slab.filled_cameras)) :
                raise kaitaistruct.ValidationExprError(self.rest, self._io, u"/types/mask/seq/3")


        def _fetch_instances(self):
            pass
            for i in range(len(self.stored)):
                pass

            for i in range(len(self.beyond)):
                pass

            for i in range(len(self.cameras)):
                pass
                self.cameras[i]._fetch_instances()


        @property
        def slab(self):
            if hasattr(self, '_m_slab'):
                return self._m_slab

            self._m_slab = self._root.geom.slabs[self.slab_index]
            return getattr(self, '_m_slab', None)


    class Meta(KaitaiStruct):
        """Text for people and tools.
        
        .. seealso::
           lfslab-1.0.md §8
        """
        def __init__(self, _io, _parent=None, _root=None):
            super(Lfslab.Meta, self).__init__(_io)
            self._parent = _parent
            self._root = _root
            self._read()

        def _read(self):
            self.count = self._io.read_u4le()
            if not self.count >= 1:
                raise kaitaistruct.ValidationLessThanError(1, self.count, self._io, u"/types/meta/seq/0")
            self.entries = []
            for i in range(self.count):
                self.entries.append(Lfslab.MetaEntry(i, self._io, self, self._root))

            self.rest = self._io.read_bytes_full()
            _ = self.rest
            if not len(_) == 0:
                raise kaitaistruct.ValidationExprError(self.rest, self._io, u"/types/meta/seq/2")


        def _fetch_instances(self):
            pass
            for i in range(len(self.entries)):
                pass
                self.entries[i]._fetch_instances()



    class MetaEntry(KaitaiStruct):
        """
        .. seealso::
           lfslab-1.0.md §8.2
        """
        def __init__(self, index, _io, _parent=None, _root=None):
            super(Lfslab.MetaEntry, self).__init__(_io)
            self._parent = _parent
            self._root = _root
            self.index = index
            self._read()

        def _read(self):
            self.len_key = self._io.read_u2le()
            if not self.len_key >= 1:
                raise kaitaistruct.ValidationLessThanError(1, self.len_key, self._io, u"/types/meta_entry/seq/0")
            if not self.len_key <= 64:
                raise kaitaistruct.ValidationGreaterThanError(64, self.len_key, self._io, u"/types/meta_entry/seq/0")
            self.len_value = self._io.read_u4le()
            if not self.len_value <= 65536:
                raise kaitaistruct.ValidationGreaterThanError(65536, self.len_value, self._io, u"/types/meta_entry/seq/1")
            self._raw_key = self._io.read_bytes(self.len_key)
            _io__raw_key = KaitaiStream(BytesIO(self._raw_key))
            self.key = Lfslab.MetaKey(_io__raw_key, self, self._root)
            _ = self.key
            if not  ((self.index == 0) or (_.text > self._parent.entries[self.index - 1].key.text)) :
                raise kaitaistruct.ValidationExprError(self.key, self._io, u"/types/meta_entry/seq/2")
            self._raw_value = self._io.read_bytes(self.len_value)
            _io__raw_value = KaitaiStream(BytesIO(self._raw_value))
            self.value = Lfslab.MetaValue(_io__raw_value, self, self._root)


        def _fetch_instances(self):
            pass
            self.key._fetch_instances()
            self.value._fetch_instances()


    class MetaKey(KaitaiStruct):
        """
        .. seealso::
           lfslab-1.0.md §8.3
        """
        def __init__(self, _io, _parent=None, _root=None):
            super(Lfslab.MetaKey, self).__init__(_io)
            self._parent = _parent
            self._root = _root
            self._read()

        def _read(self):
            self.characters = []
            i = 0
            while not self._io.is_eof():
                self.characters.append(self._io.read_u1())
                _ = self.characters[i]
                if not  (( ((_ >= 97) and (_ <= 122)) ) or ( ((_ >= 48) and (_ <= 57)) ) or (_ == 46) or (_ == 95) or (_ == 45)) :
                    raise kaitaistruct.ValidationExprError(self.characters[i], self._io, u"/types/meta_key/seq/0")
                i += 1



        def _fetch_instances(self):
            pass
            for i in range(len(self.characters)):
                pass

            _ = self.text
            if hasattr(self, '_m_text'):
                pass


        @property
        def text(self):
            if hasattr(self, '_m_text'):
                return self._m_text

            _pos = self._io.pos()
            self._io.seek(0)
            self._m_text = (self._io.read_bytes_full()).decode(u"ASCII")
            self._io.seek(_pos)
            return getattr(self, '_m_text', None)


    class MetaValue(KaitaiStruct):
        """
        .. seealso::
           lfslab-1.0.md §8.4
        """
        def __init__(self, _io, _parent=None, _root=None):
            super(Lfslab.MetaValue, self).__init__(_io)
            self._parent = _parent
            self._root = _root
            self._read()

        def _read(self):
            self.characters = []
            i = 0
            while not self._io.is_eof():
                self.characters.append(Lfslab.Utf8Character(self._io, self, self._root))
                i += 1



        def _fetch_instances(self):
            pass
            for i in range(len(self.characters)):
                pass
                self.characters[i]._fetch_instances()

            _ = self.text
            if hasattr(self, '_m_text'):
                pass


        @property
        def text(self):
            if hasattr(self, '_m_text'):
                return self._m_text

            _pos = self._io.pos()
            self._io.seek(0)
            self._m_text = (self._io.read_bytes_full()).decode(u"UTF-8")
            self._io.seek(_pos)
            return getattr(self, '_m_text', None)


    class Search(KaitaiStruct):
        """The first entry that does not come before those of a kind and slab: the one sought, if there is one. A type without bytes.
        """
        def __init__(self, kind, slab, _io, _parent=None, _root=None):
            super(Lfslab.Search, self).__init__(_io)
            self._parent = _parent
            self._root = _root
            self.kind = kind
            self.slab = slab
            self._read()

        def _read(self):
            self.steps = []
            i = 0
            while True:
                _ = Lfslab.Search.Step(i, self._io, self, self._root)
                self.steps.append(_)
                if  ((_.entry.is_last) or (int(_.entry.kind) > int(self.kind)) or ( ((_.entry.kind == self.kind) and (_.entry.slab >= self.slab)) )) :
                    break
                i += 1


        def _fetch_instances(self):
            pass
            for i in range(len(self.steps)):
                pass
                self.steps[i]._fetch_instances()


        class Step(KaitaiStruct):
            def __init__(self, index, _io, _parent=None, _root=None):
                super(Lfslab.Search.Step, self).__init__(_io)
                self._parent = _parent
                self._root = _root
                self.index = index
                self._read()

            def _read(self):
                pass


            def _fetch_instances(self):
                pass

            @property
            def entry(self):
                if hasattr(self, '_m_entry'):
                    return self._m_entry

                self._m_entry = self._root.directory[self.index]
                return getattr(self, '_m_entry', None)


        @property
        def entry(self):
            if hasattr(self, '_m_entry'):
                return self._m_entry

            self._m_entry = self.steps[-1].entry
            return getattr(self, '_m_entry', None)

        @property
        def index(self):
            if hasattr(self, '_m_index'):
                return self._m_index

            self._m_index = len(self.steps) - 1
            return getattr(self, '_m_index', None)

        @property
        def is_found(self):
            if hasattr(self, '_m_is_found'):
                return self._m_is_found

            self._m_is_found =  ((self.entry.kind == self.kind) and (self.entry.slab == self.slab)) 
            return getattr(self, '_m_is_found', None)


    class Slab(KaitaiStruct):
        """
        .. seealso::
           lfslab-1.0.md §5
        """
        def __init__(self, index, _io, _parent=None, _root=None):
            super(Lfslab.Slab, self).__init__(_io)
            self._parent = _parent
            self._root = _root
            self.index = index
            self._read()

        def _read(self):
            self.face = KaitaiStream.resolve_enum(Lfslab.Face, self._io.read_u1())
            _ = self.face
            if not  ((int(_) <= 5) and ( ((self.index == 0) or (int(_) > int(self._parent.slabs[self.index - 1].face))) )) :
                raise kaitaistruct.ValidationExprError(self.face, self._io, u"/types/slab/seq/0")
            self.texel_encoding = KaitaiStream.resolve_enum(Lfslab.TexelEncoding, self._io.read_u1())
            if not isinstance(self.texel_encoding, Lfslab.TexelEncoding):
                raise kaitaistruct.ValidationNotInEnumError(self.texel_encoding, self._io, u"/types/slab/seq/1")
            self.transfer_function = KaitaiStream.resolve_enum(Lfslab.TransferFunction, self._io.read_u1())
            _ = self.transfer_function
            if not _ == (Lfslab.TransferFunction.linear if self.texel_encoding == Lfslab.TexelEncoding.rgb16f else Lfslab.TransferFunction.srgb):
                raise kaitaistruct.ValidationExprError(self.transfer_function, self._io, u"/types/slab/seq/2")
            self.reserved = self._io.read_u1()
            if not self.reserved == 0:
                raise kaitaistruct.ValidationNotEqualError(0, self.reserved, self._io, u"/types/slab/seq/3")
            self.plane = self._io.read_f4le()
            if not self.plane >= -(self._root.largest):
                raise kaitaistruct.ValidationLessThanError(-(self._root.largest), self.plane, self._io, u"/types/slab/seq/4")
            if not self.plane <= self._root.largest:
                raise kaitaistruct.ValidationGreaterThanError(self._root.largest, self.plane, self._io, u"/types/slab/seq/4")
            self.s = Lfslab.Axis(self._io, self, self._root)
            self.t = Lfslab.Axis(self._io, self, self._root)
            self.u = Lfslab.Axis(self._io, self, self._root)
            self.v = Lfslab.Axis(self._io, self, self._root)
            self.focal_depth_bits = self._io.read_u4le()
            if not self.focal_depth_bits <= 2139095039:
                raise kaitaistruct.ValidationGreaterThanError(2139095039, self.focal_depth_bits, self._io, u"/types/slab/seq/9")
            self.cameras_per_tile_s = self._io.read_u4le()
            if not self.cameras_per_tile_s >= 1:
                raise kaitaistruct.ValidationLessThanError(1, self.cameras_per_tile_s, self._io, u"/types/slab/seq/10")
            if not self.cameras_per_tile_s <= self.s.count:
                raise kaitaistruct.ValidationGreaterThanError(self.s.count, self.cameras_per_tile_s, self._io, u"/types/slab/seq/10")
            self.cameras_per_tile_t = self._io.read_u4le()
            _ = self.cameras_per_tile_t
            if not  ((_ >= 1) and (_ <= self.t.count) and (self.tiles_s * self.tiles_t <= 4294967295)) :
                raise kaitaistruct.ValidationExprError(self.cameras_per_tile_t, self._io, u"/types/slab/seq/11")


        def _fetch_instances(self):
            pass
            self.s._fetch_instances()
            self.t._fetch_instances()
            self.u._fetch_instances()
            self.v._fetch_instances()
            _ = self.crop_search
            if hasattr(self, '_m_crop_search'):
                pass
                self._m_crop_search._fetch_instances()

            _ = self.focal_depth
            if hasattr(self, '_m_focal_depth'):
                pass

            _ = self.mask_search
            if hasattr(self, '_m_mask_search'):
                pass
                self._m_mask_search._fetch_instances()

            _ = self.tile_search
            if hasattr(self, '_m_tile_search'):
                pass
                self._m_tile_search._fetch_instances()

            _ = self.tiles
            if hasattr(self, '_m_tiles'):
                pass
                for i in range(len(self._m_tiles)):
                    pass
                    self._m_tiles[i]._fetch_instances()



        @property
        def blocks_u(self):
            """Blocks of 4 texels along u of a whole image."""
            if hasattr(self, '_m_blocks_u'):
                return self._m_blocks_u

            self._m_blocks_u = (self.u.count + 3) // 4
            return getattr(self, '_m_blocks_u', None)

        @property
        def blocks_v(self):
            if hasattr(self, '_m_blocks_v'):
                return self._m_blocks_v

            self._m_blocks_v = (self.v.count + 3) // 4
            return getattr(self, '_m_blocks_v', None)

        @property
        def bytes_per_block(self):
            """Of 4×4 texels.
            
            .. seealso::
               lfslab-1.0.md §7.2
            """
            if hasattr(self, '_m_bytes_per_block'):
                return self._m_bytes_per_block

            self._m_bytes_per_block = (8 if self.texel_encoding == Lfslab.TexelEncoding.bc1 else (64 if self.texel_encoding == Lfslab.TexelEncoding.rgba8 else 96))
            return getattr(self, '_m_bytes_per_block', None)

        @property
        def crop(self):
            if hasattr(self, '_m_crop'):
                return self._m_crop

            if self.crop_search.is_found:
                pass
                self._m_crop = self.crop_search.entry.payload

            return getattr(self, '_m_crop', None)

        @property
        def crop_search(self):
            if hasattr(self, '_m_crop_search'):
                return self._m_crop_search

            _pos = self._io.pos()
            self._io.seek(0)
            self._m_crop_search = Lfslab.Search(Lfslab.ChunkKind.crop, self.index, self._io, self, self._root)
            self._io.seek(_pos)
            return getattr(self, '_m_crop_search', None)

        @property
        def filled_cameras(self):
            """The number of cameras whose window is not empty."""
            if hasattr(self, '_m_filled_cameras'):
                return self._m_filled_cameras

            self._m_filled_cameras = (self.crop.columns[-1].filled_through * self.crop.rows[-1].filled_through if self.crop_search.is_found else self.s.count * self.t.count)
            return getattr(self, '_m_filled_cameras', None)

        @property
        def focal_depth(self):
            """Metres, or 0 if there is none. Disparities are finite.
            
            .. seealso::
               lfslab-1.0.md §5.8
            """
            if hasattr(self, '_m_focal_depth'):
                return self._m_focal_depth

            _pos = self._io.pos()
            self._io.seek((40 + 68 * self.index) + 56)
            self._m_focal_depth = self._io.read_f4le()
            _ = self._m_focal_depth
            if not  ((_ == 0) or ( ((self.s.step / _ < self._root.overflow) and ((self.s.step / _) / self.u.step < self._root.overflow) and (self.t.step / _ < self._root.overflow) and ((self.t.step / _) / self.v.step < self._root.overflow)) )) :
                raise kaitaistruct.ValidationExprError(self._m_focal_depth, self._io, u"/types/slab/instances/focal_depth")
            self._io.seek(_pos)
            return getattr(self, '_m_focal_depth', None)

        @property
        def mask(self):
            if hasattr(self, '_m_mask'):
                return self._m_mask

            if self.mask_search.is_found:
                pass
                self._m_mask = self.mask_search.entry.payload

            return getattr(self, '_m_mask', None)

        @property
        def mask_search(self):
            if hasattr(self, '_m_mask_search'):
                return self._m_mask_search

            _pos = self._io.pos()
            self._io.seek(0)
            self._m_mask_search = Lfslab.Search(Lfslab.ChunkKind.mask, self.index, self._io, self, self._root)
            self._io.seek(_pos)
            return getattr(self, '_m_mask_search', None)

        @property
        def stored_cameras(self):
            """
            .. seealso::
               lfslab-1.0.md §6.3
            """
            if hasattr(self, '_m_stored_cameras'):
                return self._m_stored_cameras

            self._m_stored_cameras = (self.mask.cameras[-1].through if self.mask_search.is_found else self.filled_cameras)
            return getattr(self, '_m_stored_cameras', None)

        @property
        def tile_search(self):
            if hasattr(self, '_m_tile_search'):
                return self._m_tile_search

            _pos = self._io.pos()
            self._io.seek(0)
            self._m_tile_search = Lfslab.Search(Lfslab.ChunkKind.tile, self.index, self._io, self, self._root)
            self._io.seek(_pos)
            return getattr(self, '_m_tile_search', None)

        @property
        def tiles(self):
            """
            .. seealso::
               lfslab-1.0.md §7.1
            """
            if hasattr(self, '_m_tiles'):
                return self._m_tiles

            io = self._root._io
            _pos = io.pos()
            io.seek(64 + 48 * self.tile_search.index)
            self._m_tiles = []
            i = 0
            while True:
                _ = Lfslab.Tile(self.tile_search.index + i, (0 if i == 0 else self.tiles[i - 1].cameras_through), (self.tiles[i - 1].raw_through if i > 0 else (self._parent.slabs[self.index - 1].tiles[-1].raw_through if self.index > 0 else 0)), io, self, self._root)
                self._m_tiles.append(_)
                if _.is_last:
                    break
                i += 1
            io.seek(_pos)
            return getattr(self, '_m_tiles', None)

        @property
        def tiles_s(self):
            """
            .. seealso::
               lfslab-1.0.md §7.1
            """
            if hasattr(self, '_m_tiles_s'):
                return self._m_tiles_s

            self._m_tiles_s = ((self.s.count + self.cameras_per_tile_s) - 1) // self.cameras_per_tile_s
            return getattr(self, '_m_tiles_s', None)

        @property
        def tiles_t(self):
            if hasattr(self, '_m_tiles_t'):
                return self._m_tiles_t

            self._m_tiles_t = ((self.t.count + self.cameras_per_tile_t) - 1) // self.cameras_per_tile_t
            return getattr(self, '_m_tiles_t', None)


    class Tag(KaitaiStruct):
        """
        .. seealso::
           lfslab-1.0.md §4.1
        """
        def __init__(self, _io, _parent=None, _root=None):
            super(Lfslab.Tag, self).__init__(_io)
            self._parent = _parent
            self._root = _root
            self._read()

        def _read(self):
            self.letters = []
            for i in range(4):
                self.letters.append(self._io.read_u1())
                _ = self.letters[i]
                if not  (( ((_ >= 48) and (_ <= 57)) ) or ( ((_ >= 65) and (_ <= 90)) ) or ( ((_ >= 97) and (_ <= 122)) )) :
                    raise kaitaistruct.ValidationExprError(self.letters[i], self._io, u"/types/tag/seq/0")



        def _fetch_instances(self):
            pass
            for i in range(len(self.letters)):
                pass

            _ = self.text
            if hasattr(self, '_m_text'):
                pass


        @property
        def text(self):
            if hasattr(self, '_m_text'):
                return self._m_text

            _pos = self._io.pos()
            self._io.seek(0)
            self._m_text = (self._io.read_bytes(4)).decode(u"ASCII")
            self._io.seek(_pos)
            return getattr(self, '_m_text', None)


    class Tile(KaitaiStruct):
        """The entry of a tile, read once more and held to what geometry, windows and mask say of it.
        
        .. seealso::
           lfslab-1.0.md §7
        """
        def __init__(self, index, cameras_before, raw_before, _io, _parent=None, _root=None):
            super(Lfslab.Tile, self).__init__(_io)
            self._parent = _parent
            self._root = _root
            self.index = index
            self.cameras_before = cameras_before
            self.raw_before = raw_before
            self._read()

        def _read(self):
            self.tag = self._io.read_bytes(4)
            if not self.tag == b"\x54\x49\x4C\x45":
                raise kaitaistruct.ValidationNotEqualError(b"\x54\x49\x4C\x45", self.tag, self._io, u"/types/tile/seq/0")
            self.flags = self._io.read_u2le()
            self.packing = KaitaiStream.resolve_enum(Lfslab.Packing, self._io.read_u1())
            _ = self.packing
            if not  ((_ != Lfslab.Packing.tile_codec) or (self._parent.texel_encoding == Lfslab.TexelEncoding.bc1)) :
                raise kaitaistruct.ValidationExprError(self.packing, self._io, u"/types/tile/seq/2")
            self.reserved = self._io.read_u1()
            self.slab = self._io.read_u4le()
            if not self.slab == self._parent.index:
                raise kaitaistruct.ValidationNotEqualError(self._parent.index, self.slab, self._io, u"/types/tile/seq/4")
            self.number = self._io.read_u4le()
            _ = self.number
            if not  ((_ < self._parent.tiles_s * self._parent.tiles_t) and (self.stored_cameras > 0) and ( (((not (self.is_last))) or (self.cameras_through == self._parent.stored_cameras)) )) :
                raise kaitaistruct.ValidationExprError(self.number, self._io, u"/types/tile/seq/5")
            self.offset = self._io.read_u8le()
            self.stored_length = self._io.read_u8le()
            self.raw_length = self._io.read_u8le()
            _ = self.raw_length
            if not  ((self.blocks_wide <= 1073741823) and (self.blocks_high <= 1073741823) and (_ // self._parent.bytes_per_block == self.blocks_wide * self.blocks_high) and (_ % self._parent.bytes_per_block == 0) and (_ <= 18446744073709551615 - self.raw_before)) :
                raise kaitaistruct.ValidationExprError(self.raw_length, self._io, u"/types/tile/seq/8")
            self.checksum = self._io.read_u8le()


        def _fetch_instances(self):
            pass
            _ = self.frame
            if hasattr(self, '_m_frame'):
                pass
                self._m_frame._fetch_instances()

            _ = self.half_floats
            if hasattr(self, '_m_half_floats'):
                pass
                for i in range(len(self._m_half_floats)):
                    pass



        @property
        def blocks_high(self):
            if hasattr(self, '_m_blocks_high'):
                return self._m_blocks_high

            self._m_blocks_high = (self._parent.crop.rows[self.last_t].blocks_through - self._parent.crop.rows[self.first_t].blocks_before if self._parent.crop_search.is_found else ((self.last_t - self.first_t) + 1) * self._parent.blocks_v)
            return getattr(self, '_m_blocks_high', None)

        @property
        def blocks_wide(self):
            """Of the tile's picture.
            
            .. seealso::
               lfslab-1.0.md §7.2
            """
            if hasattr(self, '_m_blocks_wide'):
                return self._m_blocks_wide

            self._m_blocks_wide = (self._parent.crop.columns[self.last_s].blocks_through - self._parent.crop.columns[self.first_s].blocks_before if self._parent.crop_search.is_found else ((self.last_s - self.first_s) + 1) * self._parent.blocks_u)
            return getattr(self, '_m_blocks_wide', None)

        @property
        def cameras_through(self):
            if hasattr(self, '_m_cameras_through'):
                return self._m_cameras_through

            self._m_cameras_through = self.cameras_before + self.stored_cameras
            return getattr(self, '_m_cameras_through', None)

        @property
        def filled_cameras(self):
            if hasattr(self, '_m_filled_cameras'):
                return self._m_filled_cameras

            self._m_filled_cameras = ((self._parent.crop.columns[self.last_s].filled_through - self._parent.crop.columns[self.first_s].filled_before) * (self._parent.crop.rows[self.last_t].filled_through - self._parent.crop.rows[self.first_t].filled_before) if self._parent.crop_search.is_found else ((self.last_s - self.first_s) + 1) * ((self.last_t - self.first_t) + 1))
            return getattr(self, '_m_filled_cameras', None)

        @property
        def first_s(self):
            if hasattr(self, '_m_first_s'):
                return self._m_first_s

            self._m_first_s = (self.number % self._parent.tiles_s) * self._parent.cameras_per_tile_s
            return getattr(self, '_m_first_s', None)

        @property
        def first_t(self):
            if hasattr(self, '_m_first_t'):
                return self._m_first_t

            self._m_first_t = (self.number // self._parent.tiles_s) * self._parent.cameras_per_tile_t
            return getattr(self, '_m_first_t', None)

        @property
        def frame(self):
            """In the tile codec, the content begins with seven lengths of 4 bytes and takes up to 11 bytes a block.
            
            .. seealso::
               lfslab-1.0.md §7.5; codecs.md T.1
            """
            if hasattr(self, '_m_frame'):
                return self._m_frame

            if self.packing != Lfslab.Packing.none:
                pass
                io = self._root._io
                _pos = io.pos()
                io.seek(self.offset)
                self._raw__m_frame = io.read_bytes(self.stored_length)
                _io__raw__m_frame = KaitaiStream(BytesIO(self._raw__m_frame))
                self._m_frame = Lfslab.ZstdFrame((self.raw_length if self.packing == Lfslab.Packing.zstd else 28), (self.raw_length if self.packing == Lfslab.Packing.zstd else 28 + (11 * self.blocks_wide) * self.blocks_high), _io__raw__m_frame, self, self._root)
                io.seek(_pos)

            return getattr(self, '_m_frame', None)

        @property
        def half_floats(self):
            """Texels as bits of binary16, all finite.
            
            .. seealso::
               lfslab-1.0.md §7.9
            """
            if hasattr(self, '_m_half_floats'):
                return self._m_half_floats

            if  ((self.packing == Lfslab.Packing.none) and (self._parent.texel_encoding == Lfslab.TexelEncoding.rgb16f)) :
                pass
                io = self._root._io
                _pos = io.pos()
                io.seek(self.offset)
                self._m_half_floats = []
                for i in range(self.stored_length // 2):
                    self._m_half_floats.append(io.read_u2le())
                    _ = self._m_half_floats[i]
                    if not _ & 31744 != 31744:
                        raise kaitaistruct.ValidationExprError(self._m_half_floats[i], self._io, u"/types/tile/instances/half_floats")

                io.seek(_pos)

            return getattr(self, '_m_half_floats', None)

        @property
        def is_last(self):
            """Of the slab."""
            if hasattr(self, '_m_is_last'):
                return self._m_is_last

            self._m_is_last =  ((self._root.directory[self.index].is_last) or (self._root.directory[self.index + 1].kind != Lfslab.ChunkKind.tile) or (self._root.directory[self.index + 1].slab != self.slab)) 
            return getattr(self, '_m_is_last', None)

        @property
        def last_s(self):
            if hasattr(self, '_m_last_s'):
                return self._m_last_s

            self._m_last_s = ((self.first_s + self._parent.cameras_per_tile_s) - 1 if self.first_s + self._parent.cameras_per_tile_s < self._parent.s.count else self._parent.s.count - 1)
            return getattr(self, '_m_last_s', None)

        @property
        def last_t(self):
            if hasattr(self, '_m_last_t'):
                return self._m_last_t

            self._m_last_t = ((self.first_t + self._parent.cameras_per_tile_t) - 1 if self.first_t + self._parent.cameras_per_tile_t < self._parent.t.count else self._parent.t.count - 1)
            return getattr(self, '_m_last_t', None)

        @property
        def raw_through(self):
            if hasattr(self, '_m_raw_through'):
                return self._m_raw_through

            self._m_raw_through = self.raw_before + self.raw_length
            return getattr(self, '_m_raw_through', None)

        @property
        def stored_cameras(self):
            if hasattr(self, '_m_stored_cameras'):
                return self._m_stored_cameras

            self._m_stored_cameras = (((self._parent.mask.cameras[self.last_t * self._parent.s.count + self.last_s].through - self._parent.mask.cameras[self.last_t * self._parent.s.count + self.first_s].left) - self._parent.mask.cameras[self.first_t * self._parent.s.count + self.last_s].above) + self._parent.mask.cameras[self.first_t * self._parent.s.count + self.first_s].before if self._parent.mask_search.is_found else self.filled_cameras)
            return getattr(self, '_m_stored_cameras', None)


    class Utf8Character(KaitaiStruct):
        """Well-formed, and no control character but TAB and LF.
        
        .. seealso::
           lfslab-1.0.md §8.4; RFC 3629 section 4
        """
        def __init__(self, _io, _parent=None, _root=None):
            super(Lfslab.Utf8Character, self).__init__(_io)
            self._parent = _parent
            self._root = _root
            self._read()

        def _read(self):
            self.lead = self._io.read_u1()
            _ = self.lead
            if not  ((_ == 9) or (_ == 10) or ( ((_ >= 32) and (_ <= 126)) ) or ( ((_ >= 194) and (_ <= 244)) )) :
                raise kaitaistruct.ValidationExprError(self.lead, self._io, u"/types/utf8_character/seq/0")
            if self.lead >= 194:
                pass
                self.second = self._io.read_u1()
                if not self.second >= (160 if self.lead == 224 else (144 if self.lead == 240 else 128)):
                    raise kaitaistruct.ValidationLessThanError((160 if self.lead == 224 else (144 if self.lead == 240 else 128)), self.second, self._io, u"/types/utf8_character/seq/1")
                if not self.second <= (159 if self.lead == 237 else (143 if self.lead == 244 else 191)):
                    raise kaitaistruct.ValidationGreaterThanError((159 if self.lead == 237 else (143 if self.lead == 244 else 191)), self.second, self._io, u"/types/utf8_character/seq/1")

            self.others = []
            for i in range((2 if self.lead >= 240 else (1 if self.lead >= 224 else 0))):
                self.others.append(self._io.read_u1())
                if not self.others[i] >= 128:
                    raise kaitaistruct.ValidationLessThanError(128, self.others[i], self._io, u"/types/utf8_character/seq/2")
                if not self.others[i] <= 191:
                    raise kaitaistruct.ValidationGreaterThanError(191, self.others[i], self._io, u"/types/utf8_character/seq/2")



        def _fetch_instances(self):
            pass
            if self.lead >= 194:
                pass

            for i in range(len(self.others)):
                pass



    class Window(KaitaiStruct):
        def __init__(self, limit, blocks_before, filled_before, _io, _parent=None, _root=None):
            super(Lfslab.Window, self).__init__(_io)
            self._parent = _parent
            self._root = _root
            self.limit = limit
            self.blocks_before = blocks_before
            self.filled_before = filled_before
            self._read()

        def _read(self):
            self.first = self._io.read_u4le()
            self.blocks = self._io.read_u4le()
            _ = self.blocks
            if not (self.first == 0 if _ == 0 else  ((self.first < self.limit) and (_ <= self.limit - self.first)) ):
                raise kaitaistruct.ValidationExprError(self.blocks, self._io, u"/types/window/seq/1")


        def _fetch_instances(self):
            pass

        @property
        def blocks_through(self):
            if hasattr(self, '_m_blocks_through'):
                return self._m_blocks_through

            self._m_blocks_through = self.blocks_before + self.blocks
            return getattr(self, '_m_blocks_through', None)

        @property
        def filled_through(self):
            if hasattr(self, '_m_filled_through'):
                return self._m_filled_through

            self._m_filled_through = self.filled_before + (1 if self.blocks > 0 else 0)
            return getattr(self, '_m_filled_through', None)


    class ZstdBlock(KaitaiStruct):
        """
        .. seealso::
           RFC 8878 section 3.1.1.2
        """
        def __init__(self, _io, _parent=None, _root=None):
            super(Lfslab.ZstdBlock, self).__init__(_io)
            self._parent = _parent
            self._root = _root
            self._read()

        def _read(self):
            self.is_last = self._io.read_bits_int_le(1) != 0
            self.kind = KaitaiStream.resolve_enum(Lfslab.ZstdBlockKind, self._io.read_bits_int_le(2))
            if not isinstance(self.kind, Lfslab.ZstdBlockKind):
                raise kaitaistruct.ValidationNotInEnumError(self.kind, self._io, u"/types/zstd_block/seq/1")
            self.len_content = self._io.read_bits_int_le(21)
            self.content = self._io.read_bytes((1 if self.kind == Lfslab.ZstdBlockKind.repeated else self.len_content))


        def _fetch_instances(self):
            pass


    class ZstdFrame(KaitaiStruct):
        """
        .. seealso::
           lfslab-1.0.md §7.5; RFC 8878 section 3.1.1
        """
        def __init__(self, least, most, _io, _parent=None, _root=None):
            super(Lfslab.ZstdFrame, self).__init__(_io)
            self._parent = _parent
            self._root = _root
            self.least = least
            self.most = most
            self._read()

        def _read(self):
            self.magic = self._io.read_bytes(4)
            if not self.magic == b"\x28\xB5\x2F\xFD":
                raise kaitaistruct.ValidationNotEqualError(b"\x28\xB5\x2F\xFD", self.magic, self._io, u"/types/zstd_frame/seq/0")
            self.dictionary_id_flag = self._io.read_bits_int_le(2)
            self.has_checksum = self._io.read_bits_int_le(1) != 0
            self.reserved = self._io.read_bits_int_le(1) != 0
            _ = self.reserved
            if not (not (_)):
                raise kaitaistruct.ValidationExprError(self.reserved, self._io, u"/types/zstd_frame/seq/3")
            self.unused = self._io.read_bits_int_le(1) != 0
            self.is_single_segment = self._io.read_bits_int_le(1) != 0
            self.content_size_flag = self._io.read_bits_int_le(2)
            _ = self.content_size_flag
            if not  ((_ > 0) or (self.is_single_segment)) :
                raise kaitaistruct.ValidationExprError(self.content_size_flag, self._io, u"/types/zstd_frame/seq/6")
            if (not (self.is_single_segment)):
                pass
                self.window = self._io.read_u1()
                if not self.window <= 104:
                    raise kaitaistruct.ValidationGreaterThanError(104, self.window, self._io, u"/types/zstd_frame/seq/7")

            self.dictionary_id = []
            for i in range((4 if self.dictionary_id_flag == 3 else self.dictionary_id_flag)):
                self.dictionary_id.append(self._io.read_u1())
                if not self.dictionary_id[i] == 0:
                    raise kaitaistruct.ValidationNotEqualError(0, self.dictionary_id[i], self._io, u"/types/zstd_frame/seq/8")

            _on = self.content_size_flag
            if _on == 0:
                pass
                self.stated_size = self._io.read_u1()
            elif _on == 1:
                pass
                self.stated_size = self._io.read_u2le()
            elif _on == 2:
                pass
                self.stated_size = self._io.read_u4le()
            elif _on == 3:
                pass
                self.stated_size = self._io.read_u8le()
            _ = self.stated_size
            if not  ((self.content_size >= self.least) and (self.content_size <= self.most) and ( (((not (self.is_single_segment))) or (self.content_size <= 8388608)) )) :
                raise kaitaistruct.ValidationExprError(self.stated_size, self._io, u"/types/zstd_frame/seq/9")
            self.blocks = []
            i = 0
            while True:
                _ = Lfslab.ZstdBlock(self._io, self, self._root)
                self.blocks.append(_)
                if _.is_last:
                    break
                i += 1
            if self.has_checksum:
                pass
                self.checksum = self._io.read_u4le()

            self.rest = self._io.read_bytes_full()
            _ = self.rest
            if not len(_) == 0:
                raise kaitaistruct.ValidationExprError(self.rest, self._io, u"/types/zstd_frame/seq/12")


        def _fetch_instances(self):
            pass
            if (not (self.is_single_segment)):
                pass

            for i in range(len(self.dictionary_id)):
                pass

            _on = self.content_size_flag
            if _on == 0:
                pass
            elif _on == 1:
                pass
            elif _on == 2:
                pass
            elif _on == 3:
                pass
            for i in range(len(self.blocks)):
                pass
                self.blocks[i]._fetch_instances()

            if self.has_checksum:
                pass


        @property
        def content_size(self):
            if hasattr(self, '_m_content_size'):
                return self._m_content_size

            self._m_content_size = self.stated_size + (256 if self.content_size_flag == 1 else 0)
            return getattr(self, '_m_content_size', None)


    @property
    def geom(self):
        if hasattr(self, '_m_geom'):
            return self._m_geom

        self._m_geom = self.directory[0].payload
        return getattr(self, '_m_geom', None)

    @property
    def largest(self):
        """The largest finite binary32."""
        if hasattr(self, '_m_largest'):
            return self._m_largest

        self._m_largest = 3.4028234663852886E+38
        return getattr(self, '_m_largest', None)

    @property
    def overflow(self):
        """The least magnitude that becomes infinite when it is rounded to binary32."""
        if hasattr(self, '_m_overflow'):
            return self._m_overflow

        self._m_overflow = 3.4028235677973366E+38
        return getattr(self, '_m_overflow', None)


