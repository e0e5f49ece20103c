# SPDX-License-Identifier: GPL-3.0-or-later
"""The warnings of the last render, in the render properties and in the Image Editor's sidebar; a click selects what one is about."""

from __future__ import annotations

import re
from typing import Any

import bpy
from bpy.props import StringProperty

from . import rendering, warnings
from .layout import draw_text
from .panels import RenderPanel

MOST_OWNERS = 20  # that are shown; what concerns them all is said by the first


class WARDMIS_OT_show_owner(bpy.types.Operator):
    bl_idname = "wardmis.show_owner"
    bl_label = "Show"
    bl_options = {"REGISTER", "UNDO", "INTERNAL"}

    name: StringProperty(options={"SKIP_SAVE"})
    material: StringProperty(options={"SKIP_SAVE"})

    @classmethod
    def description(cls, _context: Any, properties: Any) -> str:
        if not properties.name:
            return "Show the world's settings"
        return f"Select the object '{properties.name}', and its material in question if there is one"

    def execute(self, context: Any) -> set[str]:
        if not self.name:
            return _show_tab(context, "WORLD")
        obj = context.view_layer.objects.get(self.name)
        if obj is None:
            elsewhere = self.name in bpy.data.objects
            where = "in another view layer or an instanced collection" if elsewhere else "no longer there"
            self.report({"WARNING"}, f"WardMIS: the object '{self.name}' is {where}")
            return {"CANCELLED"}
        if context.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")
        for other in context.view_layer.objects:
            other.select_set(False)
        context.view_layer.objects.active = obj
        slot = obj.material_slots.find(self.material) if self.material else -1
        if slot >= 0:
            obj.active_material_index = slot
        if not obj.visible_get():
            self.report({"INFO"}, f"WardMIS: '{self.name}' is hidden in the viewport; it is the active object now")
            return {"FINISHED"}
        obj.select_set(True)
        return {"FINISHED"}


def _show_tab(context: Any, tab: str) -> set[str]:
    for area in context.screen.areas:
        if area.type == "PROPERTIES":
            try:
                area.spaces.active.context = tab
            except TypeError:  # it is pinned to something that has no such tab
                continue
    return {"FINISHED"}


class WARDMIS_OT_copy_warnings(bpy.types.Operator):
    bl_idname = "wardmis.copy_warnings"
    bl_label = "Copy All"
    bl_description = "Put the text of all warnings into the clipboard, a line each"
    bl_options = {"INTERNAL"}

    def execute(self, context: Any) -> set[str]:
        context.window_manager.clipboard = "\n".join(w.full for w in warnings.of_scene(context.scene))
        return {"FINISHED"}


def draw_warnings(layout: Any, scene: Any) -> None:
    groups = warnings.by_owner(warnings.of_scene(scene))
    for owner, entries in list(groups.items())[:MOST_OWNERS]:
        column = layout.box().column(align=True)
        _draw_owner(column, owner, entries[0].text)
        for entry in entries:
            draw_text(column, entry.short)
    if len(groups) > MOST_OWNERS:
        draw_text(layout, f"and those of {len(groups) - MOST_OWNERS} more objects, which Copy All has", "INFO")
    layout.operator(WARDMIS_OT_copy_warnings.bl_idname, icon="COPYDOWN")


def _draw_owner(layout: Any, owner: str, text: str) -> None:
    row = layout.row()
    row.alignment = "LEFT"
    obj = bpy.data.objects.get(owner) if owner else None
    if obj is not None:
        button = row.operator(WARDMIS_OT_show_owner.bl_idname, text=owner, icon_value=layout.icon(obj))
        button.name = owner
        material = re.search(r"material '(.+?)' (?:on|of) object ", text)
        button.material = material[1] if material else ""
    elif text.startswith("world "):
        row.operator(WARDMIS_OT_show_owner.bl_idname, text="World", icon="WORLD").name = ""
    else:
        row.label(text=owner or "Scene", icon="SCENE_DATA")


class _Warnings:
    bl_label = "Warnings"
    layout: Any

    @classmethod
    def poll(cls, context: Any) -> bool:
        return context.scene.render.engine == rendering.ENGINE and bool(warnings.of_scene(context.scene))

    def draw_header(self, context: Any) -> None:
        self.layout.label(text=str(len(warnings.of_scene(context.scene))), icon="ERROR")

    def draw(self, context: Any) -> None:
        draw_warnings(self.layout, context.scene)


class WARDMIS_RENDER_PT_warnings(_Warnings, RenderPanel, bpy.types.Panel):
    pass


class WARDMIS_IMAGE_PT_warnings(_Warnings, bpy.types.Panel):
    bl_space_type = "IMAGE_EDITOR"
    bl_region_type = "UI"
    bl_category = "WardMIS"


_CLASSES = (
    WARDMIS_OT_show_owner,
    WARDMIS_OT_copy_warnings,
    WARDMIS_RENDER_PT_warnings,
    WARDMIS_IMAGE_PT_warnings,
)

register, unregister = bpy.utils.register_classes_factory(_CLASSES)
