# SPDX-License-Identifier: GPL-3.0-or-later
"""The panels of the Properties editor: those of the render and of the view layer, in Cycles' order, and which of Blender's go with them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy

from . import compat, film, light_paths
from .engine import WARDMIS_RenderEngine
from .layout import draw_text
from .passes import COMPONENTS, PARTS
from .sharing import uses_pilot, yields

ENGINE = WARDMIS_RenderEngine.bl_idname

# Blender's general panels that show settings without effect here, or that ours replace
EXCLUDED = {
    "DATA_PT_area",
    "DATA_PT_falloff_curve",
    "DATA_PT_light",
    "DATA_PT_preview",
    "DATA_PT_spot",
    "DATA_PT_volume_render",
    "NODE_DATA_PT_light",
    "NODE_DATA_PT_spot",
    "OBJECT_PT_shading",  # light and shadow linking
    "OBJECT_PT_visibility",  # holdouts
    "PHYSICS_PT_fluid_domain_render",
    "RENDER_PT_simplify",  # ours stands where Cycles' does
    "RENDER_PT_stereoscopy",
}
EXCLUDED_PREFIXES = (
    "PARTICLE_PT_render_path_",  # of trails
    "RENDER_PT_simplify_",
    "RENDER_PT_freestyle",
    "VIEWLAYER_PT_freestyle",
    "MATERIAL_PT_freestyle",
)
# Eevee's panels that edit what this engine reads, too
INCLUDED = {
    "DATA_PT_camera_dof",
    "DATA_PT_camera_dof_aperture",
    "EEVEE_MATERIAL_PT_context_material",
    "EEVEE_MATERIAL_PT_surface",
    "EEVEE_WORLD_PT_surface",
}


class Panel:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    COMPAT_ENGINES = {ENGINE}
    layout: Any

    @classmethod
    def poll(cls, context: Any) -> bool:
        return context.engine in cls.COMPAT_ENGINES

    def _column(self) -> Any:
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        return self.layout.column()


class RenderPanel(Panel):
    bl_context = "render"


def _row(column: Any, active: bool) -> Any:
    """A row that is grey where its setting does not matter."""
    row = column.row()
    row.active = active
    return row


class WARDMIS_RENDER_PT_sampling(RenderPanel, bpy.types.Panel):
    bl_label = "Sampling"

    def draw(self, context: Any) -> None:
        settings, column = context.scene.wardmis, self._column()
        column.row().prop(settings, "stop_by", expand=True)
        column.prop(settings, settings.stop_by)
        if settings.stop_by == "target_error":
            column.prop(settings, "max_samples")
        column.separator()
        column.prop(settings, "sampler")
        row = column.row(align=True)
        row.prop(settings, "seed")
        row.prop(settings, "use_animated_seed", text="", icon="TIME")


class WARDMIS_RENDER_PT_allocation(RenderPanel, bpy.types.Panel):
    bl_label = "Allocation"

    def draw(self, context: Any) -> None:
        settings, column = context.scene.wardmis, self._column()
        column.prop(settings, "allocation")
        column.prop(settings, "weights")
        if yields(settings):
            draw_text(column, "Samples are shared equally: Automatic is for Balance weights", "INFO")
        column.prop(settings, "integrand")
        column.prop(settings, "samples_per_hit")
        column.prop(settings, "pixels")
        column.separator()
        pilot = uses_pilot(settings)
        _row(column, pilot).prop(settings, "pilot_samples")
        _row(column, pilot).prop(settings, "min_fraction")


class WARDMIS_RENDER_PT_light_paths(RenderPanel, bpy.types.Panel):
    bl_label = "Light Paths"

    def draw(self, context: Any) -> None:
        settings, column = context.scene.wardmis, self._column()
        column.prop(settings, "integrator")
        follows = settings.integrator != "direct"
        if settings.integrator == "bidirectional":
            for number in ("light_paths", "connections", "later_connections", "light_tracing"):
                _row(column, not uses_pilot(settings)).prop(settings, number)
        _row(column, follows).prop(settings, "bounces")
        if settings.bounces == "own":
            for limit in ("max_depth", "max_diffuse", "max_glossy", "max_transmission", "max_transparent"):
                _row(column, follows).prop(settings, limit)
        limits, cycles = light_paths.in_force(context.scene), light_paths.of_cycles(context.scene)
        if follows and settings.bounces == "cycles":
            draw_text(column, f"Bounces of a path: {cycles}")
        elif follows and light_paths.ends_sooner(cycles, limits):
            draw_text(column, f"Cycles shows less light here, with bounces of {cycles}", icon="INFO")


class WARDMIS_RENDER_PT_curves(RenderPanel, bpy.types.Panel):
    """Cycles' own settings, which the export reads: they are gone where that add-on is off, and its defaults count."""

    bl_label = "Curves"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: Any) -> bool:
        return super().poll(context) and hasattr(context.scene, "cycles_curves")

    def draw(self, context: Any) -> None:
        settings, column = context.scene.cycles_curves, self._column()
        column.prop(settings, "shape")
        _row(column, settings.shape == "RIBBONS").prop(settings, "subdivisions", text="Curve Subdivisions")


# Cycles' own, of renders
SIMPLIFIED = {"texture_resolution_render": "Texture Resolution", "texture_limit_render": "Texture Limit"}


class WARDMIS_RENDER_PT_simplify(RenderPanel, bpy.types.Panel):
    bl_label = "Simplify"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context: Any) -> None:
        self.layout.prop(context.scene.render, "use_simplify", text="")

    def draw(self, context: Any) -> None:
        render, column = context.scene.render, self._column()
        column.active = render.use_simplify
        for heading, suffix in (("Viewport", ""), ("Render", "_render")):
            group = column.column(heading=heading)
            group.prop(render, f"simplify_subdivision{suffix}", text=f"{heading} Max Subdivision")
            group.prop(render, f"simplify_child_particles{suffix}", text="Child Particles")
        cycles = getattr(context.scene, "cycles", None)
        for name, text in SIMPLIFIED.items():
            if hasattr(cycles, name):
                group.prop(cycles, name, text=text)


class WARDMIS_RENDER_PT_motion_blur(RenderPanel, bpy.types.Panel):
    bl_label = "Motion Blur"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context: Any) -> None:
        self.layout.prop(context.scene.render, "use_motion_blur", text="")

    def draw(self, context: Any) -> None:
        scene, column = context.scene, self._column()
        column.active = scene.render.use_motion_blur
        owner = compat.motion_blur_owner(scene)
        if owner is not None:
            column.prop(owner, "motion_blur_position", text="Position")
        column.prop(scene.render, "motion_blur_shutter")
        cycles: Any = getattr(scene, "cycles", None)  # the settings that the export reads
        if hasattr(cycles, "rolling_shutter_type"):
            column.prop(cycles, "rolling_shutter_type", text="Rolling Shutter")
            _row(column, cycles.rolling_shutter_type != "NONE").prop(cycles, "rolling_shutter_duration")
        column.label(text="Shutter Curve:")
        self.layout.template_curve_mapping(scene.render, "motion_blur_shutter_curve")


class WARDMIS_RENDER_PT_film(RenderPanel, bpy.types.Panel):
    bl_label = "Film"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        settings, column = context.scene.wardmis, self._column()
        column.prop(settings, "film", text="Exposure and Filter")
        if settings.film == "own":
            column.prop(settings, "film_exposure")
            column.prop(settings, "filter_type")
            _row(column, settings.filter_type != "box").prop(settings, "filter_width")
            theirs = film.of_cycles(context.scene)
            if theirs != film.in_force(context.scene):
                draw_text(column, f"Cycles has {theirs} here", icon="INFO")
        elif hasattr(context.scene, "cycles"):
            cycles = context.scene.cycles
            column.prop(cycles, "film_exposure")
            column.prop(cycles, "pixel_filter_type", text="Filter")
            _row(column, cycles.pixel_filter_type != "BOX").prop(cycles, "filter_width", text="Width")
        column.prop(context.scene.render, "film_transparent", text="Transparent")


class WARDMIS_RENDER_PT_performance(RenderPanel, bpy.types.Panel):
    bl_label = "Performance"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        render, column = context.scene.render, self._column()
        column.prop(render, "threads_mode")
        _row(column, render.threads_mode == "FIXED").prop(render, "threads", text="Threads")


class WARDMIS_VIEWLAYER_PT_passes(Panel, bpy.types.Panel):
    bl_label = "Passes"
    bl_context = "view_layer"

    def draw(self, context: Any) -> None:
        layer, column = context.view_layer, self._column()
        data = column.column(heading="Data")
        data.prop(layer, "use_pass_z", text="Depth")
        data.prop(layer, "use_pass_normal", text="Normal")
        for name, text in (("position", "Position"), ("uv", "UV"), ("object_index", "Object Index")):
            data.prop(layer, f"use_pass_{name}", text=text)
        data.prop(layer, "use_pass_material_index", text="Material Index")
        data.prop(layer.wardmis, "use_pass_albedo")
        column.separator()
        for component in COMPONENTS:
            row = column.row(heading=component.title(), align=True)
            for part in PARTS:
                row.prop(layer, f"use_pass_{component}_{part}", text=part.title(), toggle=True)
        light = column.column(heading="Light")
        light.prop(layer, "use_pass_emit", text="Emission")
        light.prop(layer, "use_pass_environment", text="Environment")
        column.separator()
        noise = column.column(heading="Samples")
        noise.prop(layer.wardmis, "use_pass_variance")
        noise.prop(layer.wardmis, "use_pass_allocation")
        noise.prop(layer.wardmis, "use_pass_samples")


class WARDMIS_VIEWLAYER_PT_filter(Panel, bpy.types.Panel):
    bl_label = "Filter"
    bl_context = "view_layer"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        column = self._column().column(heading="Include")
        column.prop(context.view_layer, "use_sky", text="Environment")
        column.prop(context.view_layer, "use_solid", text="Surfaces")
        column.prop(context.view_layer, "use_strand", text="Hair")


class WARDMIS_VIEWLAYER_PT_override(Panel, bpy.types.Panel):
    bl_label = "Override"
    bl_context = "view_layer"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        column = self._column()
        column.prop(context.view_layer, "material_override")
        if hasattr(context.view_layer, "world_override"):  # came with a later version of Blender
            column.prop(context.view_layer, "world_override")


_CLASSES = (
    WARDMIS_RENDER_PT_sampling,
    WARDMIS_RENDER_PT_allocation,
    WARDMIS_RENDER_PT_light_paths,
    WARDMIS_RENDER_PT_curves,
    WARDMIS_RENDER_PT_simplify,
    WARDMIS_RENDER_PT_motion_blur,
    WARDMIS_RENDER_PT_film,
    WARDMIS_RENDER_PT_performance,
    WARDMIS_VIEWLAYER_PT_passes,
    WARDMIS_VIEWLAYER_PT_filter,
    WARDMIS_VIEWLAYER_PT_override,
)
_register_classes, _unregister_classes = bpy.utils.register_classes_factory(_CLASSES)


def _compatible_panels() -> Iterator[Any]:
    for panel in bpy.types.Panel.__subclasses__():
        engines, name = getattr(panel, "COMPAT_ENGINES", ()), panel.__name__
        general = "BLENDER_RENDER" in engines and name not in EXCLUDED and not name.startswith(EXCLUDED_PREFIXES)
        if general or name in INCLUDED:
            yield panel


def register() -> None:
    _register_classes()
    for panel in _compatible_panels():
        panel.COMPAT_ENGINES.add(ENGINE)


def unregister() -> None:
    for panel in _compatible_panels():
        panel.COMPAT_ENGINES.discard(ENGINE)
    _unregister_classes()
