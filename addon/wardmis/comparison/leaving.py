# SPDX-License-Identifier: GPL-3.0-or-later
"""Says, wherever another file can be opened, that this ends a comparison that runs. Blender lets nobody ask at that moment.

A recent file, one that is dropped on the window and the window's close button pass by all menus of Python: for them it stands in the
status bar as well. What is done is kept in any case (job.py).
"""

from __future__ import annotations

from typing import Any

import bpy

from ..layout import draw_text
from . import job

TEXT = "A comparison is running: another file, or quitting, ends it; what is done is kept"
MENUS = ("TOPBAR_MT_file", "TOPBAR_MT_file_new")  # that of the recent files is not of Python
OPERATOR = "WM_OT_open_mainfile"


def _draw(self: Any, _context: Any) -> None:
    if job.running():
        self.layout.label(text=TEXT, icon="ERROR")
        self.layout.separator()


def _draw_status(self: Any, _context: Any) -> None:
    if job.running():
        self.layout.label(text=TEXT, icon="ERROR")


class WARDMIS_FILEBROWSER_PT_leaving(bpy.types.Panel):
    bl_label = "Comparison"
    bl_space_type = "FILE_BROWSER"
    bl_region_type = "TOOL_PROPS"
    bl_options = {"HIDE_HEADER"}
    layout: Any

    @classmethod
    def poll(cls, context: Any) -> bool:
        operator = context.space_data.active_operator
        return operator is not None and operator.bl_idname == OPERATOR and job.running()

    def draw(self, _context: Any) -> None:
        draw_text(self.layout, TEXT, "ERROR")


def register() -> None:
    bpy.utils.register_class(WARDMIS_FILEBROWSER_PT_leaving)
    for name in MENUS:
        getattr(bpy.types, name).prepend(_draw)
    bpy.types.STATUSBAR_HT_header.append(_draw_status)


def unregister() -> None:
    bpy.types.STATUSBAR_HT_header.remove(_draw_status)
    for name in MENUS:
        getattr(bpy.types, name).remove(_draw)
    bpy.utils.unregister_class(WARDMIS_FILEBROWSER_PT_leaving)
