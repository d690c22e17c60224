"""zstd frames as `.lfslab` files hold them (§7.5)."""

import zstandard

MAGIC = bytes.fromhex("28B52FFD")
WINDOW = 8 << 20


def unpack(frame: bytes, lengths: range) -> bytes:
    """The content of `frame`; its header must state a length in `lengths`, which is checked before memory is allocated."""
    if not frame.startswith(MAGIC):
        raise ValueError("§7.5: not a zstd frame")
    try:
        header = zstandard.get_frame_parameters(frame)
        if header.content_size not in lengths:
            raise ValueError("§7.5: the zstd frame states no content size, or a wrong one")
        if header.dict_id != 0 or header.window_size > WINDOW:
            raise ValueError("§7.5: the zstd frame needs a dictionary or a window of more than 8 MiB")
        return zstandard.ZstdDecompressor().decompress(frame, allow_extra_data=False)
    except zstandard.ZstdError as error:
        raise ValueError(f"§7.5: {error}") from error
