"""BC1 with the palette arithmetic of §7.3."""

import numpy as np


def decode(blocks: bytes, width: int, height: int) -> np.ndarray:
    """The texels [y, x, channel] of a picture of `width` × `height` blocks, RGB, 8 bits a channel."""
    data = np.frombuffer(blocks, [("color", "<u2", 2), ("indices", "<u4")]).reshape(height, width)
    c0, c1 = np.moveaxis(widened(data["color"]), -2, 0)
    thirds = (data["color"][..., 0] > data["color"][..., 1])[..., None]
    two = np.where(thirds, (2 * c0 + c1) // 3, (c0 + c1) // 2)
    three = np.where(thirds, (c0 + 2 * c1) // 3, 0)
    palette = np.stack([c0, c1, two, three], axis=-2)
    index = data["indices"][..., None] >> np.arange(0, 32, 2, dtype=np.uint32) & 3
    rgb = np.take_along_axis(palette, index[..., None].astype(np.intp), axis=-2)
    return rgb.astype(np.uint8).reshape(height, width, 4, 4, 3).swapaxes(1, 2).reshape(4 * height, 4 * width, 3)


def widened(color: np.ndarray) -> np.ndarray:
    """565 colours as three channels of 8 bits."""
    levels = (color >> 11, 5), (color >> 5 & 63, 6), (color & 31, 5)
    return np.stack([(level << 8 - bits) + (level >> 2 * bits - 8) for level, bits in levels], axis=-1).astype(np.int32)
