# SPDX-License-Identifier: GPL-3.0-or-later
"""What panels need and Blender's layouts have not: text over several lines, whether there is little room, and being drawn again."""

from __future__ import annotations

from typing import Any

import bpy

TEXT_WIDTH = 7  # pixels of a letter, about, at a scale of the interface of 1
ICON_LETTERS = 4  # whose place an icon takes
NARROW = 320  # pixels, at such a scale: a sidebar as it opens; names beside their fields, and two columns, are cut off in less
WITH_PANELS = {"PROPERTIES", "IMAGE_EDITOR"}


def is_narrow() -> bool:
    region = bpy.context.region
    return bool(region) and region.width < NARROW * bpy.context.preferences.system.ui_scale


def redraw_status_bars() -> None:
    for window in bpy.context.window_manager.windows:
        with bpy.context.temp_override(window=window):
            window.workspace.status_text_set(None)  # which draws it anew: it is in no area that Python sees


def redraw() -> None:
    """The areas that have panels of ours, in all windows, soon."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type in WITH_PANELS:
                area.tag_redraw()


def draw_text(layout: Any, text: str, icon: str = "NONE") -> None:
    """Over as many lines as it needs: labels are cut off."""
    region, scale = bpy.context.region, bpy.context.preferences.system.ui_scale
    letters = max(20, int(region.width / (TEXT_WIDTH * scale)) - 6) if region else 60
    if icon != "NONE":
        letters -= ICON_LETTERS
    lines = [""]
    for word in text.split():
        if lines[-1] and len(lines[-1]) + 1 + len(word) > letters:
            lines.append("")
        lines[-1] += f" {word}" if lines[-1] else word
    column = layout.column(align=True)
    for i, line in enumerate(lines):
        column.label(text=line, icon=icon if i == 0 or icon == "NONE" else "BLANK1")
