# Calls for version 0.11 of the compiler. `tests/third_party/kaitai` compiles it and parses the files in `vectors` with it.
meta:
  id: lfslab
  title: Light field slabs, version 1.0
  file-extension: lfslab
  license: MIT OR Apache-2.0
  ks-version: 0.11
  endian: le
  bit-endian: le
doc: |
  One environment light field: a cell, one to six slabs of cameras around it, and the cameras' images in tiles.

  The text `lfslab-1.0.md` is normative, this description is not. Reading a file with it and fetching all instances holds the
  file to what the text asks of it, but for what this language cannot say: checksums, what is inside a zstd block and in the
  tile codec's streams, and rules for writers alone. Chunks with an unknown tag are left as bytes, and refused if critical.
doc-ref: lfslab-1.0.md
seq:
  - id: header
    type: header
  - id: directory
    type: entry(_index)
    repeat: expr
    repeat-expr: header.entry_count
    doc-ref: lfslab-1.0.md §4
instances:
  geom:
    value: directory[0].payload.as<geom>
  largest:
    value: '3.4028234663852886e38'
    doc: The largest finite binary32.
  overflow:
    value: '3.4028235677973366e38'
    doc: The least magnitude that becomes infinite when it is rounded to binary32.

types:
  header:
    doc-ref: lfslab-1.0.md §3
    seq:
      - id: magic
        contents: [0x8a, 'LFSLAB', 0, 0x0d, 0x0a, 0x1a, 0x0a]
        doc-ref: lfslab-1.0.md §3.1
      - id: major_version
        type: u2
        valid: 1
        doc-ref: lfslab-1.0.md §3.2
      - id: minor_version
        type: u2
        doc: Any.
        doc-ref: lfslab-1.0.md §3.2
      - id: file_length
        type: u8
        valid: _root._io.size
        doc-ref: lfslab-1.0.md §3.3
      - id: directory_offset
        type: u8
        valid: 64
        doc-ref: lfslab-1.0.md §3.4
      - id: entry_count
        type: u4
        valid:
          expr: _ >= 2 and _ <= 65536 and directory_offset + 48 * _ <= file_length
        doc-ref: lfslab-1.0.md §3.5
      - id: reserved_36
        contents: [0, 0, 0, 0]
        doc-ref: lfslab-1.0.md §3.6
      - id: directory_checksum
        type: u8
        doc: XXH64 of the directory.
        doc-ref: lfslab-1.0.md §3.7
      - id: reserved_48
        contents: [0, 0, 0, 0, 0, 0, 0, 0]
        doc-ref: lfslab-1.0.md §3.6
      - id: header_checksum
        type: u8
        doc: XXH64 of bytes 0 to 55.
        doc-ref: lfslab-1.0.md §3.8

  entry:
    doc: An entry of the directory, and the chunk that it describes.
    doc-ref: lfslab-1.0.md §4
    params:
      - id: index
        type: u4
    seq:
      - id: tag
        type: tag
        size: 4
        valid:
          expr: 'index == 0 ? kind == chunk_kind::geom : kind != chunk_kind::geom and kind.to_i >= previous.kind.to_i'
        doc-ref: lfslab-1.0.md §4.1, §4.10
      - id: flags
        type: u2
        valid:
          expr: 'kind == chunk_kind::meta ? _ == 2 : kind == chunk_kind::other ? _ == 0 or _ == 2 : _ == 1'
        doc: 1 is critical, 2 is safe to copy. A critical chunk with an unknown tag is not supported.
        doc-ref: lfslab-1.0.md §4.2
      - id: packing
        type: u1
        enum: packing
        valid:
          expr: >-
            kind == chunk_kind::other or _ == packing::none
            or kind == chunk_kind::tile and (_ == packing::zstd or _ == packing::tile_codec)
        doc-ref: lfslab-1.0.md §4.3
      - id: reserved
        type: u1
        valid: 0
        doc-ref: lfslab-1.0.md §4.9
      - id: slab
        type: u4
        valid:
          expr: >-
            kind == chunk_kind::other
            or (kind == chunk_kind::geom or kind == chunk_kind::meta ? _ == 0 : _ < _root.geom.slab_count)
        doc-ref: lfslab-1.0.md §4.4
      - id: tile
        type: u4
        valid:
          expr: >-
            (kind == chunk_kind::tile or kind == chunk_kind::other or _ == 0)
            and (index == 0 or kind != previous.kind or is_after_previous)
        doc-ref: lfslab-1.0.md §4.4, §4.10
      - id: offset
        type: u8
        valid: (previous_end + 63) / 64 * 64
        doc-ref: lfslab-1.0.md §4.5
      - id: stored_length
        type: u8
        valid:
          expr: >-
            _ >= 1 and offset <= _root._io.size
            and (is_last ? _ == _root._io.size - offset : _ <= _root._io.size - offset)
            and (kind != chunk_kind::meta or _ <= 1048576)
        doc: The last payload ends with the file. `META` has a bound of its own.
        doc-ref: lfslab-1.0.md §4.5, §4.6, §8
      - id: raw_length
        type: u8
        valid:
          expr: packing != packing::none or _ == stored_length
        doc: That of tiles is held to the geometry in `tile`.
        doc-ref: lfslab-1.0.md §4.7
      - id: checksum
        type: u8
        doc: XXH64 of the first 16 bytes of the entry and the stored bytes of the payload.
        doc-ref: lfslab-1.0.md §4.8
    instances:
      kind:
        value: >-
          tag.text == 'GEOM' ? chunk_kind::geom : tag.text == 'META' ? chunk_kind::meta
          : tag.text == 'CROP' ? chunk_kind::crop : tag.text == 'MASK' ? chunk_kind::mask
          : tag.text == 'TILE' ? chunk_kind::tile : chunk_kind::other
      previous:
        value: _root.directory[index - 1]
        if: index > 0
      previous_end:
        value: 'index == 0 ? 64 + 48 * _root.header.entry_count : previous.offset + previous.stored_length'
        doc: Where the payload before this one ends, or the directory.
      is_last:
        value: index + 1 == _root.header.entry_count
      is_after_previous:
        value: >-
          tag.text > previous.tag.text
          or tag.text == previous.tag.text and (slab > previous.slab or slab == previous.slab and tile > previous.tile)
        if: index > 0
        doc: By tag, slab and tile; for two entries of the same kind.
      padding:
        pos: previous_end
        type: u1
        repeat: expr
        repeat-expr: offset - previous_end
        valid: 0
        doc-ref: lfslab-1.0.md §4.5
      payload:
        pos: offset
        size: stored_length
        type:
          switch-on: kind
          cases:
            chunk_kind::geom: geom
            chunk_kind::meta: meta
            chunk_kind::crop: crop(slab)
            chunk_kind::mask: mask(slab)
        doc: As stored. `slab.tiles` tells what is in those of tiles.

  tag:
    doc-ref: lfslab-1.0.md §4.1
    seq:
      - id: letters
        type: u1
        repeat: expr
        repeat-expr: 4
        valid:
          expr: _ >= 0x30 and _ <= 0x39 or _ >= 0x41 and _ <= 0x5a or _ >= 0x61 and _ <= 0x7a
    instances:
      text:
        pos: 0
        size: 4
        type: str
        encoding: ASCII

  geom:
    doc: Cell and slabs.
    doc-ref: lfslab-1.0.md §5
    seq:
      - id: center
        type: f8
        repeat: expr
        repeat-expr: 3
        valid:
          min: '-1.7976931348623157e308'
          max: '1.7976931348623157e308'
        doc: x, y, z in world space, metres.
        doc-ref: lfslab-1.0.md §5.1
      - id: half_extent
        type: f4
        repeat: expr
        repeat-expr: 3
        valid:
          expr: _ > 0 and _ <= _root.largest
        doc: x, y, z, metres.
        doc-ref: lfslab-1.0.md §5.1
      - id: slab_count
        type: u4
        valid:
          min: 1
          max: 6
        doc-ref: lfslab-1.0.md §5.2
      - id: slabs
        type: slab(_index)
        repeat: expr
        repeat-expr: slab_count
      - id: rest
        size-eos: true
        valid:
          expr: _.length == 0
        doc-ref: lfslab-1.0.md §5.11

  slab:
    doc-ref: lfslab-1.0.md §5
    params:
      - id: index
        type: u4
    seq:
      - id: face
        type: u1
        enum: face
        valid:
          expr: _.to_i <= 5 and (index == 0 or _.to_i > _parent.slabs[index - 1].face.to_i)
        doc-ref: lfslab-1.0.md §5.3
      - id: texel_encoding
        type: u1
        enum: texel_encoding
        valid:
          in-enum: true
        doc-ref: lfslab-1.0.md §5.4
      - id: transfer_function
        type: u1
        enum: transfer_function
        valid:
          expr: '_ == (texel_encoding == texel_encoding::rgb16f ? transfer_function::linear : transfer_function::srgb)'
        doc-ref: lfslab-1.0.md §5.5
      - id: reserved
        type: u1
        valid: 0
        doc-ref: lfslab-1.0.md §5.10
      - id: plane
        type: f4
        valid:
          min: -_root.largest
          max: _root.largest
        doc: Coordinate along the axis of the face, in cell space, metres.
        doc-ref: lfslab-1.0.md §5.6
      - id: s
        type: axis
        doc: Camera positions, metres.
      - id: t
        type: axis
        doc: Camera positions, metres.
      - id: u
        type: axis
        doc: Slopes of the images' columns.
      - id: v
        type: axis
        doc: Slopes of the images' rows.
      - id: focal_depth_bits
        type: u4
        valid:
          max: 0x7f7fffff
        doc: As binary32 that is neither negative, as negative zero is, nor infinite nor a NaN.
        doc-ref: lfslab-1.0.md §5.8
      - id: cameras_per_tile_s
        type: u4
        valid:
          min: 1
          max: s.count
        doc-ref: lfslab-1.0.md §5.9
      - id: cameras_per_tile_t
        type: u4
        valid:
          expr: _ >= 1 and _ <= t.count and tiles_s * tiles_t <= 0xffff_ffff
        doc-ref: lfslab-1.0.md §5.9
    instances:
      focal_depth:
        pos: 40 + 68 * index + 56
        type: f4
        valid:
          expr: >-
            _ == 0 or s.step / _ < _root.overflow and s.step / _ / u.step < _root.overflow
            and t.step / _ < _root.overflow and t.step / _ / v.step < _root.overflow
        doc: Metres, or 0 if there is none. Disparities are finite.
        doc-ref: lfslab-1.0.md §5.8
      blocks_u:
        value: (u.count + 3) / 4
        doc: Blocks of 4 texels along u of a whole image.
      blocks_v:
        value: (v.count + 3) / 4
      tiles_s:
        value: (s.count + cameras_per_tile_s - 1) / cameras_per_tile_s
        doc-ref: lfslab-1.0.md §7.1
      tiles_t:
        value: (t.count + cameras_per_tile_t - 1) / cameras_per_tile_t
      bytes_per_block:
        value: 'texel_encoding == texel_encoding::bc1 ? 8 : texel_encoding == texel_encoding::rgba8 ? 64 : 96'
        doc: Of 4×4 texels.
        doc-ref: lfslab-1.0.md §7.2
      crop_search:
        pos: 0
        type: search(chunk_kind::crop, index)
      mask_search:
        pos: 0
        type: search(chunk_kind::mask, index)
      tile_search:
        pos: 0
        type: search(chunk_kind::tile, index)
      crop:
        value: crop_search.entry.payload.as<crop>
        if: crop_search.is_found
      mask:
        value: mask_search.entry.payload.as<mask>
        if: mask_search.is_found
      filled_cameras:
        value: 'crop_search.is_found ? crop.columns.last.filled_through * crop.rows.last.filled_through : s.count * t.count'
        doc: The number of cameras whose window is not empty.
      stored_cameras:
        value: 'mask_search.is_found ? mask.cameras.last.through : filled_cameras'
        doc-ref: lfslab-1.0.md §6.3
      tiles:
        io: _root._io
        pos: 64 + 48 * tile_search.index
        type: >-
          tile(tile_search.index + _index,
          _index == 0 ? 0 : tiles[_index - 1].cameras_through,
          _index > 0 ? tiles[_index - 1].raw_through : index > 0 ? _parent.slabs[index - 1].tiles.last.raw_through : 0)
        repeat: until
        repeat-until: _.is_last
        doc-ref: lfslab-1.0.md §7.1

  axis:
    doc: |
      Sample i lies at first + i·step. The last one is evaluated here without rounding the product, which makes a difference to
      what is within half a unit in the last place of the largest number.
    doc-ref: lfslab-1.0.md §5.7
    seq:
      - id: first
        type: f4
        valid:
          min: -_root.largest
          max: _root.largest
      - id: step
        type: f4
        valid:
          expr: _ > 0 and _ <= _root.largest
      - id: count
        type: u4
        valid:
          expr: >-
            _ >= 1 and _ <= 65536
            and (_ - 1) * step < _root.overflow and first + (_ - 1) * step < _root.overflow

  search:
    doc: |
      The first entry that does not come before those of a kind and slab: the one sought, if there is one. A type without bytes.
    params:
      - id: kind
        type: u1
        enum: chunk_kind
      - id: slab
        type: u4
    seq:
      - id: steps
        type: step(_index)
        repeat: until
        repeat-until: >-
          _.entry.is_last or _.entry.kind.to_i > kind.to_i or _.entry.kind == kind and _.entry.slab >= slab
    instances:
      index:
        value: steps.size - 1
      entry:
        value: steps.last.entry
      is_found:
        value: entry.kind == kind and entry.slab == slab
    types:
      step:
        params:
          - id: index
            type: u4
        instances:
          entry:
            value: _root.directory[index]

  crop:
    doc: Windows of a slab's images, in blocks of 4 texels.
    doc-ref: lfslab-1.0.md §6.1
    params:
      - id: slab_index
        type: u4
    seq:
      - id: columns
        type: >-
          window(slab.blocks_u,
          _index == 0 ? 0 : columns[_index - 1].blocks_through, _index == 0 ? 0 : columns[_index - 1].filled_through)
        repeat: expr
        repeat-expr: slab.s.count
      - id: rows
        type: >-
          window(slab.blocks_v,
          _index == 0 ? 0 : rows[_index - 1].blocks_through, _index == 0 ? 0 : rows[_index - 1].filled_through)
        repeat: expr
        repeat-expr: slab.t.count
      - id: rest
        size-eos: true
        valid:
          expr: >-
            _.length == 0 and (columns.last.blocks_through < slab.s.count * slab.blocks_u
            or rows.last.blocks_through < slab.t.count * slab.blocks_v)
        doc: Nothing. One block at least is left out.
    instances:
      slab:
        value: _root.geom.slabs[slab_index]

  window:
    params:
      - id: limit
        type: u4
        doc: Blocks of the whole image.
      - id: blocks_before
        type: u8
        doc: Blocks in the windows before this one.
      - id: filled_before
        type: u8
        doc: Windows before this one that are not empty.
    seq:
      - id: first
        type: u4
      - id: blocks
        type: u4
        valid:
          expr: '_ == 0 ? first == 0 : first < limit and _ <= limit - first'
    instances:
      blocks_through:
        value: blocks_before + blocks
      filled_through:
        value: 'filled_before + (blocks > 0 ? 1 : 0)'

  mask:
    doc: Which cameras of a slab are stored. Camera (s, t) has the number t·N_s + s.
    doc-ref: lfslab-1.0.md §6.2
    params:
      - id: slab_index
        type: u4
    seq:
      - id: stored
        type: b1
        repeat: expr
        repeat-expr: slab.s.count * slab.t.count
        valid:
          expr: >-
            not _ or not slab.crop_search.is_found
            or slab.crop.columns[_index % slab.s.count].blocks > 0 and slab.crop.rows[_index / slab.s.count].blocks > 0
      - id: beyond
        type: b1
        repeat: expr
        repeat-expr: 7 - (slab.s.count * slab.t.count + 7) % 8
        valid:
          expr: not _
        doc: The bits that fill the last byte.
      - id: cameras
        type: >-
          camera(stored[_index].to_i,
          _index % slab.s.count == 0 ? 0 : cameras[_index - 1].in_row,
          _index < slab.s.count ? 0 : cameras[_index - slab.s.count].left,
          _index < slab.s.count ? 0 : cameras[_index - slab.s.count].through)
        repeat: expr
        repeat-expr: slab.s.count * slab.t.count
      - id: rest
        size-eos: true
        valid:
          expr: _.length == 0 and cameras.last.through < slab.filled_cameras
        doc: Nothing. One camera at least is left out that has a window.
    instances:
      slab:
        value: _root.geom.slabs[slab_index]

  camera:
    doc: Numbers of stored cameras, from which follows how many are in a tile. A type without bytes.
    params:
      - id: stored
        type: u1
        doc: 1 if this camera is stored.
      - id: in_row_before
        type: u8
        doc: In this row, in columns before this one.
      - id: before
        type: u8
        doc: In rows and in columns before this one.
      - id: above
        type: u8
        doc: In rows before this one, in columns up to and with this one.
    instances:
      in_row:
        value: in_row_before + stored
      left:
        value: before + in_row_before
        doc: In columns before this one, in rows up to and with this one.
      through:
        value: above + in_row
        doc: In rows and in columns up to and with this one.

  tile:
    doc: The entry of a tile, read once more and held to what geometry, windows and mask say of it.
    doc-ref: lfslab-1.0.md §7
    params:
      - id: index
        type: u4
        doc: Of the entry.
      - id: cameras_before
        type: u8
        doc: Stored cameras in the slab's tiles before this one.
      - id: raw_before
        type: u8
        doc: Bytes of all tiles before this one, unpacked.
    seq:
      - id: tag
        contents: TILE
      - id: flags
        type: u2
      - id: packing
        type: u1
        enum: packing
        valid:
          expr: _ != packing::tile_codec or _parent.texel_encoding == texel_encoding::bc1
        doc-ref: lfslab-1.0.md §4.3
      - id: reserved
        type: u1
      - id: slab
        type: u4
        valid: _parent.index
        doc: Every slab has a tile.
      - id: number
        type: u4
        valid:
          expr: >-
            _ < _parent.tiles_s * _parent.tiles_t and stored_cameras > 0
            and (not is_last or cameras_through == _parent.stored_cameras)
        doc: With the last tile, all stored cameras are in one.
        doc-ref: lfslab-1.0.md §4.10, §7.1
      - id: offset
        type: u8
      - id: stored_length
        type: u8
      - id: raw_length
        type: u8
        valid:
          expr: >-
            blocks_wide <= 0x3fff_ffff and blocks_high <= 0x3fff_ffff
            and _ / _parent.bytes_per_block == blocks_wide * blocks_high and _ % _parent.bytes_per_block == 0
            and _ <= 0xffff_ffff_ffff_ffff - raw_before
        doc-ref: lfslab-1.0.md §4.7, §5.9, §7.2
      - id: checksum
        type: u8
    instances:
      is_last:
        value: >-
          _root.directory[index].is_last or _root.directory[index + 1].kind != chunk_kind::tile
          or _root.directory[index + 1].slab != slab
        doc: Of the slab.
      first_s:
        value: number % _parent.tiles_s * _parent.cameras_per_tile_s
      first_t:
        value: number / _parent.tiles_s * _parent.cameras_per_tile_t
      last_s:
        value: >-
          first_s + _parent.cameras_per_tile_s < _parent.s.count ? first_s + _parent.cameras_per_tile_s - 1
          : _parent.s.count - 1
      last_t:
        value: >-
          first_t + _parent.cameras_per_tile_t < _parent.t.count ? first_t + _parent.cameras_per_tile_t - 1
          : _parent.t.count - 1
      blocks_wide:
        value: >-
          _parent.crop_search.is_found
          ? _parent.crop.columns[last_s].blocks_through - _parent.crop.columns[first_s].blocks_before
          : (last_s - first_s + 1) * _parent.blocks_u
        doc: Of the tile's picture.
        doc-ref: lfslab-1.0.md §7.2
      blocks_high:
        value: >-
          _parent.crop_search.is_found
          ? _parent.crop.rows[last_t].blocks_through - _parent.crop.rows[first_t].blocks_before
          : (last_t - first_t + 1) * _parent.blocks_v
      filled_cameras:
        value: >-
          _parent.crop_search.is_found
          ? (_parent.crop.columns[last_s].filled_through - _parent.crop.columns[first_s].filled_before)
          * (_parent.crop.rows[last_t].filled_through - _parent.crop.rows[first_t].filled_before)
          : (last_s - first_s + 1) * (last_t - first_t + 1)
      stored_cameras:
        value: >-
          _parent.mask_search.is_found
          ? _parent.mask.cameras[last_t * _parent.s.count + last_s].through
          - _parent.mask.cameras[last_t * _parent.s.count + first_s].left
          - _parent.mask.cameras[first_t * _parent.s.count + last_s].above
          + _parent.mask.cameras[first_t * _parent.s.count + first_s].before
          : filled_cameras
      cameras_through:
        value: cameras_before + stored_cameras
      raw_through:
        value: raw_before + raw_length
      half_floats:
        io: _root._io
        pos: offset
        type: u2
        repeat: expr
        repeat-expr: stored_length / 2
        if: packing == packing::none and _parent.texel_encoding == texel_encoding::rgb16f
        valid:
          expr: _ & 0x7c00 != 0x7c00
        doc: Texels as bits of binary16, all finite.
        doc-ref: lfslab-1.0.md §7.9
      frame:
        io: _root._io
        pos: offset
        size: stored_length
        type: >-
          zstd_frame(packing == packing::zstd ? raw_length : 28,
          packing == packing::zstd ? raw_length : 28 + 11 * blocks_wide * blocks_high)
        if: packing != packing::none
        doc: In the tile codec, the content begins with seven lengths of 4 bytes and takes up to 11 bytes a block.
        doc-ref: lfslab-1.0.md §7.5; codecs.md T.1

  zstd_frame:
    doc-ref: lfslab-1.0.md §7.5; RFC 8878 section 3.1.1
    params:
      - id: least
        type: u8
        doc: Bytes of content.
      - id: most
        type: u8
    seq:
      - id: magic
        contents: [0x28, 0xb5, 0x2f, 0xfd]
      - id: dictionary_id_flag
        type: b2
      - id: has_checksum
        type: b1
      - id: reserved
        type: b1
        valid:
          expr: not _
      - id: unused
        type: b1
      - id: is_single_segment
        type: b1
      - id: content_size_flag
        type: b2
        valid:
          expr: _ > 0 or is_single_segment
        doc: The content size is stated.
      - id: window
        type: u1
        if: not is_single_segment
        valid:
          max: 104
        doc: At most 8 MiB.
      - id: dictionary_id
        type: u1
        repeat: expr
        repeat-expr: 'dictionary_id_flag == 3 ? 4 : dictionary_id_flag'
        valid: 0
        doc: No dictionary.
      - id: stated_size
        type:
          switch-on: content_size_flag
          cases:
            0: u1
            1: u2
            2: u4
            3: u8
        valid:
          expr: content_size >= least and content_size <= most and (not is_single_segment or content_size <= 0x80_0000)
      - id: blocks
        type: >-
          zstd_block(_index == 0 ? 0 : blocks[_index - 1].least_through, _index == 0 ? 0 : blocks[_index - 1].most_through)
        repeat: until
        repeat-until: _.is_last
      - id: checksum
        type: u4
        if: has_checksum
      - id: rest
        size-eos: true
        valid:
          expr: _.length == 0 and content_size >= blocks.last.least_through and content_size <= blocks.last.most_through
        doc: Nothing follows the frame. Its blocks can have the content that it states.
    instances:
      content_size:
        value: 'stated_size + (content_size_flag == 1 ? 256 : 0)'

  zstd_block:
    doc-ref: RFC 8878 section 3.1.1.2
    params:
      - id: least_before
        type: u8
        doc: Bytes that the blocks before this one hold, at least and at most, when unpacked.
      - id: most_before
        type: u8
    seq:
      - id: is_last
        type: b1
      - id: kind
        type: b2
        enum: zstd_block_kind
        valid:
          in-enum: true
      - id: len_content
        type: b21
        valid:
          max: 131072
      - id: content
        size: 'kind == zstd_block_kind::repeated ? 1 : len_content'
    instances:
      least_through:
        value: 'least_before + (kind == zstd_block_kind::compressed ? 0 : len_content)'
      most_through:
        value: 'most_before + (kind == zstd_block_kind::compressed ? 131072 : len_content)'

  meta:
    doc: Text for people and tools.
    doc-ref: lfslab-1.0.md §8
    seq:
      - id: count
        type: u4
        valid:
          min: 1
        doc-ref: lfslab-1.0.md §8.1
      - id: entries
        type: meta_entry(_index)
        repeat: expr
        repeat-expr: count
      - id: rest
        size-eos: true
        valid:
          expr: _.length == 0
        doc-ref: lfslab-1.0.md §8.2

  meta_entry:
    doc-ref: lfslab-1.0.md §8.2
    params:
      - id: index
        type: u4
    seq:
      - id: len_key
        type: u2
        valid:
          min: 1
          max: 64
        doc-ref: lfslab-1.0.md §8.3
      - id: len_value
        type: u4
        valid:
          max: 65536
        doc-ref: lfslab-1.0.md §8.4
      - id: key
        type: meta_key
        size: len_key
        valid:
          expr: index == 0 or _.text > _parent.entries[index - 1].key.text
        doc: In ascending order.
      - id: value
        type: meta_value
        size: len_value

  meta_key:
    doc-ref: lfslab-1.0.md §8.3
    seq:
      - id: characters
        type: u1
        repeat: eos
        valid:
          expr: _ >= 0x61 and _ <= 0x7a or _ >= 0x30 and _ <= 0x39 or _ == 0x2e or _ == 0x5f or _ == 0x2d
    instances:
      text:
        pos: 0
        size-eos: true
        type: str
        encoding: ASCII

  meta_value:
    doc-ref: lfslab-1.0.md §8.4
    seq:
      - id: characters
        type: utf8_character
        repeat: eos
    instances:
      text:
        pos: 0
        size-eos: true
        type: str
        encoding: UTF-8

  utf8_character:
    doc: Well-formed, and no control character but TAB and LF.
    doc-ref: lfslab-1.0.md §8.4; RFC 3629 section 4
    seq:
      - id: lead
        type: u1
        valid:
          expr: _ == 9 or _ == 10 or _ >= 0x20 and _ <= 0x7e or _ >= 0xc2 and _ <= 0xf4
      - id: second
        type: u1
        if: lead >= 0xc2
        valid:
          min: 'lead == 0xe0 ? 0xa0 : lead == 0xf0 ? 0x90 : 0x80'
          max: 'lead == 0xed ? 0x9f : lead == 0xf4 ? 0x8f : 0xbf'
      - id: others
        type: u1
        repeat: expr
        repeat-expr: 'lead >= 0xf0 ? 2 : lead >= 0xe0 ? 1 : 0'
        valid:
          min: 0x80
          max: 0xbf

enums:
  chunk_kind:
    0: geom
    1: meta
    2: crop
    3: mask
    4: tile
    5: other
  packing:
    0: none
    1: zstd
    2: tile_codec
  face:
    0: x_positive
    1: x_negative
    2: y_positive
    3: y_negative
    4: z_positive
    5: z_negative
  texel_encoding:
    1: bc1
    2: rgba8
    3: rgb16f
  transfer_function:
    0: srgb
    1: linear
  zstd_block_kind:
    0: raw
    1: repeated
    2: compressed
