# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that takes light away: negative strengths of lamps, materials and worlds, over a sky that leaves something to take."""

import bpy
import numpy as np
from stage import (
    BLUE,
    GREEN,
    RED,
    add,
    ball,
    box,
    camera,
    emitter,
    floor,
    image,
    lamp,
    material,
    mesh,
    scene,
    sheet,
    sky,
    square,
)


def things():
    floor()
    ball(location=(-0.9, 0.2, 1))
    box(location=(1.3, 0.4, 0.6), scale=(0.6, 0.6, 0.6))
    sky((1, 1, 1))
    camera()


def above(of):
    made = mesh("Above", *square(1), of)
    made.location = 0.3, -0.5, 3
    made.visible_camera = False


@scene
def lamps():
    things()
    lamp("POINT", (-2, -2, 4), -60, RED)
    lamp("AREA", (1, -1, 4), -60, GREEN, size=2)
    lamp("SUN", (1, 2, 4), -0.3, BLUE, angle=0.2)


@scene
def emission():
    things()
    above(emitter((1, 0.5, 0.1), -3))


@scene(bounces=3, samples=64)
def emission_and_light():
    """One material that emits and reflects, beside what it takes from."""
    things()
    made, tree, output = material()
    total = add(tree, "AddShader")
    for node, socket in ((add(tree, "Emission", Strength=-0.7), 0), (add(tree, "BsdfDiffuse"), 1)):
        tree.links.new(node.outputs[0], total.inputs[socket])
    tree.links.new(total.outputs[0], output.inputs["Surface"])
    ball(made, location=(0.6, -1.6, 0.5), radius=0.5)
    lamp("POINT", (2, -2, 4), 200)


@scene
def world():
    things()
    sky((0.5, 0.3, 0.1), -1)
    lamp("AREA", (1, -1, 4), 300, size=2)


def toned(tree, shader, node, name):
    """Its colour: what an output of a node tells, below zero too."""
    part = add(tree, "VectorMath", {"operation": "MULTIPLY_ADD"}, Vector=add(tree, node).outputs[name])
    part.inputs[1].default_value, part.inputs[2].default_value = (0.6, 0.6, 0.6), (0.2, 0.2, 0.2)
    tree.links.new(part.outputs[0], shader.inputs["Color"])


@scene
def computed_world():
    things()
    tree = sky((1, 1, 1))
    toned(tree, tree.nodes["Background"], "TexCoord", "Generated")
    camera(target=(0, 0, 2))


@scene
def computed_lamps():
    things()
    for kind, position, power, settings in (
        ("POINT", (-2, -2, 4), 60, {}),
        ("AREA", (1, -1, 4), 60, {"size": 2}),
        ("SUN", (1, 2, 4), 0.3, {"angle": 0.2}),
    ):
        made = lamp(kind, position, power, **settings)
        made.data.use_nodes = True
        toned(made.data.node_tree, made.data.node_tree.nodes["Emission"], "TexCoord", "Normal")


def texels(width, height, least):
    """An image of floats from `least` to `least` + 2, the same every time."""
    return image("Texels", np.random.RandomState(5).rand(height, width, 3) * 2 + least, floats=True)


def textured(shader, mapped=False):
    """A wall that shows the image straight, or turned."""
    made, tree, output = material()
    node = add(tree, shader)
    shown = add(tree, "TexImage", {"image": texels(4, 4, -1)})
    if mapped:
        mapping = add(tree, "Mapping", Vector=add(tree, "TexCoord").outputs["UV"], Rotation=(0, 0, 0.3))
        tree.links.new(mapping.outputs[0], shown.inputs["Vector"])
    tree.links.new(shown.outputs["Color"], node.inputs["Color"])
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    wall = sheet(made, size=1.2)
    wall.location, wall.rotation_euler = (0, -1.5, 1.2), (1.2, 0, 0)


@scene
def image_emission():
    things()
    textured("Emission")


@scene
def image_emission_mapped():
    things()
    textured("Emission", mapped=True)


@scene(bounces=2)
def image_transparent():
    """What is behind turns negative, for the camera, for shadows and for bounces."""
    things()
    textured("BsdfTransparent")
    lamp("POINT", (-1, -4, 4), 300)


@scene
def image_diffuse():
    """Where nothing is reflected, and no less."""
    things()
    textured("BsdfDiffuse")


@scene(samples=128)
def image_world():
    things()
    tree = sky((1, 1, 1))
    shown = add(tree, "TexEnvironment", {"image": texels(16, 8, -0.5)})
    tree.links.new(shown.outputs["Color"], tree.nodes["Background"].inputs["Color"])
    camera(target=(0, 0, 2))


def of_negative_color(kind, name):
    made, tree, output = material(kind)
    below = add(tree, "CombineXYZ", X=0.6, Y=0.4, Z=-0.3)
    node = add(tree, kind)
    tree.links.new(below.outputs[0], node.inputs[name])
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return made


@scene(bounces=2)
def colors_of_nodes():
    """Constants that nodes make, which no slider would."""
    things()
    glossy = "BsdfGlossy" if bpy.app.version < (4, 0) else "BsdfAnisotropic"
    for x, made in (
        (-2.0, of_negative_color("BsdfPrincipled", "Base Color")),
        (-0.4, of_negative_color(glossy, "Color")),
        (1.2, of_negative_color("BsdfTranslucent", "Color")),
        (2.4, of_negative_color("BsdfGlass", "Color")),
    ):
        ball(made, (x, -1.6, 0.6), 0.55)
