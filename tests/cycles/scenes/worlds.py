# SPDX-License-Identifier: GPL-3.0-or-later
"""Skies: constant ones, images, and what their nodes may hold."""

import math

import bpy
import numpy as np
from stage import (
    ALPHA,
    OF_LAYERS,
    add,
    attribute,
    ball,
    box,
    camera,
    floor,
    image,
    material,
    saved_image,
    scene,
    sky,
    sun,
    weighted,
    with_properties,
)

SELDOM = {
    "sky_atmosphere_oblique",
    "sky_hosek_wilkie",
    "sky_of_two",
    "sky_preetham_oblique",
    "sky_with_the_smallest_sun",
    "sky_with_a_sun_at_the_horizon",
    "sky_with_a_sun_oblique",
    "sky_with_a_sun_past_the_zenith",
}


def things():
    floor()
    ball(location=(-0.9, 0.2, 1))
    box(location=(1.3, 0.4, 0.6), scale=(0.6, 0.6, 0.6))
    camera()


def empty():
    """A world with an output alone: its tree, and the output."""
    tree = sky((0, 0, 0))
    tree.nodes.clear()
    return tree, tree.nodes.new("ShaderNodeOutputWorld")


@scene
def overcast():
    things()
    sky((0.9, 0.5, 0.2), 0.8)


@scene
def no_world():
    things()
    bpy.context.scene.world = None
    sun()


def pixels(width, height):
    v, u = (np.mgrid[0:height, 0:width] + 0.5) / np.array([height, width])[:, None, None]
    made = np.stack([v, 0.5 + 0.5 * np.sin(2 * math.pi * u), 0 * u + 0.3], axis=-1)
    rows, columns = slice(5 * height // 8, 3 * height // 4), slice(5 * width // 32, width // 4)
    made[rows, columns] = 30, 20, 10
    return made


def image_sky(width, build=things, **mapping):
    """Smooth, with a window that is much brighter."""
    build()
    tree = sky((1, 1, 1))
    texture = add(tree, "TexEnvironment", {"image": image("sky", pixels(width, width // 2), floats=True)})
    node, coordinates = tree.nodes.new("ShaderNodeMapping"), tree.nodes.new("ShaderNodeTexCoord")
    for name, value in mapping.items():
        node.inputs[name].default_value = value
    tree.links.new(coordinates.outputs["Generated"], node.inputs["Vector"])
    tree.links.new(node.outputs["Vector"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], tree.nodes["Background"].inputs["Color"])
    tree.nodes["Background"].inputs["Strength"].default_value = 0.7


@scene
def image_small():
    image_sky(64, Rotation=(0.4, -0.3, 1.1))


@scene
def image_large():
    image_sky(1024, Rotation=(0, 0, 0.5))


@scene
def image_stretched():
    image_sky(64, Rotation=(0.4, -0.3, 1.1), Scale=(1, -1.6, 0.5))


@scene
def image_seen():
    """Behind things, where the camera looks at it."""
    image_sky(64)
    bpy.context.scene.camera.rotation_euler = 1.75, 0, 0.05
    bpy.context.scene.camera.data.lens = 20


@scene
def image_of_limited_size():
    """Of 300 by 150 texels, 75 by 37 are left."""
    image_sky(300)
    bpy.context.scene.render.use_simplify, bpy.context.scene.cycles.texture_limit_render = True, "128"
    bpy.context.scene.camera.rotation_euler = 1.75, 0, 0.05
    bpy.context.scene.camera.data.lens = 20


@scene
def muted_background():
    things()
    tree = sky((0.9, 0.5, 0.2))
    tree.nodes["Background"].mute = True
    sun()


@scene
def emission():
    """An Emission in a Background's place."""
    things()
    tree, output = empty()
    tree.links.new(add(tree, "Emission", Color=(0.9, 0.5, 0.2, 1), Strength=0.7).outputs[0], output.inputs["Surface"])


@scene
def added_shaders():
    things()
    tree, output = empty()
    first = add(tree, "Background", Color=(0.9, 0.1, 0.2, 1), Strength=0.7)
    second = add(tree, "Background", Color=(0.1, 0.5, 0.2, 1), Strength=0.7)
    both = tree.nodes.new("ShaderNodeAddShader")
    tree.links.new(first.outputs[0], both.inputs[0])
    tree.links.new(second.outputs[0], both.inputs[1])
    tree.links.new(both.outputs[0], output.inputs["Surface"])


def by_light_path(output, first, second):
    """A world whose shader is the second where an output of Light Path is 1; the camera sees some of it."""
    tree, world = empty()
    mix, path = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeLightPath")
    tree.links.new(path.outputs[output], mix.inputs[0])
    tree.links.new(first(tree).outputs[0], mix.inputs[1])
    tree.links.new(second(tree).outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], world.inputs["Surface"])
    bpy.context.scene.camera.rotation_euler = 1.5, 0, 0.05
    bpy.context.scene.camera.data.lens = 20
    return tree


def plain(*color):
    return lambda tree: add(tree, "Background", Color=(*color, 1))


def textured(tree):
    texture = add(tree, "TexEnvironment", {"image": image("sky", pixels(64, 32), floats=True)})
    return add(tree, "Background", Color=texture.outputs["Color"], Strength=0.6)


def shiny_things():
    """With a mirror, whose reflection is the same in all models."""
    things()
    made, tree, output = material()
    kind = "BsdfGlossy" if bpy.app.version < (4, 0) else "BsdfAnisotropic"
    shader = add(tree, kind, {"distribution": "BECKMANN"}, Color=(0.9, 0.8, 0.7, 1), Roughness=0.0)
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    ball(made, (0.4, -1.2, 0.5), 0.5)


@scene
def mixed_by_light_path():
    """What the camera sees is another sky than what lights the scene."""
    things()
    by_light_path("Is Camera Ray", plain(0.8, 0.7, 0.6), plain(0.1, 0.2, 0.9))


@scene(samples=64)
def image_lights_and_camera_sees_a_color():
    shiny_things()
    by_light_path("Is Camera Ray", textured, plain(0.1, 0.2, 0.9))


@scene
def color_lights_and_camera_sees_an_image():
    shiny_things()
    by_light_path("Is Camera Ray", plain(0.8, 0.7, 0.6), textured)


@scene
def other_for_glossy_rays():
    """Light that Cycles draws from the sky is of no kind, so that none is drawn."""
    shiny_things()
    by_light_path("Is Glossy Ray", plain(0.5, 0.4, 0.3), plain(0.1, 0.2, 0.9))
    bpy.context.scene.world.cycles.sampling_method = "NONE"


@scene
def strength_by_light_path():
    """Through Math, for diffuse rays twice what others see, and for the camera's none."""
    shiny_things()
    tree = sky((0.3, 0.4, 0.5))
    path = add(tree, "LightPath")
    twice = add(tree, "Math", {"operation": "ADD"})
    tree.links.new(path.outputs["Is Diffuse Ray"], twice.inputs[0])
    tree.links.new(path.outputs["Is Reflection Ray"], twice.inputs[1])
    tree.links.new(twice.outputs[0], tree.nodes["Background"].inputs["Strength"])
    bpy.context.scene.camera.data.lens = 20
    bpy.context.scene.world.cycles.sampling_method = "NONE"


@scene
def color_nodes():
    """An RGB node, a blackbody's colour and a Math node, all constant."""
    things()
    tree = sky((1, 1, 1))
    color = add(tree, "RGB")
    color.outputs[0].default_value = 0.3, 0.5, 0.8, 1
    strength = add(tree, "Math", {"operation": "MULTIPLY"})
    strength.inputs[0].default_value, strength.inputs[1].default_value = 0.5, 1.6
    tree.links.new(color.outputs[0], tree.nodes["Background"].inputs["Color"])
    tree.links.new(strength.outputs[0], tree.nodes["Background"].inputs["Strength"])


@scene
def blackbody():
    things()
    tree = sky((1, 1, 1))
    tree.links.new(add(tree, "Blackbody", Temperature=3000.0).outputs[0], tree.nodes["Background"].inputs["Color"])


@scene
def without_nodes():
    """The colour in the world's panel, until nodes are always used."""
    things()
    world = bpy.data.worlds.new("Plain")
    world.color = 0.2, 0.4, 0.6
    if bpy.app.version < (5, 0):
        world.use_nodes = False
    bpy.context.scene.world = world


@scene
def negative():
    """It takes light away."""
    things()
    sky((0.1, 0.2, 0.3), -1.0)
    sun()


@scene
def image_unlinked():
    """Without coordinates the image lies along the world's axes."""
    things()
    tree = sky((1, 1, 1))
    texture = add(tree, "TexEnvironment", {"image": image("sky", pixels(64, 32), floats=True)})
    tree.links.new(texture.outputs["Color"], tree.nodes["Background"].inputs["Color"])


def mirror_ball_sky(width, height, **mapping):
    tree = sky((1, 1, 1))
    picture = image("ball", pixels(width, height), floats=True)
    texture = add(tree, "TexEnvironment", {"image": picture, "projection": "MIRROR_BALL"})
    if mapping:
        node = add(tree, "Mapping", Vector=add(tree, "TexCoord").outputs["Generated"])
        for name, value in mapping.items():
            node.inputs[name].default_value = value
        tree.links.new(node.outputs["Vector"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], tree.nodes["Background"].inputs["Color"])


@scene
def mirror_ball():
    things()
    mirror_ball_sky(64, 64)


@scene
def mirror_ball_stretched():
    """Of an image that is not square, turned so that the seam behind the ball is seen, too."""
    things()
    mirror_ball_sky(96, 64, Rotation=(0.4, -0.3, 2.9), Scale=(1, -1.6, 0.5))
    bpy.context.scene.camera.rotation_euler = 1.5, 0, 0.05
    bpy.context.scene.camera.data.lens = 20


@scene
def image_of_8_bits():
    things()
    tree = sky((1, 1, 1))
    values = np.clip(pixels(16, 8), 0, 1)
    texture = add(tree, "TexEnvironment", {"image": saved_image("eight-sky", values)})
    tree.links.new(texture.outputs["Color"], tree.nodes["Background"].inputs["Color"])


def hidden(*rays):
    for ray in rays:
        setattr(bpy.context.scene.world.cycles_visibility, ray, False)
    bpy.context.scene.camera.data.lens = 18


@scene
def not_by_diffuse_surfaces():
    """Seen by the camera and in what is glossy."""
    shiny_things()
    sky((0.2, 0.5, 0.9))
    sun()
    hidden("diffuse")


@scene
def not_by_the_camera():
    shiny_things()
    sky((0.2, 0.5, 0.9))
    hidden("camera")


@scene
def not_by_glossy():
    shiny_things()
    sky((0.2, 0.5, 0.9))
    hidden("glossy")


@scene
def image_not_by_diffuse_surfaces():
    image_sky(64, shiny_things, Rotation=(0.4, -0.3, 1.1))
    hidden("diffuse")


@scene
def image_not_by_glossy():
    image_sky(64, shiny_things, Rotation=(0.4, -0.3, 1.1))
    hidden("glossy")


@scene
def unseen_under_a_transparent_film():
    things()
    sky((0.2, 0.5, 0.9))
    hidden("camera")
    bpy.context.scene.render.film_transparent = True


@scene(bounces=3)
def max_bounces():
    """A window alone, which Cycles finds by its own samples alone: it lights first surfaces."""
    things()
    wall = floor()
    wall.location, wall.rotation_euler = (0, 3, 0), (math.pi / 2, 0, 0)
    tree = sky((1, 1, 1))
    window = np.zeros((32, 64, 3))
    window[22:26, 50:54] = 30, 20, 10  # before the wall, and above it
    texture = add(tree, "TexEnvironment", {"image": image("window", window, floats=True), "interpolation": "Closest"})
    tree.links.new(texture.outputs["Color"], tree.nodes["Background"].inputs["Color"])
    bpy.context.scene.world.cycles.max_bounces = 0


@scene(bounces=3)
def max_bounces_of_one_color():
    """Which has none."""
    things()
    sky((0.2, 0.5, 0.9))
    bpy.context.scene.world.cycles.max_bounces = 0


# ---- skies that are computed ---------------------------------------------------------------------------------------


def computed(color, build=things):
    """A sky whose colour `color(tree, coordinates)` gives; the camera sees some of it."""
    build()
    tree = sky((1, 1, 1), 0.7)
    tree.links.new(color(tree, add(tree, "TexCoord").outputs), tree.nodes["Background"].inputs["Color"])
    bpy.context.scene.camera.rotation_euler = 1.4, 0, 0.05
    bpy.context.scene.camera.data.lens = 22


def height(tree, coordinates):
    """From -1 below to 1 above."""
    return add(tree, "SeparateXYZ", Vector=coordinates["Generated"]).outputs["Z"]


@scene
def gradient():
    def color(tree, coordinates):
        up = add(tree, "MapRange", Value=height(tree, coordinates))
        up.inputs["From Min"].default_value = -1
        ramp = add(tree, "ValToRGB", Fac=up.outputs[0])
        ramp.color_ramp.elements[0].color, ramp.color_ramp.elements[1].color = (0.3, 0.2, 0.1, 1), (0.1, 0.3, 0.9, 1)
        ramp.color_ramp.elements.new(0.55).color = 1.5, 1.2, 0.9, 1
        return ramp.outputs["Color"]

    computed(color, shiny_things)


@scene
def clouds():
    def color(tree, coordinates):
        scaled = add(tree, "Mapping", Vector=coordinates["Generated"], Scale=(1, 1, 3))
        noise = add(tree, "TexNoise", Vector=scaled.outputs[0], Scale=1.5, Detail=4.0)
        return add(tree, "Gamma", Color=noise.outputs["Color"], Gamma=2.0).outputs[0]

    computed(color)


@scene
def image_behind_nodes():
    def color(tree, coordinates):
        picture = image("sky", pixels(64, 32), floats=True)
        texture = add(tree, "TexEnvironment", {"image": picture}, Vector=coordinates["Generated"])
        return add(tree, "HueSaturation", Color=texture.outputs[0], Hue=0.6, Saturation=1.2).outputs[0]

    computed(color)


@scene
def image_over_a_gradient():
    """Mixed by height, through a moved Mapping."""

    def color(tree, coordinates):
        moved = add(tree, "Mapping", Vector=coordinates["Generated"], Location=(0, 0, 0.3))
        texture = add(
            tree, "TexEnvironment", {"image": image("sky", pixels(64, 32), floats=True)}, Vector=moved.outputs[0]
        )
        share = add(tree, "Math", {"operation": "MULTIPLY_ADD", "use_clamp": True})
        tree.links.new(height(tree, coordinates), share.inputs[0])
        mix = add(tree, "MixRGB", Fac=share.outputs[0], Color1=(0.2, 0.4, 0.3, 1), Color2=texture.outputs[0])
        return mix.outputs[0]

    computed(color)


@scene
def other_coordinates():
    """The normal, the reflection, position and incoming direction of a sky, and what sees it from the camera."""

    def color(tree, coordinates):
        geometry = add(tree, "NewGeometry").outputs
        sums = [coordinates["Normal"], coordinates["Reflection"], coordinates["Camera"], geometry["Incoming"]]
        total = geometry["Position"]
        for one, scale in zip(sums, ((0.1, 0, 0.3), (0, 0.4, 0), (0.3, 0.2, 0.1), (-0.2, 0.3, 0.6))):
            part = add(tree, "VectorMath", {"operation": "MULTIPLY_ADD"})
            tree.links.new(one, part.inputs[0])
            part.inputs[1].default_value = scale
            tree.links.new(total, part.inputs[2])
            total = part.outputs[0]
        return add(tree, "VectorMath", {"operation": "ABSOLUTE"}, Vector=total).outputs[0]

    computed(color)


@scene
def without_a_surface():
    """What nodes tell of surfaces and objects."""

    def color(tree, _coordinates):
        outputs = [
            ("NewGeometry", "Parametric", 0.1),
            ("NewGeometry", "Pointiness", 0.2),
            ("NewGeometry", "Random Per Island", 0.2),
            ("Attribute", "Alpha", 0.1),
            ("ObjectInfo", "Random", 0.1),
            ("LightFalloff", "Quadratic", 0.001),
        ]
        if bpy.app.version >= (4, 0):
            outputs.append(("Tangent", "Tangent", 0.1))
        if bpy.app.version >= (5, 0):
            outputs.append(("NewGeometry", "Tangent", 0.1))
        else:
            outputs += [("LightFalloff", "Linear", 0.1), ("LightFalloff", "Constant", 0.1)]
        return weighted(tree, outputs)

    computed(color)


@scene
def attributes_of_view_layers():
    """And those of objects, of which there is none."""

    def color(tree, _coordinates):
        with_properties(bpy.context.scene)
        outputs = [(attribute("VIEW_LAYER", name), output, 0.2) for name, output in OF_LAYERS]
        return weighted(tree, [*outputs, (attribute("OBJECT", "none"), ALPHA, 0.2)])

    computed(color)


@scene
def ray_depth_of_the_camera():
    """All that is seen of the world."""
    tree = sky((1, 1, 1))
    camera()
    tree.links.new(weighted(tree, [("LightPath", "Ray Depth", 0.3)]), tree.nodes["Background"].inputs["Color"])


@scene
def window_coordinates():
    """A backdrop: each pixel of the image has its own colour, and directions beside it go on."""

    def color(tree, coordinates):
        wave = add(tree, "TexWave", Vector=coordinates["Window"], Scale=1.0)
        return wave.outputs["Color"]

    computed(color)


@scene
def computed_by_light_path():
    """The camera sees a pattern, in the light of another."""
    things()

    def checker(scale):
        def shader(tree):
            texture = add(tree, "TexChecker", Vector=add(tree, "TexCoord").outputs["Generated"], Scale=scale)
            return add(tree, "Background", Color=texture.outputs["Color"])

        return shader

    by_light_path("Is Camera Ray", checker(1.7), checker(5.0))


# ---- models of the sky ---------------------------------------------------------------------------------------------

OLD, NEW = (
    ("PREETHAM", "HOSEK_WILKIE", "NISHITA"),
    ("PREETHAM", "HOSEK_WILKIE", "SINGLE_SCATTERING", "MULTIPLE_SCATTERING"),
)


def model_of_sky(index, strength, build=shiny_things, **settings):
    """The model of this Blender that has the number, seen by the camera; returns its node."""
    build()
    tree = sky((1, 1, 1), strength)
    models = OLD if bpy.app.version < (5, 0) else NEW
    node = add(tree, "TexSky", {"sky_type": models[min(index, len(models) - 1)]})
    for name, value in settings.items():
        setattr(node, name, value)
    tree.links.new(node.outputs[0], tree.nodes["Background"].inputs["Color"])
    bpy.context.scene.camera.rotation_euler = 1.4, 0, 0.05
    bpy.context.scene.camera.data.lens = 22
    return node


def looked_at(node, **settings):
    """Obliquely."""
    tree = node.id_data
    mapping = add(tree, "Mapping", {"vector_type": "TEXTURE"}, Rotation=(0.4, -0.3, 0.7), **settings)
    tree.links.new(add(tree, "TexCoord").outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs[0], node.inputs["Vector"])


@scene
def sky_preetham():
    model_of_sky(0, 0.5, sun_direction=(0.5, 0.4, 0.6), turbidity=4.0)


@scene
def sky_preetham_oblique():
    looked_at(model_of_sky(0, 0.5, sun_direction=(0.5, 0.4, 0.6)))


@scene
def sky_hosek_wilkie():
    model_of_sky(1, 2.0, sun_direction=(-0.5, 0.4, 0.4), turbidity=3.0, ground_albedo=0.5)


@scene
def sky_atmosphere():
    model_of_sky(2, 0.2, sun_disc=False, sun_elevation=0.3, sun_rotation=0.8, altitude=500.0)


@scene
def sky_atmosphere_oblique():
    looked_at(model_of_sky(2, 0.2, sun_disc=False, sun_elevation=0.3, sun_rotation=0.8), Scale=(1.0, 1.5, 0.8))


@scene
def sky_with_a_sun():
    """Without a mirror, where the sun would be noise."""
    model_of_sky(2, 0.1, things, sun_elevation=0.7, sun_rotation=2.5, sun_size=0.03, air_density=1.5)


@scene(since=(4, 0))
def sky_with_the_smallest_sun():
    """Before, Cycles' density of directions within it is 1/(1 - cos) of single precision."""
    model_of_sky(2, 0.1, things, sun_elevation=0.7, sun_rotation=-2.5, sun_size=0.0, sun_intensity=0.3)


@scene
def sky_with_a_sun_at_the_horizon():
    model_of_sky(2, 0.3, things, sun_elevation=0.02, sun_rotation=2.5, sun_size=0.2)


@scene
def sky_with_a_sun_oblique():
    """By the map of the node itself: with a sun it has no coordinates."""
    node = model_of_sky(2, 0.1, things, sun_elevation=0.9, sun_rotation=2.5, sun_size=0.03)
    node.texture_mapping.rotation = 0.3, 0.2, 0.9


@scene
def sky_with_a_sun_past_the_zenith():
    model_of_sky(2, 0.1, things, sun_elevation=2.3, sun_rotation=1.0, sun_size=0.03)


@scene
def sky_of_two():
    """Mixed, one with a sun. (Of two suns Cycles aims at none.)"""
    node = model_of_sky(2, 0.1, things, sun_elevation=0.9, sun_rotation=2.5, sun_size=0.03)
    tree = node.id_data
    other = add(tree, "TexSky", {"sky_type": "HOSEK_WILKIE", "sun_direction": (0.5, 0.4, 0.6), "sun_disc": False})
    mix = add(tree, "MixRGB", Fac=0.3, Color1=node.outputs[0], Color2=other.outputs[0])
    tree.links.new(mix.outputs[0], tree.nodes["Background"].inputs["Color"])


@scene(since=(5, 0))
def sky_scattered_often():
    model_of_sky(3, 0.1, things, sun_elevation=0.2, sun_rotation=2.5, ozone_density=2.0)
