# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes: their normals, faces, slots and modifiers, in whatever mode the user left them."""

import math
from typing import Any

import bpy
import numpy as np
from mathutils import Vector
from stage import add as node
from stage import (
    ball,
    box,
    camera,
    daylight,
    diffuse,
    floor,
    gradient,
    image,
    material,
    mesh,
    painted,
    place,
    scene,
    select,
    sheet,
    stage,
)
from wardmis import compat

SAMPLES = 16  # of little noise
SELDOM = {
    "auto_smooth_two_maps",
    "edit_mode_duplicate",
}

MAPS = ("UVMap", "Second", "Third")
# what has no material is, from 5.0 on, the Principled node as it comes: another model of reflection
PLAIN: dict[str, Any] = (
    {"within": 0.1, "why": "no material is Principled in Cycles 5"} if bpy.app.version >= (5, 0) else {}
)


@scene
def solids():
    stage()
    ball(location=(-1.1, 0.2, 1))
    box(location=(1.2, 0, 0.8), scale=(0.7, 0.5, 0.8))


def auto_smooth(made, degrees=30):
    """Smooth where faces meet at less than this."""
    made.data.polygons.foreach_set("use_smooth", [True] * len(made.data.polygons))
    if hasattr(made.data, "use_auto_smooth"):
        made.data.use_auto_smooth, made.data.auto_smooth_angle = True, math.radians(degrees)
    else:
        select(made)
        bpy.ops.object.shade_smooth_by_angle(angle=math.radians(degrees))


def mapped_box(maps, attributes=0):
    """A box with an image on it, sharp edges, and this many UV maps and other attributes."""
    stage()
    picture = image("Colours", gradient(4, 4))
    made = box(painted(lambda tree: node(tree, "TexImage", {"image": picture}).outputs["Color"]), scale=(1.2, 1, 1))
    corners = np.tile([(0, 0), (1, 0), (1, 1), (0, 1)], (6, 1))
    for number, name in enumerate(MAPS[:maps]):
        made.data.uv_layers.new(name=name).data.foreach_set("uv", (corners * (1 - 0.3 * number)).ravel())
    made.data.uv_layers[0].active_render = True
    for number in range(attributes):
        made.data.attributes.new(f"Weight {number}", "FLOAT", "CORNER")
        made.data.attributes.new(f"Tone {number}", "BYTE_COLOR", "CORNER")
    auto_smooth(made)


@scene
def auto_smooth_one_map():
    mapped_box(1)


@scene
def auto_smooth_two_maps():
    mapped_box(2)


@scene
def auto_smooth_three_maps():
    mapped_box(3)


@scene
def auto_smooth_attributes():
    mapped_box(2, attributes=3)


@scene
def edit_mode():
    stage()
    select(ball(location=(-1.1, 0.2, 1), fineness=24))
    bpy.ops.object.mode_set(mode="EDIT")


@scene
def edit_mode_modifier():
    stage()
    made = box(location=(-1.1, 0.2, 1))
    made.modifiers.new("Bend", "SIMPLE_DEFORM").angle = 0.8
    made.modifiers.new("Round", "SUBSURF").render_levels = 2
    select(made)
    bpy.ops.object.mode_set(mode="EDIT")


@scene
def edit_mode_duplicate():
    """Another object of the mesh that is being edited."""
    stage()
    made = box(location=(-1.1, 0.2, 1))
    twin = made.copy()
    twin.location = 1.6, 0.2, 1
    bpy.context.scene.collection.objects.link(twin)
    select(made)
    bpy.ops.object.mode_set(mode="EDIT")


@scene
def edit_mode_boolean():
    stage()
    made, cutter = box(location=(0, 0, 1)), box(location=(0.8, -1, 1.6))
    cutter.hide_render = True
    cut = made.modifiers.new("Cut", "BOOLEAN")
    cut.object, cut.operation = cutter, "DIFFERENCE"
    select(made)
    bpy.ops.object.mode_set(mode="EDIT")


@scene
def sharp_edges():
    stage()
    made = ball(location=(0, 0, 1), fineness=12)
    for edge in made.data.edges:
        a, b = (made.data.vertices[v].co for v in edge.vertices)
        edge.use_edge_sharp = abs(a.z - b.z) < 1e-4 and -0.1 < a.z < 0.6
    if hasattr(made.data, "use_auto_smooth"):
        made.data.use_auto_smooth, made.data.auto_smooth_angle = True, math.pi


@scene
def mixed_shading():
    """Some faces smooth, the others flat."""
    stage()
    made = ball(location=(0, 0, 1), fineness=12)
    made.data.polygons.foreach_set("use_smooth", [i % 3 != 0 for i in range(len(made.data.polygons))])


def custom_normals(turn):
    stage()
    made = box(scale=(1.2, 1.2, 1))
    made.data.polygons.foreach_set("use_smooth", [True] * 6)
    if hasattr(made.data, "use_auto_smooth"):
        made.data.use_auto_smooth = True
    data = made.data
    normals = []
    for face in data.polygons:
        for vertex in face.vertices:
            normals.append(turn(face.normal + 0.2 * data.vertices[vertex].co).normalized())
    data.normals_split_custom_set(normals)


@scene
def custom_normals_round():
    """Slightly: light below the surface is another matter."""
    custom_normals(lambda n: n)


@scene(within=0.08, why="where face and normal disagree, the edge of what is lit is not quite Cycles'")
def custom_normals_backwards():
    custom_normals(lambda n: -n)


def bent(kind, bend, **inputs):
    """A ball of few faces whose normals are bent."""
    stage()
    made, tree, output = material(kind)
    tree.links.new(node(tree, f"Bsdf{kind}", **inputs).outputs[0], output.inputs["Surface"])
    result = ball(made, location=(0, 0, 1), fineness=8)
    data = result.data
    data.polygons.foreach_set("use_smooth", [True] * len(data.polygons))
    if hasattr(data, "use_auto_smooth"):
        data.use_auto_smooth = True
    data.normals_split_custom_set([bend(p.normal, i) for p in data.polygons for i in p.loop_indices])
    return result


def unmoved(made):
    """Shadows start where the face is: with normals straight across it rounding would tell in Cycles whether it is in the light's way."""
    owner, offset, _ = compat.shadow_terminator(made)
    setattr(owner, offset, 0.0)


def upwards(n, _):
    return (n + Vector((0, 0, 1.5))).normalized()


@scene
def smooth_of_few_faces():
    stage()
    for x, add in ((-1.2, bpy.ops.mesh.primitive_cube_add), (1.2, bpy.ops.mesh.primitive_cylinder_add)):
        add(location=(x, 0, 1), **({"vertices": 8} if x > 0 else {"size": 1.4}))
        made = bpy.context.object
        made.data.materials.append(diffuse((0.8, 0.5, 0.3)))
        made.data.polygons.foreach_set("use_smooth", [True] * len(made.data.polygons))


@scene
def diffuse_upwards():
    bent("Diffuse", upwards)


@scene
def translucent_backwards():
    unmoved(bent("Translucent", lambda n, _: -n))


@scene
def translucent_both_ways():
    unmoved(bent("Translucent", lambda n, i: n if i % 2 else -n))


@scene(bounces=2)
def translucent_upwards():
    bent("Translucent", upwards)


@scene(bounces=2, block=16)
def glass_upwards():
    """Rough enough that the sun's light which it gathers on the floor is no matter of luck."""
    bent("Glass", upwards, Roughness=0.6)


@scene
def zero_scale_axis():
    """Open shapes: of a closed one both sides would coincide, and shade each other as the rounding has it."""
    stage()
    wall = mesh("Wall", [(-1, -0.5, -1), (1, 0.4, -1), (1, -0.3, 1), (-1, 0.8, 1)], [(0, 1, 2, 3)])
    wall.location, wall.scale.y = (-1, 0, 1.1), 0
    angles = np.linspace(0, 2 * math.pi, 24, endpoint=False)
    rim = np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=-1)
    hill = mesh("Hill", [(0, 0, 1), *rim], [(0, k + 1, (k + 1) % 24 + 1) for k in range(24)], smooth=True)
    hill.location, hill.scale.z = (1.3, 0, 1), 0


@scene
def negative_scale():
    stage()
    ball(location=(-1.1, 0, 1)).scale = -1, 0.8, 1
    box(location=(1.1, 0, 0.8), scale=(0.7, -0.7, -0.8))


@scene(**PLAIN)
def slots():
    """A colour for each pair of faces, one of them of the object, and faces beyond the slots."""
    stage()
    made = box(diffuse((0.8, 0.2, 0.2)), scale=(1.2, 1.2, 1))
    made.data.materials.append(diffuse((0.2, 0.8, 0.2)))
    made.material_slots[1].link = "OBJECT"
    made.material_slots[1].material = diffuse((0.2, 0.2, 0.8))
    made.data.polygons.foreach_set("material_index", [0, 1, 2, 1, 0, 2])


@scene(**PLAIN)
def no_material():
    stage()
    box().data.materials.clear()
    made = box(location=(-2.2, 0, 0.5), scale=(0.5, 0.5, 0.5))
    made.data.materials.clear()
    made.data.materials.append(None)


@scene
def modifiers():
    """Levels of subdivision and visibility are those of a render."""
    stage()
    made = box(location=(-1.2, 0, 1), scale=(0.8, 0.8, 0.8))
    rounded = made.modifiers.new("Round", "SUBSURF")
    rounded.levels, rounded.render_levels = 0, 3
    other = box(location=(1, 0, 0.5), scale=(0.4, 0.4, 0.4))
    array = other.modifiers.new("Array", "ARRAY")
    array.count, array.show_viewport = 2, False
    hidden = other.modifiers.new("Hidden", "SOLIDIFY")
    hidden.show_render = False
    bevel = other.modifiers.new("Bevel", "BEVEL")
    bevel.width, bevel.segments = 0.1, 2


@scene
def ngons():
    """A face of many corners that is not convex, one with a hole's seam, and one that is not flat."""
    stage()
    n = 14
    star = [
        (math.cos(a) * r, math.sin(a) * r, 1.2)
        for i in range(n)
        for a, r in [(2 * math.pi * i / n, 1.4 - 0.8 * (i % 2))]
    ]
    mesh("Star", star, [tuple(range(n))], diffuse((0.8, 0.5, 0.2)))
    bent = [(-3, -1, 0.2), (-2, -1, 1), (-2, 0.5, 0.2), (-3, 0.5, 1)]
    mesh("Bent", bent, [(0, 1, 2, 3)], diffuse((0.2, 0.5, 0.8)))


@scene
def loose_parts():
    """Vertices and edges without faces are not rendered."""
    stage()
    data = box().data
    data.vertices.add(2)
    data.edges.add(1)
    data.edges[-1].vertices = 8, 9
    data.vertices[8].co, data.vertices[9].co = (-3, 0, 1), (3, 0, 2)
    data.update()


@scene
def parents():
    """Sheared by a parent that is scaled unevenly; one whose parent is not rendered; one with a parent's inverse."""
    floor()
    daylight()
    camera()
    parent = box(location=(0, 0, 0.6), scale=(0.4, 1.4, 0.5), rotation=(0, 0, 0.6))
    child = box(location=(2, 0.4, 1), scale=(1, 0.5, 1), rotation=(0.3, 0.5, 0.7))
    child.parent = parent
    parent.hide_render = True
    other = ball(location=(-1.4, 0, 0.7), radius=0.7)
    other.parent = parent
    other.matrix_parent_inverse = parent.matrix_basis.inverted()


@scene
def two_sided():
    """Both sides are lit alike."""
    stage()
    for x, turn in ((-1.5, 0.0), (1.5, math.pi)):
        made = sheet(diffuse((0.7, 0.6, 0.3)), size=1)
        made.location, made.rotation_euler = (x, 0, 1.2), (0.9 + turn, 0, 0.3)


@scene
def coarse():
    """Normals that are far from the facets' own."""
    stage()
    ball(location=(0, 0, 1), fineness=5)


@scene
def flattened():
    """By a parent that is turned: the transform has, but for rounding, no inverse. One is all but flat, one in Edit Mode."""
    stage()
    steps = np.linspace(-1.2, 1.2, 9)
    x, y = np.meshgrid(steps, steps)
    hills = np.stack([x, y, 0.15 * np.sin(2 * x) * np.cos(3 * y)], axis=-1).reshape(-1, 3)
    index = np.arange(x.size).reshape(x.shape)
    faces = np.stack([index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]], axis=-1).reshape(-1, 4)
    for thickness, place_x, color in ((0, -1.6, (0.8, 0.2, 0.1)), (1e-9, 1.6, (0.2, 0.7, 0.2))):
        parent = place("Parent", None, (place_x, 0, 1), (0.3, 0.2, 0.6), (1, 1, thickness))
        child = mesh("Hills", hills, faces, diffuse(color))
        child.rotation_euler, child.parent = (0.4, 0.5, 0.6), parent
    select(child)
    bpy.ops.object.mode_set(mode="EDIT")


def square(of: Any, size: float, location: Any) -> Any:
    made = mesh("Square", [(-size, -size, 0), (size, -size, 0), (size, size, 0), (-size, size, 0)], [(0, 1, 2, 3)], of)
    made.location = location
    return made


@scene
def twice_in_one_place():
    """Rays leave a face without meeting it, and meet the other in its place: both are black."""
    square(diffuse(), 3, (0, 0, 0.3))
    square(diffuse(), 3, (0, 0, 0.3))
    ball(location=(0, 0, 1.8), radius=0.6)
    camera()
    daylight()


@scene
def part_in_one_place():
    """A picture that lies exactly on the floor."""
    floor()
    square(diffuse((0.8, 0.1, 0.1)), 1, (0, 0, 0))
    ball(location=(0, 0, 1.5), radius=0.6)
    camera()
    daylight()
