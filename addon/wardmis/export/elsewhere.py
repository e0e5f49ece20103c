# SPDX-License-Identifier: GPL-3.0-or-later
"""Pixels that an image's user would show and that Blender does not hold for it: those of a movie's frame, of a file of a sequence, of a tile.

Python sees the pixels of the frame that was looked at last. Here a copy of the image is looked at, in data of its own: what the user has
open does not change.
"""

from __future__ import annotations

import time
from typing import Any

import bpy
import numpy as np

from .blender_pixels import blender_pixels

PATIENCE = 5.0  # seconds


def pixels_elsewhere(image: Any, path: str, frame: int | None = None) -> np.ndarray | None:
    """As blender_pixels() of `image` if it were loaded from the file `path`; `frame` of that, where it is a movie. None: it cannot be read."""
    with bpy.data.temp_data() as data:
        try:
            copy = data.images.load(path)
        except RuntimeError:
            return None
        assign(copy, source="FILE" if frame is None else "MOVIE")
        if image.colorspace_settings.name:  # empty where Blender could not read the image
            assign(copy.colorspace_settings, name=image.colorspace_settings.name)
        assign(copy, alpha_mode=image.alpha_mode)
        if frame is not None:
            assign(copy, use_deinterlace=image.use_deinterlace)
            _look(copy, frame, data)
        return None if 0 in copy.size else blender_pixels(copy)


def _look(image: Any, frame: int, data: Any) -> None:
    """A texture does so at the frame of its own."""
    texture = data.textures.new("", "IMAGE")
    assign(texture, image=image)
    assign(texture.image_user, frame_current=frame)
    texture.evaluate((0.0, 0.0, 0.0))


def assign(owner: Any, **settings: Any) -> None:
    """With patience: while its main thread draws the interface, which takes milliseconds, Blender refuses whoever assigns."""
    end = time.monotonic() + PATIENCE
    for name, value in settings.items():
        while True:
            try:
                setattr(owner, name, value)
                break
            except AttributeError:
                if time.monotonic() > end:
                    raise
                time.sleep(0.002)
