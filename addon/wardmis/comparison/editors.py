# SPDX-License-Identifier: GPL-3.0-or-later
"""The Image Editors that show a comparison's images, each fitted into what its sidebars leave free."""

from __future__ import annotations

import math
from typing import Any

import bpy

from . import images

MARGIN = 0.98  # of the room

TOLERANCE = 1e-3

NEAR = 1.0  # pixels: what Blender says of a view is that near to what was asked for

View = tuple[float, tuple[float, float]]  # the zoom, and the pixel in the middle

_fitted: dict[int, float] = {}  # the zoom by area: where it is another one, the user has chosen it
_asked: dict[int, View] = {}


def show(image: Any) -> None:
    """In the editors that show one of ours, else in the one under the pointer, else in the first."""
    editors = [
        (window, area)
        for window in bpy.context.window_manager.windows
        for area in window.screen.areas
        if area.type == "IMAGE_EDITOR"
    ]
    showing = [(window, area) for window, area in editors if _shows_ours(area)]
    here = [(window, area) for window, area in editors if area == bpy.context.area]
    for window, area in showing or here or editors[:1]:
        if bpy.app.background:
            area.spaces.active.image = image
        else:
            _show_in(window, area, image)


def _shows_ours(area: Any) -> bool:
    image = area.spaces.active.image
    return image is not None and images.ours(image)


def _show_in(window: Any, area: Any, image: Any) -> None:
    space, key = area.spaces.active, area.as_pointer()
    chosen = _shows_ours(area) and abs(space.zoom[0] / _fitted.get(key, -1.0) - 1) > TOLERANCE
    zoom, centre = _asked[key] = _view(area) if chosen else _fitting_view(area, image)
    space.image = image
    # later Blenders keep a view for each image: the same part is to be seen of all
    room = _regions(area)["WINDOW"]
    offset = (centre[0] - image.size[0] / 2, centre[1] - image.size[1] / 2)
    with bpy.context.temp_override(window=window, area=area, region=room):
        bpy.ops.image.view_all(fit_view=True)  # in the middle
        bpy.ops.image.view_zoom_ratio(ratio=zoom)
        bpy.ops.image.view_pan(offset=offset)
    if not chosen:
        _fitted[key] = zoom  # the space's own is that of its last drawing


def _view(area: Any) -> View:
    """What is seen."""
    space, room = area.spaces.active, _regions(area)["WINDOW"]
    x, y = room.view2d.region_to_view(room.width / 2, room.height / 2)
    seen = space.zoom[0], (x * space.image.size[0], y * space.image.size[1])
    asked = _asked.get(area.as_pointer())
    if asked is None or abs(asked[0] / seen[0] - 1) > TOLERANCE or math.dist(asked[1], seen[1]) > NEAR:
        return seen
    return asked  # else the view would creep


def _fitting_view(area: Any, image: Any) -> View:
    """All of the image. Sidebars lie over it, so that the room is what is between them."""
    regions = _regions(area)
    room = regions["WINDOW"]
    overlap = bpy.context.preferences.system.use_region_overlap
    left, right = (
        regions[kind].width if overlap and kind in regions and regions[kind].width > 1 else 0
        for kind in ("TOOLS", "UI")
    )
    width, height = image.size[0] or 1, image.size[1] or 1
    zoom = MARGIN * min(max(room.width - left - right, 1) / width, room.height / height)
    return zoom, (width / 2 + (right - left) / 2 / zoom, height / 2)


def _regions(area: Any) -> dict[str, Any]:
    return {region.type: region for region in area.regions}
