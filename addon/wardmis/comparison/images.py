# SPDX-License-Identifier: GPL-3.0-or-later
"""A comparison's images as image data-blocks, for the Image Editor."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np

from .. import compat
from .colours import false_colour, relative_difference
from .exr import read_pass
from .report import Report

A, B, DIFFERENCE, PLOT = "WardMIS A", "WardMIS B", "WardMIS difference", "WardMIS plot"
NAMES = {"A": A, "B": B, "DIFFERENCE": DIFFERENCE, "PLOT": PLOT}


def load(report: Report, a: str, b: str, top: float) -> None:
    """Makes, or makes anew, the images of configurations `a` and `b` and of their difference. RuntimeError if a file cannot be read."""
    try:
        first, second = read_pass(report.image(a)), read_pass(report.image(b))
    except OSError as error:
        raise RuntimeError(f"WardMIS: {error}; compare again") from error
    put(A, first, f"WardMIS A: {a}")
    put(B, second, f"WardMIS B: {b}")
    put(DIFFERENCE, false_colour(relative_difference(first, second), top), f"{a} against {b}", srgb=True)


def put(name: str, pixels: np.ndarray, description: str, srgb: bool = False) -> Any:
    """`pixels`, rows from the top, as the image data-block `name`: scene-linear light, or colours to be shown as they are."""
    height, width, channels = pixels.shape
    image = old = bpy.data.images.get(name)
    if old is None or tuple(old.size) != (width, height) or old.is_float == srgb:
        image = bpy.data.images.new(name, width, height, alpha=False, float_buffer=not srgb)
        if old is not None:
            old.user_remap(image)  # the editors that show it go on to
            bpy.data.images.remove(old)
            image.name = name
    image.colorspace_settings.name = "sRGB" if srgb else compat.LINEAR_SPACE
    image.use_view_as_render = not srgb
    rgba: np.ndarray = np.ones((height, width, 4), np.float32)
    rgba[..., : min(3, channels)] = pixels[::-1, :, :3]
    image.pixels.foreach_set(rgba.ravel())
    image.update()
    image["wardmis"] = description
    return image


def ours(image: Any) -> bool:
    return image.name in NAMES.values()
