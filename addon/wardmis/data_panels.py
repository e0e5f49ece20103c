# SPDX-License-Identifier: GPL-3.0-or-later
"""The panels of objects and lights: what Cycles calls a setting it is called here, and what has no effect is not shown."""

from __future__ import annotations

from typing import Any

import bpy

from . import compat
from .panels import Panel

SURFACES = {"MESH", "CURVE", "SURFACE", "FONT", "META", "CURVES", "POINTCLOUD"}


class WARDMIS_OBJECT_PT_shadow_terminator(Panel, bpy.types.Panel):
    bl_label = "Shadow Terminator"
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: Any) -> bool:
        return context.object is not None and context.object.type in SURFACES and super().poll(context)

    def draw(self, context: Any) -> None:
        owner, *offsets = compat.shadow_terminator(context.object)
        column = self._column()
        for name, text in zip(offsets, ("Geometry Offset", "Shading Offset")):
            if hasattr(owner, name):
                column.prop(owner, name, text=text)


class WARDMIS_OBJECT_PT_visibility(Panel, bpy.types.Panel):
    bl_label = "Visibility"
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: Any) -> bool:
        return context.object is not None and super().poll(context)

    def draw(self, context: Any) -> None:
        obj, column = context.object, self._column()
        column.prop(obj, "hide_select", text="Selectable", toggle=False, invert_checkbox=True)
        shown = column.column(heading="Show In")
        shown.prop(obj, "hide_viewport", text="Viewports", toggle=False, invert_checkbox=True)
        shown.prop(obj, "hide_render", text="Renders", toggle=False, invert_checkbox=True)
        if obj.type in SURFACES:
            mask = column.column(heading="Mask")
            mask.prop(obj, "is_shadow_catcher", text="Shadow Catcher")
            mask.prop(obj, "is_holdout", text="Holdout")
        elif obj.type == "LIGHT":
            column.column(heading="Mask").prop(obj, "is_shadow_catcher", text="Shadow Catcher")


class WARDMIS_OBJECT_PT_ray_visibility(Panel, bpy.types.Panel):
    bl_label = "Ray Visibility"
    bl_context = "object"
    bl_parent_id = "WARDMIS_OBJECT_PT_visibility"

    @classmethod
    def poll(cls, context: Any) -> bool:
        obj = context.object
        instances = obj is not None and obj.instance_type == "COLLECTION" and obj.instance_collection
        return obj is not None and bool(obj.type in SURFACES | {"LIGHT"} or instances) and super().poll(context)

    def draw(self, context: Any) -> None:
        obj, column = context.object, self._column()
        for kind in ("camera", "diffuse", "glossy", "transmission", "shadow"):
            if kind != "shadow" or obj.type != "LIGHT":
                column.prop(obj, f"visible_{kind}", text=kind.title())


class WARDMIS_OBJECT_PT_motion_blur(Panel, bpy.types.Panel):
    bl_label = "Motion Blur"
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: Any) -> bool:
        obj = context.object
        moves = (
            obj is not None and obj.type in SURFACES | {"CAMERA", "EMPTY"} and compat.motion_settings(obj) is not None
        )
        return moves and super().poll(context)

    def draw_header(self, context: Any) -> None:
        self.layout.prop(compat.motion_settings(context.object), "use_motion_blur", text="")

    def draw(self, context: Any) -> None:
        settings, column = compat.motion_settings(context.object), self._column()
        column.active = context.scene.render.use_motion_blur and settings.use_motion_blur
        column.prop(settings, "motion_steps", text="Steps")
        if context.object.type != "CAMERA":
            column.prop(settings, "use_deform_motion", text="Deformation")


class LightPanel(Panel):
    bl_context = "data"

    @classmethod
    def poll(cls, context: Any) -> bool:
        return context.light is not None and super().poll(context)


class WARDMIS_LIGHT_PT_light(LightPanel, bpy.types.Panel):
    bl_label = "Light"

    def draw(self, context: Any) -> None:
        light = context.light
        self.layout.row().prop(light, "type", expand=True)
        column = self._column()
        _draw_colour(column, light)
        column.separator()
        column.prop(light, "energy")
        for name in ("exposure", "normalize"):
            if hasattr(light, name):  # from 5.0
                column.prop(light, name)
        column.separator()
        _draw_shape(column, light)
        column.prop(*compat.light_shadow_setting(light), text="Cast Shadow")
        own = getattr(light, "cycles", None)  # the setting that the export reads
        if hasattr(own, "max_bounces"):
            column.prop(own, "max_bounces")


def _draw_colour(column: Any, light: Any) -> None:
    tinted = getattr(light, "use_temperature", False)
    if hasattr(light, "use_temperature"):  # from 4.5
        row = column.column(heading="Temperature").row(align=True)
        row.prop(light, "use_temperature", text="")
        value = row.row()
        value.active = tinted
        value.prop(light, "temperature", text="")
    column.prop(light, "color", text="Tint" if tinted else "Color")


def _draw_shape(column: Any, light: Any) -> None:
    if light.type in {"POINT", "SPOT"}:
        column.prop(light, "shadow_soft_size", text="Radius")
        if hasattr(light, "use_soft_falloff"):  # from 4.0
            column.prop(light, "use_soft_falloff")
    elif light.type == "SUN":
        column.prop(light, "angle")
    elif light.type == "AREA":
        column.prop(light, "shape", text="Shape")
        size = column.column(align=True)
        if light.shape in {"RECTANGLE", "ELLIPSE"}:
            size.prop(light, "size", text="Size X")
            size.prop(light, "size_y", text="Y")
        else:
            size.prop(light, "size")


class WARDMIS_LIGHT_PT_beam_shape(LightPanel, bpy.types.Panel):
    bl_label = "Beam Shape"
    bl_parent_id = "WARDMIS_LIGHT_PT_light"

    @classmethod
    def poll(cls, context: Any) -> bool:
        return super().poll(context) and context.light.type in {"SPOT", "AREA"}

    def draw(self, context: Any) -> None:
        light, column = context.light, self._column()
        if light.type == "SPOT":
            column.prop(light, "spot_size", text=compat.SPOT_SIZE)
            column.prop(light, "spot_blend", text="Blend", slider=True)
            column.prop(light, "show_cone")
        else:
            column.prop(light, "spread", text="Spread")


class WARDMIS_LIGHT_PT_nodes(LightPanel, bpy.types.Panel):
    bl_label = "Nodes"

    def draw(self, context: Any) -> None:
        light = context.light
        if compat.HAS_USE_NODES:
            self.layout.prop(light, "use_nodes", icon="NODETREE")
        if not compat.uses_nodes(light):
            return
        output = light.node_tree.get_output_node("CYCLES")
        if output is None:
            self.layout.label(text="No output node")
        else:
            self.layout.template_node_view(light.node_tree, output, output.inputs["Surface"])


_CLASSES = (
    WARDMIS_OBJECT_PT_shadow_terminator,
    WARDMIS_OBJECT_PT_visibility,
    WARDMIS_OBJECT_PT_ray_visibility,
    WARDMIS_OBJECT_PT_motion_blur,
    WARDMIS_LIGHT_PT_light,
    WARDMIS_LIGHT_PT_beam_shape,
    WARDMIS_LIGHT_PT_nodes,
)

register, unregister = bpy.utils.register_classes_factory(_CLASSES)
