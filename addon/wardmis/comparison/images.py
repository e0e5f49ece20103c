# SPDX-License-Identifier: GPL-3.0-or-later
"""A comparison's images as image data-blocks, for the Image Editor.

They are no part of the user's file: each is kept in a file of its own, which ends with Blender, since Blender asks about images that
are in none; and they are taken away while the user's file is saved, since Blender would save or pack them with it.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from .. import compat, temporary
from ..exr import read_pass
from .colours import false_colour, fitting_top, relative_difference
from .image_files import write_exr, write_png
from .report import Report

A, B, DIFFERENCE, PLOT = "WardMIS A", "WardMIS B", "WardMIS difference", "WardMIS plot"
NAMES = {"A": A, "B": B, "DIFFERENCE": DIFFERENCE, "PLOT": PLOT}


def load(report: Report, a: str, b: str, top: float | None) -> float:
    """Makes, or makes anew, the images of configurations `a` and `b` and of their difference.

    `top` is the difference that has the brightest colour; None: such a one that the differences are seen. Returns it.
    RuntimeError if a file cannot be read.
    """
    try:
        first, second = read_pass(report.image(a)), read_pass(report.image(b))
    except OSError as error:
        raise RuntimeError(f"WardMIS: {error}; compare again") from error
    put(A, first, f"WardMIS A: {a}")
    put(B, second, f"WardMIS B: {b}")
    difference = relative_difference(first, second)
    if top is None:
        top = fitting_top(difference)
    put(DIFFERENCE, false_colour(difference, top), f"{a} against {b}", srgb=True)
    return top


def put(name: str, pixels: np.ndarray, description: str, srgb: bool = False) -> Any:
    """`pixels`, rows from the top, as the image data-block `name`: scene-linear light, or colours to be shown as they are."""
    file = f"{name}.{'png' if srgb else 'exr'}"
    try:
        path = temporary.kept("results") / file
        (write_png if srgb else write_exr)(path, pixels[..., :3])
    except OSError as error:
        raise RuntimeError(
            f"WardMIS: {file} cannot be written in {bpy.app.tempdir}: {error.strerror or error}; make room"
        ) from error
    return _show(name, path, description)


def _show(name: str, path: Path, description: str) -> Any:
    old = bpy.data.images.get(name)
    if old is not None and old.filepath_raw == str(path):
        image = old
        image.reload()
    else:
        image = bpy.data.images.load(str(path))
        if old is not None:
            old.user_remap(image)  # the editors that show it go on to
            bpy.data.images.remove(old)
        image.name = name
    srgb = path.suffix == ".png"
    image.colorspace_settings.name = "sRGB" if srgb else compat.LINEAR_SPACE
    image.use_view_as_render = not srgb
    image["wardmis"] = description
    return image


def ours(image: Any) -> bool:
    return image.name in NAMES.values()


def forget() -> None:
    """Removes them all."""
    bpy.data.batch_remove([image for image in bpy.data.images if ours(image)])


@dataclass
class _Away:
    """An image while it is not there, and the spaces that showed it."""

    name: str
    path: Path
    description: str
    spaces: list[Any]


_away: list[_Away] = []


def _is_used(image: Any, users: dict[Any, set[Any]]) -> bool:
    """By more than editors: then the user has made it a part of the file."""
    return any(not isinstance(user, bpy.types.Screen) for user in users.get(image, ()))


@bpy.app.handlers.persistent
def _before_saving(*_: Any) -> None:
    mine = [image for image in bpy.data.images if ours(image)]
    users = bpy.data.user_map(subset=mine) if mine else {}
    for image in mine:
        if _is_used(image, users):
            continue
        spaces = [space for space in image_editors() if space.image == image]
        _away.append(_Away(image.name, Path(image.filepath_raw), image.get("wardmis", ""), spaces))
        bpy.data.images.remove(image)


@bpy.app.handlers.persistent
def _after_saving(*_: Any) -> None:
    while _away:
        old = _away.pop()
        if not old.path.is_file():  # Show makes it anew
            continue
        image = _show(old.name, old.path, old.description)
        for space in old.spaces:
            space.image = image


def image_editors() -> list[Any]:
    """Their spaces, in all windows."""
    windows = bpy.context.window_manager.windows
    areas = [area for window in windows for area in window.screen.areas]
    return [area.spaces.active for area in areas if area.type == "IMAGE_EDITOR"]


def _handlers() -> list[tuple[Any, Any]]:
    names = [("save_pre", _before_saving), ("save_post", _after_saving), ("save_post_fail", _after_saving)]
    return [(getattr(bpy.app.handlers, name), f) for name, f in names if hasattr(bpy.app.handlers, name)]


def register() -> None:
    for handlers, function in _handlers():
        handlers.append(function)


def unregister() -> None:
    forget()
    for handlers, function in _handlers():
        handlers.remove(function)
