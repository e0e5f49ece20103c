# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's materials -> Ward's model. What has no counterpart is named in a note and shown in magenta, never in black.

What is black in Cycles is so here, and named if it is for want of nodes.
"""

from __future__ import annotations

from typing import Any

from .. import compat
from .context import ExportContext
from .model import MaterialData, not_finite
from .shader import FALLBACK, Surface, shader
from .tree import Owner, output_use
from .value import Calculator, NotFinite, Value, constant


def export_material(material: Any, context: ExportContext) -> MaterialData:
    owner = Owner("material", f"material '{material.name}' on object '{context.owner}'", context)
    try:
        surface = _surface_of(material, owner) if compat.uses_nodes(material) else _plain(material)
        data = _translate(material, owner, surface)
        wrong = not_finite(data)  # what the nodes make of finite numbers may still be none
        if wrong is None:
            return data
        context.note(f"{owner.place}: its {wrong} is not a finite number; rendered as magenta")
    except NotFinite:
        pass  # noted where it was found
    except RecursionError:  # Blender lets users link nodes in a circle
        context.note(f"{owner.place} has nodes that are linked in a circle; rendered as black, as in Cycles")
        return _translate(material, owner, Surface())
    return _translate(material, owner, FALLBACK)


def _translate(material: Any, owner: Owner, surface: Surface) -> MaterialData:
    calc = Calculator(owner)
    return MaterialData(
        material.name,
        surface.variant,
        calc.color_input(surface.diffuse),
        calc.color_input(surface.specular),
        calc.scalar_input(surface.alpha_x),
        calc.scalar_input(surface.alpha_y),
        surface.rotation,
        calc.light_input(surface.emission),
    )


def _plain(material: Any) -> Surface:
    """Without nodes: the colours of the viewport. Cycles shows them as diffuse; so does this unless they are metallic."""
    color, metallic = constant(material.diffuse_color), material.metallic
    alpha = constant(material.roughness**2)
    return Surface(Value(color.factor * (1.0 - metallic)), Value(color.factor * metallic), alpha, alpha)


def _surface_of(material: Any, owner: Owner) -> Surface:
    tree = material.node_tree
    output = output_use(tree, "Surface", owner)
    if output is None:
        owner.context.note(f"{owner.place} has no output node that is not muted; rendered as black, as in Cycles")
        return Surface()
    for name in ("Volume", "Displacement"):
        part = output_use(tree, name, owner)
        if part is not None and part.is_linked(name):
            part.note(f"has a {name.lower()}, which is not supported; it is left out")
    if output.source("Surface").is_nothing:
        output.note("has no surface connected; rendered as black, as in Cycles")
        return Surface()
    return shader(output, "Surface")
