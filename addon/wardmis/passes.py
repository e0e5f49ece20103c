# SPDX-License-Identifier: GPL-3.0-or-later
"""The passes of a render, as docs/command.md names them: one table for the panel, the compositor, the command and the file.

A pass is made where the view layer asks for it. Those that Cycles has, too, are asked for by Blender's own settings, the others by
`view_layer.wardmis`. Blender complains of a registered pass that a file lacks, so that a preview has all of them, too. There are as
many allocation passes as the scene has techniques, which the renderer knows: until it has told them, there are three.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import bpy
from bpy.props import BoolProperty, PointerProperty

from . import compat


class Pass(NamedTuple):
    name: str
    channels: str
    kind: str
    group: str  # what `--passes` calls it


COMPONENTS, PARTS = ("diffuse", "glossy", "transmission"), ("direct", "indirect", "color")

PASSES = (
    Pass("Combined", "RGBA", "COLOR", "combined"),
    Pass("Depth", "Z", "VALUE", "depth"),
    Pass("Normal", "XYZ", "VECTOR", "normal"),
    Pass("Albedo", "RGB", "COLOR", "albedo"),
    Pass("Variance", "RGB", "COLOR", "variance"),
    Pass("Samples", "X", "VALUE", "samples"),
    *(
        Pass(compat.PASS_NAMES[group], channels, kind, group)
        for group, channels, kind in (
            ("position", "XYZ", "VECTOR"),
            ("uv", "UVA", "VECTOR"),
            ("object-index", "X", "VALUE"),
            ("material-index", "X", "VALUE"),
            ("emission", "RGB", "COLOR"),
            ("environment", "RGB", "COLOR"),
            *((f"{component}-{part}", "RGB", "COLOR") for component in COMPONENTS for part in PARTS),
        )
    ),
)
ALLOCATION = "Allocation"
TECHNIQUES = ("Allocation Lobe", "Allocation Cosine", "Allocation Light")
# Blender's own that this engine has, and those that are no pass of a render engine or change none
BLENDERS = {
    "use_pass_z": "depth",
    "use_pass_normal": "normal",
    "use_pass_position": "position",
    "use_pass_uv": "uv",
    "use_pass_object_index": "object-index",
    "use_pass_material_index": "material-index",
    "use_pass_emit": "emission",
    "use_pass_environment": "environment",
    **{f"use_pass_{c}_{part}": f"{c}-{part}" for c in COMPONENTS for part in PARTS},
}
OTHERS = {"use_pass_combined", "use_pass_cryptomatte_accurate", "use_pass_grease_pencil"}


def _changed(self: Any, _context: Any) -> None:
    """The compositor's sockets follow."""
    for layer in self.id_data.view_layers:
        layer.update_render_passes()


class WARDMIS_PG_view_layer(bpy.types.PropertyGroup):
    use_pass_albedo: BoolProperty(
        name="Albedo",
        description="Deliver the colour of the surfaces without light, diffuse and glossy together, as denoisers want it",
        default=False,
        update=_changed,
    )
    use_pass_variance: BoolProperty(
        name="Variance",
        description="Deliver how noisy each pixel still is: the variance of its value, for each colour; "
        "its square root is the error to expect",
        default=False,
        update=_changed,
    )
    use_pass_allocation: BoolProperty(
        name="Allocation",
        description="Deliver how the samples were shared at each pixel: one pass for each technique (the lobes of the "
        "surfaces, cosine and light), with its share from 0 to 1",
        default=False,
        update=_changed,
    )
    use_pass_samples: BoolProperty(
        name="Count",
        description="Deliver how many samples each pixel has",
        default=False,
        update=_changed,
    )


# The allocation passes of a scene's view layer as the renderer told them last, both by name.
_told: dict[tuple[str, str], tuple[str, ...]] = {}


def tell(scene: Any, layer: Any, names: list[str]) -> None:
    """The passes that a render of the layer has: the compositor's sockets follow as soon as Blender lets them."""
    place, techniques = (scene.name, layer.name), tuple(n for n in names if n.startswith(ALLOCATION))
    if techniques and techniques != _told.get(place, TECHNIQUES):
        _told[place] = techniques
        if not bpy.app.background:
            bpy.app.timers.register(lambda: _update(*place))


def _update(scene: str, layer: str) -> None:
    layers = getattr(bpy.data.scenes.get(scene), "view_layers", {})
    if layer in layers:
        layers[layer].update_render_passes()


def passes_of(scene: Any, layer: Any) -> list[Pass]:
    """All that there are of the layer, whether it asks for them or not."""
    techniques = _told.get((scene.name, layer.name), TECHNIQUES)
    return [*PASSES, *(Pass(name, "X", "VALUE", "allocation") for name in techniques)]


def wanted(layer: Any) -> list[str]:
    """What `layer` asks for, as `--passes` calls it, in the order of the passes."""
    asked = {"combined", *(group for flag, group in BLENDERS.items() if getattr(layer, flag))}
    asked |= {flag.removeprefix("use_pass_") for flag in _own_flags() if getattr(layer.wardmis, flag)}
    return [group for group in (*(p.group for p in PASSES), "allocation") if group in asked]


def passes_option(layer: Any) -> str:
    """What `--passes` is given: with the names that this Blender has for its own."""
    names = compat.PASS_NAMES
    return ",".join(f"{group}={names[group]}" if group in names else group for group in wanted(layer))


def not_available(layer: Any) -> Iterator[str]:
    """The passes that `layer` asks another engine for and that this one does not have, as Blender calls them."""
    for flag in layer.bl_rna.properties:
        name = flag.identifier
        if name.startswith("use_pass_") and name not in {*BLENDERS, *OTHERS} and getattr(layer, name):
            yield flag.name
    yield from _of_cycles(layer)
    yield from (f"of shader outputs, '{output.name}' (AOV)" for output in layer.aovs if output.name)
    yield from (f"of the light group '{group.name}'" for group in layer.lightgroups)


def _of_cycles(layer: Any) -> Iterator[str]:
    """Passes that only Cycles' own settings ask for."""
    settings = getattr(layer, "cycles", None)  # its add-on may be off
    for flag in settings.bl_rna.properties if settings else ():
        if (
            "pass" in flag.identifier
            and flag.type == "BOOLEAN"
            and not flag.default
            and getattr(settings, flag.identifier)
        ):
            yield {"denoising_store_passes": "Denoising Data"}.get(flag.identifier, flag.name)


def register_passes(engine: Any, scene: Any, layer: Any) -> None:
    groups = wanted(layer)
    for p in passes_of(scene, layer):
        if p.group in groups:
            engine.register_pass(scene, layer, p.name, len(p.channels), p.channels, p.kind)


def _own_flags() -> list[str]:
    return [p.identifier for p in WARDMIS_PG_view_layer.bl_rna.properties if p.identifier.startswith("use_pass_")]


def register() -> None:
    bpy.utils.register_class(WARDMIS_PG_view_layer)
    bpy.types.ViewLayer.wardmis = PointerProperty(type=WARDMIS_PG_view_layer)


def unregister() -> None:
    del bpy.types.ViewLayer.wardmis
    bpy.utils.unregister_class(WARDMIS_PG_view_layer)
