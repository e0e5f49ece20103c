# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes for test_shapes.py of what is made in unusual ways, and of what bends shapes; entries as those of tests/cycles."""

from __future__ import annotations

import bpy
import numpy as np
from scenes.instances import geometry_nodes, particles
from stage import Scene, ball, box, mesh, place, square, stage

SCENES: list[Scene] = []


def form(build):
    SCENES.append(Scene(f"forms-{build.__name__}", build, 0, 0.0, "", (3, 4), None))
    return build


@form
def hair_strands():
    stage()
    made = mesh("Fur", *square(1.5))
    made.location.z = 0.3
    particles(made, type="HAIR", render_type="PATH", physics_type="NEWTON", hair_length=0.8, root_radius=8.0)
    made.show_instancer_for_render = True


@form
def hair_curves():
    """Curves of the new kind."""
    stage()
    data = bpy.data.hair_curves.new("Curves")
    made = place("Curves", data, (0, 0, 1))
    if hasattr(data, "add_curves"):  # in 3.4 they cannot be filled from Python
        data.add_curves([3, 3])
        points = [(x, 0.1 * k, z) for k, x in enumerate((-0.8, 0.8)) for z in (-0.5, 0, 0.5)]
        data.attributes["position"].data.foreach_set("vector", np.array(points, np.float32).ravel())
        data.attributes.new("radius", "FLOAT", "POINT").data.foreach_set("value", [0.1] * 6)
        made.data.update_tag()
    ball(location=(0, 0, 0.5), radius=0.5)


@form
def nodes_without_a_mesh():
    """Curves and points that geometry nodes make of a mesh."""
    stage()

    def build(tree, geometry):
        points = tree.nodes.new("GeometryNodeMeshToPoints")
        points.inputs["Radius"].default_value = 0.15
        curves, joined = tree.nodes.new("GeometryNodeMeshToCurve"), tree.nodes.new("GeometryNodeJoinGeometry")
        tree.links.new(geometry, points.inputs["Mesh"])
        tree.links.new(geometry, curves.inputs["Mesh"])
        for node in (points, curves):
            tree.links.new(node.outputs[0], joined.inputs[0])
        return joined.outputs[0]

    geometry_nodes(ball(location=(0, 0, 1.2), fineness=4), build)


@form
def curve_without_thickness():
    """It shows nothing, filled or not."""
    stage()
    for kind, x in (("2D", -1.5), ("3D", 1.5)):
        data = bpy.data.curves.new(kind, "CURVE")
        data.dimensions = kind
        spline = data.splines.new("POLY")
        spline.points.add(3)
        for point, (px, py) in zip(spline.points, ((-1, -1), (1, -1), (1, 1), (-1, 1)), strict=True):
            point.co = (px, py, 0, 1)
        spline.use_cyclic_u = True
        place(kind, data, (x, 0, 0.8), (0.4, 0, 0))


# settings of modifiers that make a shape by themselves, from a box and a ball
ALONE = {
    "ARRAY": {"count": 3},
    "BEVEL": {"width": 0.2},
    "BUILD": {"frame_duration": 4},
    "CAST": {"factor": 0.8},
    "DECIMATE": {"ratio": 0.4},
    "DISPLACE": {"strength": 0.2},
    "EDGE_SPLIT": {},
    "LAPLACIANSMOOTH": {"lambda_factor": 0.5},
    "MIRROR": {"use_bisect_axis": (True, False, False)},
    "MULTIRES": {},
    "REMESH": {"mode": "VOXEL", "voxel_size": 0.1},
    "SCREW": {"angle": 1.0, "screw_offset": 0.5},
    "SIMPLE_DEFORM": {"deform_method": "TWIST", "angle": 1.0},
    "SKIN": {},
    "SMOOTH": {"iterations": 5},
    "SOLIDIFY": {"thickness": 0.2},
    "SUBSURF": {"levels": 0, "render_levels": 3},
    "TRIANGULATE": {},
    "WAVE": {"height": 0.4},
    "WELD": {"merge_threshold": 0.1},
    "WIREFRAME": {"thickness": 0.1},
}


@form
def modifiers_alone():
    stage()
    for number, (kind, settings) in enumerate(ALONE.items()):
        x, y = (number % 7 - 3) * 0.8, (number // 7 - 1) * 1.6
        made = box(location=(x, y, 0.5), scale=(0.25, 0.25, 0.25))
        made.name = kind.title()
        modifier = made.modifiers.new(kind, kind)
        for name, value in settings.items():
            setattr(modifier, name, value)
    bpy.context.scene.frame_set(3)


@form
def modifiers_by_others():
    """Bent by another object."""
    stage()
    cutter = ball(location=(0, 0, 1), radius=0.9)
    cutter.hide_render = True
    empty = place("Empty", None, (0.4, 0, 1.5))
    for number, (kind, settings) in enumerate(
        {
            "BOOLEAN": {"object": cutter, "operation": "DIFFERENCE"},
            "SHRINKWRAP": {"target": cutter},
            "HOOK": {"object": empty, "falloff_radius": 2.0, "strength": 0.6},
            "WARP": {"object_from": cutter, "object_to": empty},
            "MIRROR": {"mirror_object": empty},
        }.items()
    ):
        made = box(location=((number - 2) * 0.9, 0.2 * number, 0.8), scale=(0.35, 0.35, 0.35))
        made.name = kind.title()
        modifier = made.modifiers.new(kind, kind)
        for name, value in settings.items():
            setattr(modifier, name, value)
        if kind == "HOOK":
            modifier.vertex_indices_set(range(4))


@form
def simulations():
    """Cloth and soft bodies after a few frames, and an ocean."""
    stage()
    for name, kind, x in (("Cloth", "CLOTH", -1.2), ("Soft", "SOFT_BODY", 1.2)):
        made = mesh(name, *square(1), smooth=True)
        made.location = (x, 0, 1.5)
        made.modifiers.new("Fine", "SUBSURF").render_levels = 2
        made.modifiers.new(kind, kind)
    ocean = mesh("Ocean", *square(1)).modifiers.new("Ocean", "OCEAN")
    ocean.spatial_size, ocean.size, ocean.resolution = 20, 0.1, 4
    bpy.data.objects["Ocean"].location = (-1, 2, 0.4)
    for frame in range(1, 6):
        bpy.context.scene.frame_set(frame)


@form
def keys_and_bones():
    """Shape keys on a curve and a lattice, bones with a shape, and a driver."""
    stage()
    data = bpy.data.curves.new("Curve", "CURVE")
    data.dimensions, data.bevel_depth = "3D", 0.15
    spline = data.splines.new("POLY")
    spline.points.add(2)
    for point, x in zip(spline.points, (-1, 0, 1), strict=True):
        point.co = (x, 0, 0, 1)
    made = place("Curve", data, (0, -0.5, 0.8))
    made.shape_key_add(name="Basis")
    key = made.shape_key_add(name="Up")
    key.data[1].co.z = 1
    key.value = 0.5
    text = bpy.data.curves.new("Text", "FONT")
    text.body, text.extrude = "keys", 0.1
    place("Text", text, (-1, 1, 0.5), (1.4, 0, 0))
    driven = box(location=(1.6, 0.6, 0.4), scale=(0.3, 0.3, 0.3))
    driver = driven.driver_add("scale", 2).driver
    driver.type, driver.expression = "SCRIPTED", "0.2 + 0.5"


@form
def parts_of_the_visible():
    """What collections, layers and single objects hide."""
    stage()
    seen = box(location=(-1, 0, 0.5), scale=(0.4, 0.4, 0.4))
    seen.name = "Seen"
    hidden = box(location=(1, 0, 0.5), scale=(0.4, 0.4, 0.4))
    hidden.hide_render = True
    only_render = box(location=(0, 1, 0.5), scale=(0.4, 0.4, 0.4))
    only_render.hide_viewport = True
    only_render.hide_set(True)
    group = bpy.data.collections.new("Excluded")
    bpy.context.scene.collection.children.link(group)
    excluded = box(location=(0, -1, 0.5), scale=(0.4, 0.4, 0.4))
    group.objects.link(excluded)
    bpy.context.scene.collection.objects.unlink(excluded)
    bpy.context.view_layer.layer_collection.children["Excluded"].exclude = True
