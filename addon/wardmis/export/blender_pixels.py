# SPDX-License-Identifier: GPL-3.0-or-later
"""The pixels that Blender holds of an image, and those of its file, which are not the same.

On loading, Blender divides bytes that are said to be multiplied by alpha, and cuts them off at 255; it multiplies straight floats; and
it makes floats linear.
"""

from __future__ import annotations

from typing import Any

import numpy as np

DATA = {"Non-Color", "Raw"}  # colour spaces of no colours: alpha means nothing to them


def alpha_affects_colors(image: Any) -> bool:
    return image.alpha_mode in {"STRAIGHT", "PREMUL"} and image.colorspace_settings.name not in DATA


def blender_pixels(image: Any) -> np.ndarray:
    """(height, width, channels) uint8, or linear float32 where the image is one."""
    width, height = image.size
    pixels = np.empty(width * height * image.channels, np.float32)
    image.pixels.foreach_get(pixels)
    pixels = pixels.reshape(height, width, image.channels)
    if image.is_float:
        return pixels
    np.multiply(pixels, np.float32(255), out=pixels)
    return np.rint(pixels, out=pixels).astype(np.uint8)


def as_in_the_file(image: Any, pixels: np.ndarray, encoded: bool) -> np.ndarray:
    """`pixels`: Blender's. `encoded`: the file has floats in sRGB.

    Divided bytes all come back of a file whose colours are multiplied, see is_cut_off(); straight floats have lost theirs where alpha
    is 0.
    """
    premultiplied = image.alpha_mode == "PREMUL"
    has_alpha = pixels.shape[-1] == 4 and alpha_affects_colors(image)
    if pixels.dtype == np.uint8:
        if has_alpha and premultiplied:
            pixels[..., :3] = (pixels[..., :3].astype(np.uint16) * pixels[..., 3:] + 127) // 255
        return pixels
    alpha = np.where(pixels[..., 3:] == 0, 1, pixels[..., 3:]) if has_alpha else np.float32(1)
    colors = pixels[..., :3] / alpha
    if encoded:
        colors = encode_srgb(colors)
    if premultiplied:
        colors *= alpha
    return np.concatenate([colors, pixels[..., 3:]], axis=-1).astype(np.float32)


def is_cut_off(image: Any, pixels: np.ndarray) -> bool:
    """Whether Blender may have lost bytes that are said to be multiplied by alpha and are not.

    It shows where alpha is 0 and the colour is not, and where the divided colour is as large as it can be: so is one that was cut off.
    White that is multiplied is, too: the two cannot be told apart.
    """
    if (
        image.alpha_mode != "PREMUL"
        or not alpha_affects_colors(image)
        or pixels.dtype != np.uint8
        or pixels.shape[-1] < 4
    ):
        return False
    most, alpha = pixels[..., :3].max(axis=-1), pixels[..., 3]
    return bool(((alpha == 0) & (most > 0) | (alpha > 0) & (alpha < 255) & (most == 255)).any())


def encode_srgb(v: np.ndarray) -> np.ndarray:
    curve = 1.055 * np.maximum(v, 0.0) ** (1 / 2.4) - 0.055
    return np.where(v <= 0.0031308, v * 12.92, curve).astype(np.float32)


def decode_srgb(v: np.ndarray) -> np.ndarray:
    curve = ((np.maximum(v, 0.0) + 0.055) / 1.055) ** 2.4
    return np.where(v <= 0.04045, v / 12.92, curve).astype(np.float32)
