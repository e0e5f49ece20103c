# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's materials -> a surface and its program. What has no counterpart is named in a note, and what is nearest to it shown.

What is black in Cycles is so here, and named if it is for want of nodes.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from .. import compat
from .context import ExportContext
from .image import MISSING
from .model import ClosureData, ColorInput, MaterialData, ScalarInput, not_finite
from .program.closures import WHITE, Closure, Shading
from .program.reader import Reader
from .program.surface import MOST_OPERATIONS, material_of
from .program.vectors import bend_by_displacement
from .socket_value import NotFinite
from .tree import NodeUse, Owner, output_use


@compat.deep_recursion()
def export_material(material: Any, context: ExportContext) -> MaterialData:
    owner = Owner("material", f"material '{material.name}' on object '{context.owner}'", context)
    name = material.name
    try:
        data = _surface_of(material, owner) if compat.uses_nodes(material) else _plain(material)
        data.index = material.pass_index
        data.transparent_shadow = compat.transparent_shadow(material)
        wrong = not_finite(data)  # what the nodes make of finite numbers may still be none
        if wrong is not None:
            context.note(f"{owner.place}: its {wrong} is not a finite number; rendered as magenta")
        elif data.program is not None and len(data.program.operations) > MOST_OPERATIONS:
            context.note(
                f"{owner.place}: its nodes make {len(data.program.operations)} operations, of which {MOST_OPERATIONS} are the most; "
                "rendered as grey and diffuse"
            )
            return MaterialData(name, diffuse=ColorInput((0.8, 0.8, 0.8)))
        else:
            return data
    except NotFinite:
        pass  # noted where it was found
    except RecursionError:
        context.note(f"{owner.place} has nodes that are linked in a circle, or in too long a chain; rendered as black")
        return MaterialData(name)
    return MaterialData(name, diffuse=ColorInput(MISSING))


def is_matte(data: MaterialData) -> bool:
    """Whether it is in the short form, and Lambert's alone."""
    return not data.closures and not any(data.specular.value) and any(data.diffuse.value)


def by_rules_of_cycles(data: MaterialData) -> MaterialData:
    """What is Lambert's alone, as a closure: by Cycles' rules for normals that are not the face's, of which the short form has none."""
    if not is_matte(data):
        return data
    closure = ClosureData("diffuse", None, {"color": data.diffuse}, {"version": compat.CYCLES}, None, None, None)
    return replace(data, diffuse=ColorInput(), closures=[closure])


def _plain(material: Any) -> MaterialData:
    """Without nodes: the colours of the viewport. Cycles shows them as diffuse; so does this unless they are metallic."""
    (r, g, b, _), metallic = material.diffuse_color, material.metallic
    diffuse, specular = ((r * share, g * share, b * share) for share in (1.0 - metallic, metallic))
    alpha = ScalarInput(material.roughness**2)
    return MaterialData(
        material.name, diffuse=ColorInput(diffuse), specular=ColorInput(specular), alpha_x=alpha, alpha_y=alpha
    )


def _surface_of(material: Any, owner: Owner) -> MaterialData:
    tree = material.node_tree
    shading = Shading(Reader())
    output = output_use(tree, "Surface", owner)
    if output is None:
        owner.context.note(f"{owner.place} has no output node that is not muted; rendered as black, as in Cycles")
        return MaterialData(material.name)
    linked: dict[str, NodeUse | None] = {}
    for name in ("Volume", "Displacement"):
        part = output_use(tree, name, owner)
        linked[name] = part if part is not None and part.is_linked(name) else None
    if linked["Volume"] is not None:
        linked["Volume"].note("has a volume, which is not supported; it is left out")
    if output.source("Surface").is_nothing:
        if linked["Volume"] is not None:  # its surface is air, as in Cycles
            shading.closures.append(Closure(output, "transparent", 1.0, {"color": WHITE}))
            return material_of(material.name, shading)
        output.note("has no surface connected; rendered as black, as in Cycles")
        return MaterialData(material.name)
    displacement = linked["Displacement"]
    if displacement is not None:
        if compat.displacement_method(material) != "BUMP":
            displacement.note(
                "moves the surface, which is not supported; it stays where it is, and is shown as bump alone"
            )
        bend_by_displacement(displacement, shading.p)
    shading.read(output, "Surface")
    return material_of(material.name, shading)
