# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's preferences: which renderer, and whether it answers."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bpy
from bpy.props import StringProperty

from .layout import draw_text
from .process import RendererError, find_renderer, version


def renderer_path() -> Path:
    """The renderer to use. Raises RendererError, naming the places, if there is none."""
    addon = bpy.context.preferences.addons.get(__package__)
    chosen = addon.preferences.renderer if addon is not None else ""
    return find_renderer(bpy.path.abspath(chosen))


class WARDMIS_OT_test_renderer(bpy.types.Operator):
    bl_idname = "wardmis.test_renderer"
    bl_label = "Test"
    bl_description = "Start the renderer and show its version, to see whether it works here"

    def execute(self, _context: Any) -> set[str]:
        try:
            path = renderer_path()
            self.report({"INFO"}, f"{version(path)} at {path}")
        except RendererError as error:
            self.report({"ERROR"}, f"WardMIS: {error}")
            return {"CANCELLED"}
        return {"FINISHED"}


class WARDMIS_AP_preferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    renderer: StringProperty(
        name="Renderer",
        description="The program 'wardmis'. Empty: the one in the add-on, else the one that the environment variable "
        "WARDMIS_BINARY names, else the one on the PATH",
        subtype="FILE_PATH",
    )

    def draw(self, _context: Any) -> None:
        row = self.layout.row(align=True)
        row.prop(self, "renderer")
        row.operator(WARDMIS_OT_test_renderer.bl_idname)
        try:
            self.layout.label(text=f"In use: {renderer_path()}", icon="CHECKMARK")
        except RendererError as error:
            draw_text(self.layout, str(error), "ERROR")
        row = self.layout.row()
        row.operator("wardmis.documentation", icon="HELP")
        row.operator("wardmis.report_problem", icon="URL")


_CLASSES = (WARDMIS_OT_test_renderer, WARDMIS_AP_preferences)

register, unregister = bpy.utils.register_classes_factory(_CLASSES)
