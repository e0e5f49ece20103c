# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's world -> a constant radiance, or an equirectangular image times a factor."""

from __future__ import annotations

from typing import Any

import numpy as np

from .. import compat
from .context import ExportContext
from .model import WorldData, not_finite
from .shader import shader
from .tree import Owner, output_use
from .value import Calculator, NotFinite, Value


def export_world(world: Any, context: ExportContext) -> WorldData:
    if world is None:
        return WorldData()
    owner = Owner("world", f"world '{world.name}'", context)
    try:
        data = _translate(world, owner)
    except RecursionError:
        context.note(f"{owner.place} has nodes that are linked in a circle; it gives no light")
        return WorldData()
    except NotFinite:
        return WorldData()  # noted where it was found
    wrong = not_finite(data)
    if wrong is not None:
        context.note(f"{owner.place}: its {wrong} is not a finite number; it gives no light")
        return WorldData()
    if data.texture is not None and compat.max_bounces(world) < 1024:  # a constant sky has no limit in Cycles either
        context.note(f"{owner.place}: its Max Bounces are not supported; it lights all surfaces of a path")
    return data


def _translate(world: Any, owner: Owner) -> WorldData:
    if not compat.uses_nodes(world):
        return WorldData(tuple(world.color))
    _note_settings(world, owner)
    output = output_use(world.node_tree, "Surface", owner)
    if output is None or output.source("Surface").is_nothing:
        owner.context.note(f"{owner.place}: no node is connected to its output; it gives no light")
        return WorldData()
    return _radiance(shader(output, "Surface").emission, owner)


def _radiance(emission: Value, owner: Owner) -> WorldData:
    calc = Calculator(owner)
    color = calc.light_input(emission)
    if color.texture is None or emission.lookup is None:
        return WorldData(color.value)
    return WorldData(color.value, color.texture.index, np.array(emission.lookup.transform).reshape(3, 3))


def _note_settings(world: Any, owner: Owner) -> None:
    output = output_use(world.node_tree, "Volume", owner)
    if output is not None and output.is_linked("Volume"):
        owner.context.note(f"{owner.place}: volumes are not supported; the air is clear")
    visibility = getattr(world, "cycles_visibility", None)
    if visibility is not None and not (visibility.camera and visibility.diffuse and visibility.glossy):
        owner.context.note(f"{owner.place}: its ray visibility is not supported; all rays see it")
