# SPDX-License-Identifier: GPL-3.0-or-later
"""The edge of a smooth surface's own shadow, where Cycles moves light samples away from the faces: Shadow Terminator."""

import math
from typing import Any

import bpy
import numpy as np
from stage import add as node
from stage import aim, camera, diffuse, emitter, floor, lamp, material, mesh, place, scene, sky, sun
from wardmis import compat

from scenes.motion import move, shutter

SAMPLES = 64


def column(of: Any = None, sides: int = 12, location: Any = (0, 0, 1), closed: bool = True) -> Any:
    """A smooth cylinder of few sides, about z."""
    angle = np.arange(sides) * 2 * math.pi / sides
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    ends = [np.column_stack([ring, np.full(sides, z)]) for z in (-1.0, 1.0)]
    k = np.arange(sides)
    faces = np.stack([k, (k + 1) % sides, (k + 1) % sides + sides, k + sides], axis=-1).tolist()
    if closed:
        faces += [k[::-1].tolist(), (k + sides).tolist()]
    made = mesh("Column", np.concatenate(ends), faces, of, smooth=True)
    made.location = location
    return made


def offsets(made: Any, geometry: float, shading: float = 0.0) -> Any:
    owner, *names = compat.shadow_terminator(made)
    for name, value in zip(names, (geometry, shading)):
        setattr(owner, name, value)
    return made


def stand() -> None:
    floor()
    sky((0.1, 0.1, 0.1))
    camera()


@scene
def under_a_sun():
    """Columns, an open one among them, a ball, and a smooth cube."""
    stand()
    sun(location=(3, 1, 2))
    column(location=(-1.3, 0, 1))
    column(sides=32, location=(1.3, 0, 1), closed=False)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=12, ring_count=8, radius=0.7, location=(0, -1.6, 0.7))
    bpy.ops.object.shade_smooth()
    bpy.ops.mesh.primitive_cube_add(size=1.2, location=(0, 1.8, 0.6), rotation=(0, 0, 0.5))
    bpy.ops.object.shade_smooth()


@scene(within=0.03, why="how much of a lamp's light is that of light samples depends on how Cycles chooses among lamps")
def under_lamps():
    """That have a size, which surfaces' rays find, too: a lamp, a luminous mesh, a broad sun."""
    stand()
    lamp("AREA", (3, 0.5, 2), 150, size=1.5)
    made = mesh("Panel", [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [(0, 1, 2, 3)], emitter((0.3, 0.5, 1), 8))
    aim(made, (-3, 1, 2), (0, 0, 1))
    sun((1, 0.6, 0.4), 1, (0, -3, 1), angle=0.4)
    column(location=(-1.3, 0, 1))
    column(sides=32, location=(1.3, 0, 1))


@scene
def of_other_offsets():
    """None; more; of the shading; both."""
    stand()
    sun(location=(3, 1, 2))
    for x, offset in zip((-2.4, -0.8, 0.8, 2.4), ((0, 0), (0.5, 0), (0, 0.6), (0.3, 0.3))):
        offsets(column(location=(x, 0, 1)), *offset).scale = 0.7, 0.7, 1


def glossy(roughness: float) -> Any:
    made, tree, output = material()
    shader = node(tree, "BsdfPrincipled", Roughness=roughness, Metallic=0.4)
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return made


def translucent() -> Any:
    made, tree, output = material()
    shader = node(tree, "BsdfTranslucent", Color=(0.8, 0.7, 0.5, 1))
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return made


@scene(samples=128)
def of_other_surfaces():
    """Glossy ones and translucent ones, in the light and before it."""
    stand()
    sun(location=(3, 1, 2))
    lamp("AREA", (-3, 2, 2), 200, size=2)
    offsets(column(glossy(0.3), location=(-2, 0, 1)), 0.1, 0.3)
    column(glossy(0.6), location=(0, 0, 1))
    column(translucent(), location=(2, 0, 1))


@scene
def from_inside():
    """The inner side of open columns, one mirrored."""
    sky((0.1, 0.1, 0.1))
    camera((0, -5, 6), (0, 0, 1))
    sun(location=(2, 1, 3))
    column(location=(-1.4, 0, 1), closed=False)
    column(location=(1.4, 0, 1), closed=False).scale = -1, 1, 1.2


@scene
def of_instances():
    """One mesh, scaled in several ways, with its first object's offsets or its own."""
    stand()
    sun(location=(3, 1, 2))
    first = column(location=(-2, 0, 1))
    place("Wide", first.data, (0, 0.3, 1), rotation=(0.2, 0.1, 0.3), scale=(1.2, 0.5, 1))
    offsets(place("Small", first.data, (2, 0, 0.5), scale=(0.5, 0.5, 0.5)), 0.4)


@scene(bounces=3)
def by_way_of_others():
    """Light of several bounces, in a corner."""
    stand()
    mesh("Wall", [(-3, 1.5, 0), (3, 1.5, 0), (3, 1.5, 4), (-3, 1.5, 4)], [(0, 1, 2, 3)], diffuse((0.8, 0.5, 0.3)))
    sun(location=(3, -1, 2))
    column(location=(-1.3, 0, 1))
    column(sides=32, location=(1.3, 0, 1))


@scene
def of_what_turns():
    stand()
    sun(location=(3, 1, 2))
    move(column(), "rotation_euler", (0, 0, 0), (0.1, 0.2, 0.4), (0, 0, 0.8))
    shutter()


@scene(since=(4, 0))  # before, Cycles takes the normals of what bends in the wrong order
def of_what_bends():
    stand()
    sun(location=(3, 1, 2))
    made = column()
    made.shape_key_add(name="Basis")
    key = made.shape_key_add(name="Wide")
    for point in key.data:
        point.co.x *= 1.5
    move(key, "value", 0, 0.5, 1)
    shutter()
