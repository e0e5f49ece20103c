# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps. A light of one primary colour on white objects has a channel of the image for itself: three are compared in one scene."""

import math
from typing import Any

import bpy
from stage import (
    ALPHA,
    BLUE,
    GREEN,
    OF_LAYERS,
    OF_OBJECTS,
    RED,
    add,
    attribute,
    ball,
    box,
    camera,
    collection,
    emitter,
    floor,
    gradient,
    image,
    instance,
    lamp,
    material,
    mesh,
    place,
    scene,
    sky,
    sphere_mesh,
    weighted,
    with_properties,
)

SAMPLES = 64  # of lamps far away and narrow ones
SELDOM = {
    "ies_without_file",
    "of_no_surface",
    "parametric_of_areas",
    "parametric_of_others",
    "projected_patterns",
    "round_areas",
    "sheared_instances",
    "smoothed_falloff",
    "uvs_of_areas",
    "uvs_of_others",
}
COARSE: dict[str, Any] = {
    "block": 16
}  # where few pixels at the edges of shadows and beams have most of a small block's noise


def things():
    floor()
    ball(location=(-0.9, 0.2, 1))
    box(location=(1.3, 0.4, 0.6), scale=(0.6, 0.6, 0.6))
    camera()


@scene(**COARSE)
def points():
    things()
    lamp("POINT", (-2, -2, 4), 300, RED)
    lamp("POINT", (2, -3, 3), 300, GREEN, shadow_soft_size=0.1)
    lamp("POINT", (0.5, 1, 3), 300, BLUE, shadow_soft_size=0.8)


@scene(**COARSE, samples=128)
def spots():
    things()
    lamp("SPOT", (-2, -3, 4), 600, RED, spot_size=0.7, spot_blend=0.3)
    lamp("SPOT", (2, -3, 3), 600, GREEN, spot_size=0.8, spot_blend=1.0, shadow_soft_size=0.3, scale=(1.4, 0.7, 1))
    lamp("SPOT", (1, 1, 4), 600, BLUE, spot_size=1.5, spot_blend=0.0, shadow_soft_size=0.1)


def three_suns(*angles):
    """Of so many radians."""
    things()
    for position, color, angle in zip(((-2, -3, 4), (3, -3, 3), (1, 2, 4)), (RED, GREEN, BLUE), angles):
        lamp("SUN", position, 2, color, angle=angle)


@scene(**COARSE)
def suns():
    three_suns(0, 0.1, 1.2)


@scene
def wide_suns():
    three_suns(math.radians(90), math.radians(120), math.radians(150))


@scene(**COARSE)
def widest_suns():
    three_suns(math.radians(165), math.radians(170), math.radians(179))


@scene
def areas():
    things()
    lamp("AREA", (-2, -3, 3), 100, RED, turned=0.4, shape="RECTANGLE", size=2, size_y=0.5, scale=(1, 1.5, 1))
    lamp("AREA", (3, -2, 3), 100, GREEN, shape="SQUARE", size=0.6, spread=1.2)
    lamp("AREA", (0, 2, 3.5), 100, BLUE, shape="SQUARE", size=1.5)


@scene(**COARSE, samples=128)
def round_areas():
    things()
    lamp("AREA", (-2, -3, 3), 100, RED, shape="DISK", size=1)
    lamp("AREA", (3, -2, 3), 100, GREEN, turned=0.5, shape="ELLIPSE", size=2, size_y=0.7)
    lamp("AREA", (0, 2, 3.5), 100, BLUE, turned=0.5, shape="ELLIPSE", size=0.5, size_y=1.5, spread=0.8)


@scene
def seen_by_the_camera():
    """Lamps are visible when their objects are told to be."""
    things()
    for color, x, kind, settings in (
        (RED, -1.5, "POINT", {"shadow_soft_size": 0.3}),
        (GREEN, 0.2, "AREA", {"shape": "DISK", "size": 0.7}),
        (BLUE, 2, "SPOT", {"shadow_soft_size": 0.3}),
    ):
        made = lamp(kind, (x, -1, 2.2), 20, color, target=(0.6, -7, 3), **settings)
        made.visible_camera = True


def sheared_parent():
    return place("Parent", None, (0, 0, 0), (0, 0, 0.5), (0.6, 1.5, 1))


def sheared_lamps():
    """The rectangle looks straight down, so that its axes stay orthogonal: Cycles' own picture of another depends on how it samples.

    So does, in later Blenders, that of an ellipse with a spread, of which only a part is sampled for each point, by axes taken for orthogonal.
    """
    return [
        lamp("SPOT", (-2, -1, 4), 600, RED, spot_size=0.7, spot_blend=0.3, shadow_soft_size=0.1),
        lamp("AREA", (3, -1, 3), 100, GREEN, (3, -1, 0), shape="RECTANGLE", size=2, size_y=0.7, spread=2.5),
        lamp("AREA", (0, 1, 3.5), 100, BLUE, turned=0.6, shape="ELLIPSE", size=0.7, size_y=1.5),
    ]


@scene(**COARSE)
def sheared():
    things()
    parent = sheared_parent()
    for made in sheared_lamps():
        made.parent = parent


@scene(**COARSE, samples=128, noise=0.05, why="Cycles 5.2 has rare bright samples of the spot")
def sheared_instances():
    things()
    instance(collection("Lamps", *sheared_lamps()), (0, 0, 0), (0, 0, 0.5), (0.6, 1.5, 1))


@scene(**COARSE, samples=128)
def without_shadow():
    things()
    for made in (
        lamp("POINT", (-2, -2, 4), 300, RED),
        lamp("SUN", (3, -3, 3), 2, GREEN),
        lamp("AREA", (0, 2, 3.5), 100, BLUE),
    ):
        if hasattr(made.data.cycles, "cast_shadow"):
            made.data.cycles.cast_shadow = False
        else:
            made.data.use_shadow = False


@scene(bounces=3, **COARSE)
def max_bounces():
    """A lamp that lights first surfaces alone, one that lights two of them, one without limit."""
    things()
    wall = floor()
    wall.location, wall.rotation_euler = (0, 3, 0), (math.pi / 2, 0, 0)
    for limit, color, x in ((0, RED, -2), (1, GREEN, 0.5), (1024, BLUE, 2)):
        lamp("POINT", (x, -2, 3), 300, color, shadow_soft_size=0.1).data.cycles.max_bounces = limit


@scene
def nodes():
    """An Emission in the lamp's tree: its colour and strength count beside the lamp's own."""
    things()
    for made, color in ((lamp("POINT", (-2, -2, 4), 300), RED), (lamp("SUN", (3, -3, 3), 2, angle=0.1), GREEN)):
        made.data.use_nodes = True
        made.data.node_tree.nodes["Emission"].inputs["Color"].default_value = (*color, 1)
        made.data.node_tree.nodes["Emission"].inputs["Strength"].default_value = 0.7


@scene
def muted_nodes():
    """A muted Emission gives no light; a muted Math passes its first number."""
    things()
    dark = lamp("POINT", (-2, -2, 4), 300, RED)
    dark.data.use_nodes = True
    dark.data.node_tree.nodes["Emission"].mute = True
    passed = lamp("POINT", (2, -3, 3), 300, GREEN)
    passed.data.use_nodes = True
    tree = passed.data.node_tree
    half = add(tree, "Math", {"operation": "MULTIPLY", "mute": True})
    half.inputs[0].default_value, half.inputs[1].default_value = 0.5, 0.1
    tree.links.new(half.outputs[0], tree.nodes["Emission"].inputs["Strength"])
    lamp("POINT", (1, 1, 3), 100, BLUE)


@scene(**COARSE)
def falloff():
    """Quadratic falloff is what light does; the others fall off less, or not at all."""
    things()
    for kind, position, power, color in (
        ("Quadratic", (-2, -2, 4), 100, RED),
        ("Linear", (2, -3, 3), 30, GREEN),
        ("Constant", (0.5, 1, 3), 10, BLUE),
    ):
        tree = tree_of(lamp("POINT", position, power, color))
        node = add(tree, "LightFalloff", Strength=3.0)
        tree.links.new(node.outputs[kind], tree.nodes["Emission"].inputs["Strength"])


@scene
def smoothed_falloff():
    things()
    for kind, position, power, color, size in (
        ("Quadratic", (-1, -1, 1.5), 100, RED, 0.0),
        ("Quadratic", (2, -2, 1), 100, GREEN, 0.4),
        ("Linear", (0.5, 1, 3), 60, BLUE, 0.2),
    ):
        tree = tree_of(lamp("POINT", position, power, color, shadow_soft_size=size))
        node = add(tree, "LightFalloff", Strength=3.0, Smooth=1.5)
        tree.links.new(node.outputs[kind], tree.nodes["Emission"].inputs["Strength"])


def tree_of(obj):
    obj.data.use_nodes = True
    return obj.data.node_tree


@scene(**COARSE)
def projected_patterns():
    """Of each kind of lamp, by the direction of its light as the lamp has it."""
    things()
    for kind, position, power, color in (
        ("POINT", (-2, -2, 4), 300, RED),
        ("SPOT", (2, -3, 3), 300, GREEN),
        ("SUN", (1, 2, 4), 2, BLUE),
    ):
        tree = tree_of(lamp(kind, position, power, color))
        texture = add(tree, "TexChecker", Vector=add(tree, "TexCoord").outputs["Normal"], Scale=4.3)
        tree.links.new(texture.outputs["Fac"], tree.nodes["Emission"].inputs["Strength"])


@scene(**COARSE)
def pattern_on_an_area():
    """By the place on the lamp, and a Fresnel of the angle that it is seen at."""
    things()
    tree = tree_of(lamp("AREA", (-2, -2, 3), 100, RED, size=2))
    texture = add(tree, "TexChecker", Vector=add(tree, "NewGeometry").outputs["Position"], Scale=1.3)
    tree.links.new(texture.outputs["Fac"], tree.nodes["Emission"].inputs["Strength"])
    tree = tree_of(lamp("AREA", (2, -3, 3), 200, GREEN, size=1, shape="DISK"))
    facing = add(tree, "LayerWeight", Blend=0.3)
    tree.links.new(facing.outputs["Facing"], tree.nodes["Emission"].inputs["Strength"])
    lamp("POINT", (0.5, 1, 3), 300, BLUE)


def parts(output):
    """Lamps whose strength is x + 2 y of an output."""

    def make(kind, position, power, color, **more):
        made = lamp(kind, position, power, color, turned=0.7, **more)
        tree = tree_of(made)
        source = add(tree, output[0]).outputs[output[1]]
        split = add(tree, "SeparateXYZ", Vector=source)
        both = add(tree, "Math", {"operation": "MULTIPLY_ADD"})
        tree.links.new(split.outputs["Y"], both.inputs[0])
        both.inputs[1].default_value = 2.0
        tree.links.new(split.outputs["X"], both.inputs[2])
        tree.links.new(both.outputs[0], tree.nodes["Emission"].inputs["Strength"])

    return make


UVS, PARAMETRIC = ("TexCoord", "UV"), ("NewGeometry", "Parametric")


def on_areas(output):
    things()
    make = parts(output)
    make("AREA", (-2, -2, 3), 100, RED, size=2)
    make("AREA", (2, -3, 3), 100, GREEN, size=1, size_y=2, shape="RECTANGLE", scale=(1.5, 0.8, 1))
    make("AREA", (1, 1.5, 3), 100, BLUE, size=1.5, shape="DISK")


def on_others(output):
    things()
    make = parts(output)
    make("POINT", (-2, -2, 4), 200, RED, shadow_soft_size=0.3)
    make("SPOT", (2, -3, 3), 300, GREEN, spot_size=1.5, spot_blend=0.2)
    if bpy.app.version >= (4, 0):  # random numbers before
        make("SUN", (1, 2, 4), 2, BLUE, angle=0.3)


@scene(**COARSE)
def uvs_of_areas():
    """0 before 4.0."""
    on_areas(UVS)


@scene(**COARSE, samples=128)
def parametric_of_areas():
    on_areas(PARAMETRIC)


@scene(**COARSE)
def uvs_of_others():
    on_others(UVS)


@scene(**COARSE)
def parametric_of_others():
    on_others(PARAMETRIC)


@scene
def images_on_lamps():
    """As a soft box and a slide projector, without coordinates."""
    things()
    picture = image("Slide", gradient(4, 4))
    for kind, position, power, settings in (
        ("AREA", (-2, -2, 3), 100, {"size": 1.5}),
        ("SPOT", (2, -3, 3), 300, {"spot_size": 1.2, "spot_blend": 0.1}),
    ):
        tree = tree_of(lamp(kind, position, power, **settings))
        texture = add(tree, "TexImage", {"image": picture})
        tree.links.new(texture.outputs["Color"], tree.nodes["Emission"].inputs["Color"])


@scene
def of_no_surface():
    """What nodes of lamps tell of surfaces and objects."""
    things()
    outputs = [
        ("NewGeometry", "Pointiness", 0.3),
        ("NewGeometry", "Random Per Island", 0.3),
        ("Attribute", "Alpha", 0.2),
        ("PointInfo", "Position", 0.1),
        ("TexCoord", "Reflection", 0.3),
        ("TexCoord", "Camera", 0.03),
        *(("ObjectInfo", name, 0.1) for name in ("Location", "Color", "Alpha", "Object Index", "Random")),
    ]
    if bpy.app.version >= (4, 0):
        outputs.append(("Tangent", "Tangent", 0.3))
    for kind, position, power, settings in (
        ("POINT", (-2, -2, 4), 30, {"shadow_soft_size": 0.3}),
        ("AREA", (2, -3, 3), 100, {"size": 1.5}),
        ("SUN", (1, 2, 4), 0.5, {"angle": 0.2}),
    ):
        made = lamp(kind, position, power, turned=0.7, **settings)
        made.color, made.pass_index = (0.3, 0.5, 0.7, 0.4), 2
        tree = tree_of(made)
        tree.links.new(weighted(tree, outputs), tree.nodes["Emission"].inputs["Color"])


@scene
def attributes_of_lamps():
    """Of view layers, and of objects: lamps are some since Blender 5."""
    things()
    with_properties(bpy.context.scene)
    outputs = [(attribute("VIEW_LAYER", name), output, 0.2) for name, output in OF_LAYERS]
    outputs += [(attribute("OBJECT", name), output, 0.2) for name, output in OF_OBJECTS]
    outputs += [(attribute("INSTANCER", "own"), ALPHA, 0.2), (attribute("INSTANCER", "none"), ALPHA, 0.4)]
    for kind, position, power, settings in (
        ("POINT", (-2, -2, 4), 30, {"shadow_soft_size": 0.3}),
        ("AREA", (2, -3, 3), 60, {"size": 1.5}),
        ("SUN", (1, 2, 4), 0.3, {"angle": 0.2}),
    ):
        made = lamp(kind, position, power, **settings)
        with_properties(made)
        tree = tree_of(made)
        tree.links.new(weighted(tree, outputs), tree.nodes["Emission"].inputs["Color"])


@scene(without=(4, 3))
def in_their_space():
    """Stretched and turned; Cycles 4 takes an arbitrary space for a lamp's."""
    things()
    for kind, position, power, color, settings in (
        ("POINT", (-2, -2, 4), 60, RED, {"shadow_soft_size": 0.3}),
        ("SPOT", (2, -3, 3), 100, GREEN, {"spot_size": 1.5, "spot_blend": 0.2}),
        ("SUN", (1, 2, 4), 0.5, BLUE, {"angle": 0.2}),
    ):
        tree = tree_of(lamp(kind, position, power, color, turned=0.7, scale=(1, 1.5, 0.7), **settings))
        normal = add(tree, "NewGeometry").outputs["Normal"]
        spaces = {"vector_type": "VECTOR", "convert_from": "WORLD", "convert_to": "OBJECT"}
        moved = add(tree, "VectorTransform", spaces, Vector=normal)
        total = weighted(tree, [("TexCoord", "Normal", 0.3)])
        total.node.inputs[2].default_value = 1, 1, 1
        both = add(tree, "VectorMath", {"operation": "MULTIPLY_ADD"}, Vector=moved.outputs[0])
        both.inputs[1].default_value = 0.2, 0.2, 0.2
        tree.links.new(total, both.inputs[2])
        dotted = add(tree, "VectorMath", {"operation": "DOT_PRODUCT"}, Vector=both.outputs[0])
        dotted.inputs[1].default_value = 0.3, 0.5, 0.7
        tree.links.new(dotted.outputs["Value"], tree.nodes["Emission"].inputs["Strength"])


@scene(**COARSE, samples=192)
def light_path():
    """Lamps are looked at for rays of all kinds at once: none of these is known."""
    things()
    tree = tree_of(lamp("AREA", (-2, -2, 3), 100, RED, size=2))
    path = add(tree, "LightPath").outputs
    total = path["Is Camera Ray"]
    for name in ("Is Diffuse Ray", "Is Glossy Ray", "Is Shadow Ray"):
        node = add(tree, "Math", {"operation": "ADD"})
        tree.links.new(total, node.inputs[0])
        tree.links.new(path[name], node.inputs[1])
        total = node.outputs[0]
    strength = add(tree, "Math", {"operation": "MULTIPLY_ADD"})
    tree.links.new(total, strength.inputs[0])
    strength.inputs[1].default_value, strength.inputs[2].default_value = 3.0, 0.5
    tree.links.new(strength.outputs[0], tree.nodes["Emission"].inputs["Strength"])
    tree = tree_of(lamp("POINT", (2, -3, 3), 100, GREEN))
    length = add(tree, "Math", {"operation": "MULTIPLY"})
    tree.links.new(add(tree, "LightPath").outputs["Ray Length"], length.inputs[0])
    tree.links.new(length.outputs[0], tree.nodes["Emission"].inputs["Strength"])
    lamp("POINT", (0.5, 1, 3), 300, BLUE)


@scene
def blackbody():
    things()
    made = lamp("POINT", (-2, -2, 4), 300)
    made.data.use_nodes = True
    tree = made.data.node_tree
    tree.links.new(add(tree, "Blackbody", Temperature=3500.0).outputs[0], tree.nodes["Emission"].inputs["Color"])


@scene
def hidden():
    """Not rendered: hidden, in a hidden collection, black, of no power."""
    things()
    lamp("POINT", (-2, -2, 4), 300, RED).hide_render = True
    lamp("POINT", (2, -3, 3), 300, GREEN)
    group = collection("Hidden", lamp("POINT", (0.5, 1, 3), 300, BLUE), linked=True)
    group.hide_render = True
    lamp("POINT", (1, 1, 3), 0)
    lamp("POINT", (1, 1, 3), 100, (0, 0, 0))


@scene(since=(4, 0), **COARSE)
def true_spheres():
    """Without soft falloff a lamp with a radius is a sphere."""
    things()
    lamp("POINT", (-2, -2, 4), 300, RED, shadow_soft_size=0.5, use_soft_falloff=False)
    lamp("SPOT", (2, -3, 3), 300, GREEN, shadow_soft_size=0.4, use_soft_falloff=False, spot_size=1)
    lamp("POINT", (0.5, 1, 3), 300, BLUE, shadow_soft_size=0.8)


@scene(since=(5, 0))
def exposure():
    """What 5.x added: exposure, a temperature, and a power that is not shared over the area."""
    things()
    lamp("POINT", (-2, -2, 4), 100, RED, exposure=1.5)
    lamp("AREA", (3, -2, 3), 10, GREEN, shape="DISK", size=0.7, normalize=False)
    lamp("SUN", (1, 2, 4), 1, BLUE, angle=0.3, use_temperature=True, temperature=4000)


@scene
def mesh_light():
    """Of small triangles: 3.4's Cycles loses up to 5 % of the light of large ones."""
    things()
    lamp_mesh = mesh("Egg", *sphere_mesh(48, 24), emitter((1, 0.6, 0.2), 20))
    lamp_mesh.location, lamp_mesh.rotation_euler, lamp_mesh.scale = (2.6, -2, 1), (0.3, 0, 1), (0.2, 0.2, 0.4)


@scene
def negative():
    """It takes light away."""
    things()
    lamp("SUN", (-2, -3, 4), 2)
    lamp("POINT", (2, -3, 3), -60, (0.2, 0.5, 1))


@scene(**COARSE, samples=128)
def extremes():
    """A spot as wide as it can be, an area light that is nearly a beam, and a lamp that is larger than what it lights."""
    things()
    lamp("SPOT", (-2, -3, 4), 300, RED, spot_size=math.pi, spot_blend=0.5, shadow_soft_size=0.1)
    lamp("AREA", (1, -1, 4), 100, GREEN, shape="SQUARE", size=2, spread=math.radians(10))
    lamp("POINT", (2, 3, 5), 2000, BLUE, shadow_soft_size=2.5)


@scene
def just_behind_a_face():
    """Of three lamps by a ceiling only the one that is below it lights the room: the shadow rays go all the way."""
    things()
    ceiling = mesh("Ceiling", [(-3, -3, 0), (3, -3, 0), (3, 3, 0), (-3, 3, 0)], [(0, 1, 2, 3)])
    ceiling.location = 0, 0, 4
    lamp("AREA", (0, 0, 4.0002), 100, RED, target=(0, 0, 0), size=1)
    lamp("AREA", (1, 0, 3.9998), 100, GREEN, target=(1, 0, 0), size=1)
    lamp("POINT", (0, 1, 4.0002), 100, BLUE)


@scene(**COARSE, samples=128, noise=0.06, why="Cycles 3.4 finds the part of a beam's lamp that a point sees by chance")
def narrow_areas():
    """A point sees a part of each alone."""
    things()
    lamp("AREA", (-1, -1, 4), 100, RED, target=(-1, 0, 0), shape="SQUARE", size=2, spread=math.radians(3))
    lamp("AREA", (1, -1, 3), 100, GREEN, shape="ELLIPSE", size=1, size_y=2, spread=math.radians(15))
    lamp("AREA", (0, 2, 3), 100, BLUE, shape="RECTANGLE", size=1, size_y=2, spread=math.radians(50))


@scene
def portal():
    """An area light that is a portal for the sky gives no light of its own."""
    things()
    sky((0.5, 0.5, 0.5))
    lamp("AREA", (0, 0, 3), 200, size=2).data.cycles.is_portal = True


@scene
def touching():
    """Lamps that stand on the floor."""
    things()
    lamp("POINT", (-2.4, -1, 0), 30, RED, shadow_soft_size=0.4)
    made = lamp("AREA", (2.2, -1, 0.3), 30, GREEN, shape="SQUARE", size=0.6)
    made.rotation_euler = math.pi / 2, 0, 1


def with_nodes(build):
    """A lamp whose output `build(tree)` feeds."""
    things()
    made = lamp("POINT", (-1, -2, 4), 100, shadow_soft_size=0.1)
    made.data.use_nodes = True
    tree = made.data.node_tree
    output = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeOutputLight")
    tree.links.new(build(tree), output.inputs["Surface"])
    sky((0.1, 0.1, 0.1))


@scene
def background_node():
    """Which shines in some Blenders."""
    with_nodes(lambda tree: add(tree, "Background", Color=(0.2, 0.9, 0.4, 1)).outputs[0])


@scene
def ies_without_file():
    """Which counts as 100."""
    with_nodes(lambda tree: add(tree, "Emission", Strength=add(tree, "TexIES", Strength=0.02).outputs[0]).outputs[0])


@scene(bounces=2)
def not_met():
    """Without multiple importance sampling: the camera sees it, a mirror does not."""
    things()
    made, tree, output = material()
    shader = add(tree, "BsdfGlossy" if bpy.app.version < (4, 0) else "BsdfAnisotropic", Roughness=0.0)
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    ball(made, location=(0.2, -1.2, 0.6), radius=0.6)
    for kind, at in (("AREA", (1, -1, 4)), ("POINT", (-1.5, -0.5, 2.8)), ("SUN", (0.3, -0.4, 5))):
        light = lamp(kind, at, 2 if kind == "SUN" else 100, target=(0, 0, 0))
        light.visible_camera = True
        light.data.cycles.use_multiple_importance_sampling = False
    bpy.context.scene.camera.data.lens = 22
