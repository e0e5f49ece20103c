# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes that paths from the camera alone find hard: their light comes by way of places that samples of lights do not
reach."""

import bpy
import numpy as np
from mathutils import Euler, Matrix
from parts import add_area, add_camera, add_mesh, add_point, box_mesh, empty_world, set_up, sphere_mesh, square
from studio import principled, put, turned


def ajar():
    """A room that a door ajar lets light into, from one with a lamp (after Veach 1997, section 10.4)."""
    begin()
    wall = plain("Wall", (0.7, 0.68, 0.64), 0.8)
    for name, center, scale in (
        ("Floor", (0, 1, -0.1), (4, 7, 0.1)),
        ("Ceiling", (0, 1, 3.1), (4, 7, 0.1)),
        ("Left", (-3.1, 1, 1.5), (0.1, 7, 1.5)),
        ("Right", (3.1, 1, 1.5), (0.1, 7, 1.5)),
        ("Front", (0, -4.1, 1.5), (3, 0.1, 1.5)),
        ("Back of the other", (0, 6.1, 1.5), (3, 0.1, 1.5)),
        ("Left of the door", (-1.1, 3, 1.5), (1.9, 0.1, 1.5)),
        ("Right of the door", (2.4, 3, 1.5), (0.6, 0.1, 1.5)),
        ("Over the door", (1.3, 3, 2.6), (0.5, 0.1, 0.4)),
    ):
        box(name, center, scale, wall)
    # hung on its left side, a hand's breadth open
    turn = Matrix.Translation((0.8, 2.95, 0)) @ Euler((0, 0, -0.14)).to_matrix().to_4x4()
    door = box("Door", (0.5, 0, 1.1), (0.5, 0.03, 1.09), plain("Door", (0.45, 0.3, 0.2), 0.4))
    door.matrix_world = turn
    things(((-1.2, 0.8), (0.9, 0.2)))
    add_area((1.0, 5.4, 2.9), (1.0, 5.4, 0), 0.5, 900)
    add_camera((-1.6, -3.6, 1.7), (0.3, 1.5, 1.1), 62)


def caustic():
    """Rough glass and metal on a plane, under a small lamp."""
    begin()
    vertices, faces = square(8)
    add_mesh("Ground", vertices, faces, plain("Ground", (0.6, 0.58, 0.55), 0.7))
    ball("Glass", (-1.1, 0.2, 1.0), 0.9, glass("Glass", 0.1))
    ball("Ice", (0.6, -1.1, 0.55), 0.5, glass("Ice", 0.25))
    ring(
        "Ring",
        (1.4, 0.5, 0.3),
        0.9,
        0.3,
        principled("Gold", {"Base Color": (0.9, 0.7, 0.4, 1), "Metallic": 1, "Roughness": 0.15}),
    )
    add_point((-2.5, 2.5, 4.5), 700, 0.05)
    add_camera((0.4, -6.5, 4.2), (0, -0.1, 0.5), 40)


def lamps_inside():
    """A room whose lamps are in fixtures: in globes of frosted glass and in shades that are open above alone."""
    begin()
    wall = plain("Wall", (0.72, 0.7, 0.66), 0.8)
    for name, center, scale in (
        ("Floor", (0, 0, -0.1), (4, 4, 0.1)),
        ("Ceiling", (0, 0, 3.3), (4, 4, 0.1)),
        ("Left", (-3.6, 0, 1.6), (0.1, 4, 1.6)),
        ("Right", (3.6, 0, 1.6), (0.1, 4, 1.6)),
        ("Front", (0, -4.1, 1.6), (3.6, 0.1, 1.6)),
        ("Back", (0, 3.6, 1.6), (3.6, 0.1, 1.6)),
    ):
        box(name, center, scale, wall)
    frosted = glass("Frosted", 0.2)
    shade = principled("Shade", {"Base Color": (0.85, 0.82, 0.78, 1), "Metallic": 1, "Roughness": 0.3})
    for x, y in ((-1.8, 2.0), (1.9, -0.5)):
        ball("Globe", (x, y, 2.4), 0.3, frosted)
        add_point((x, y, 2.4), 120, 0.06)
    for x, y in ((2.6, 2.6), (-2.6, -1.2)):
        cup("Shade", (x, y, 1.7), 0.25, 0.35, shade)
        add_point((x, y, 1.65), 150, 0.05)
    things(((-1.0, 0.9), (0.9, 0.9)))
    add_camera((0.6, -3.7, 1.8), (-0.1, 1.2, 1.2), 66)


# ---- what they are made of -----------------------------------------------------------------------------------------


def begin():
    """An empty scene, without light."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    set_up(768, 512)
    empty_world().nodes["Background"].inputs["Strength"].default_value = 0.0


def plain(name, color, roughness):
    return principled(name, {"Base Color": (*color, 1), "Roughness": roughness})


def glass(name, roughness):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    node = nodes.new("ShaderNodeBsdfGlass")
    node.inputs["Roughness"].default_value = roughness
    node.inputs["IOR"].default_value = 1.45
    material.node_tree.links.new(node.outputs[0], nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return material


def box(name, center, scale, material):
    vertices, faces = box_mesh()
    return add_mesh(name, np.multiply(vertices, scale) + center, faces, material)


def ball(name, center, radius, material):
    vertices, faces = sphere_mesh(96, 48)
    return add_mesh(name, np.multiply(vertices, radius) + center, faces, material, smooth=True)


def things(places):
    ball("Ball", (*places[0], 0.6), 0.6, plain("Ball", (0.7, 0.2, 0.1), 0.3))
    box("Box", (*places[1], 0.45), (0.45, 0.45, 0.45), plain("Box", (0.2, 0.4, 0.7), 0.4))


def ring(name, center, radius, height, material):
    """A hoop that bulges outwards."""
    profile = [(radius - 0.06 * t**2, height * t) for t in np.linspace(-1, 1, 9)]
    return put(add_mesh(name, *turned(profile, 128), material, smooth=True), center)


def cup(name, center, radius, half, material):
    """Closed below."""
    profile = [(0, -half), (radius, -half), (radius, half)]
    return put(add_mesh(name, *turned(profile, 64), material), center)
