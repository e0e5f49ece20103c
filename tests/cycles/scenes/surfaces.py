# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' shaders: glass, alpha, gloss, Principled ..., each on a ball of its own before a checkered wall, under a lamp and a sky."""

import random

import numpy as np
from stage import add, ball, camera, face_on, image, lamp, material, mesh, scene, sheet, sky, sun
from wardmis import compat

COLUMNS, ROWS = 4, 3
SAMPLES, BLOCK = 24, 16  # a block is a ball's place in the image
SELDOM = {
    "indices",
    "metals",
    "principled_at_random_1",
    "principled_at_random_2",
    "principled_at_random_3",
    "principled_at_random_4",
    "principled_left",
    "principled_multiple",
    "principled_single",
    "several_lobes",
    "tangents",
    "rough_glass_multiple",
    "rough_refraction",
}
FURNACES, FURNACE_SAMPLES = {"gloss", "rough_glass", "principled_coat"}, 12  # what a sample has under a constant light
BOUNCES = 6
OLD = compat.CYCLES == 3
GLOSSY = "BsdfGlossy" if OLD else "BsdfAnisotropic"


def room():
    """A checkered wall behind y = 0, light from all around."""
    dark, tree, output = material("Wall")
    checks = add(tree, "TexChecker", Scale=9, Color1=(0.8, 0.75, 0.6, 1), Color2=(0.1, 0.15, 0.2, 1))
    tree.links.new(add(tree, "TexCoord").outputs["UV"], checks.inputs["Vector"])
    shader = add(tree, "BsdfDiffuse", Color=checks.outputs["Color"])
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    wall = sheet(dark, size=3)
    wall.location, wall.rotation_euler = (0, 1, 0), (1.5707964, 0, 0)
    structured_light()
    lamp("AREA", (-3, -5, 4), 350, (1, 0.9, 0.8), target=(0, 0, 0), size=6)


def constant_light():
    sky((1, 1, 1), 0.5)


def structured_light():
    """A sky that changes with direction."""
    v, u = (np.mgrid[0:8, 0:16] + 0.5) / np.array([8, 16])[:, None, None]
    pixels = np.stack([0.1 + 0.4 * v, 0.3 + 0.2 * np.sin(6.2831853 * u), 0.6 - 0.3 * v], axis=-1)
    world = sky((1, 1, 1))
    texture = add(world, "TexEnvironment", {"image": image("Sky", pixels, floats=True)})
    world.links.new(texture.outputs["Color"], world.nodes["Background"].inputs["Color"])


def on_balls(*builders, surroundings=room):
    """Of each shader that `builder(tree)` returns the socket of, at most 12, a ball; seen by an orthographic camera."""
    assert len(builders) <= COLUMNS * ROWS
    for number, build in enumerate(builders):
        of, tree, output = material()
        tree.links.new(build(tree), output.inputs["Surface"])
        made = ball(of, radius=0.42, fineness=40)
        made.location = number % COLUMNS - (COLUMNS - 1) / 2, 0, (ROWS - 1) / 2 - number // COLUMNS
        made.rotation_euler = 0.4, 0.5, 0.6
    surroundings()
    seen = camera((0, -6, 0), (0, 0, 0))
    seen.data.type, seen.data.ortho_scale = "ORTHO", 4


def balls(constant=None, **more):
    """Enters the shaders that a function lists twice: in the room, and under a constant light alone, where it shows how much of all
    light each gives back. `constant`: what is another there."""

    def enter(shaders):
        def furnace():
            on_balls(*shaders(), surroundings=constant_light)

        def in_room():
            on_balls(*shaders())

        in_room.__name__, furnace.__name__ = shaders.__name__, f"{shaders.__name__}_constant"
        if shaders.__name__ not in FURNACES:
            SELDOM.add(furnace.__name__)
        scene(**more)(in_room)
        scene(**{**more, "samples": FURNACE_SAMPLES, **(constant or {})})(furnace)
        return shaders

    return enter


def shader(kind, settings=None, **inputs):
    """Of one node. An input that this Blender's node lacks is an error, as is every other misspelt one."""
    return lambda tree: add(tree, kind, settings, **inputs).outputs[0]


def mixed(factor, first, second):
    """`factor`: a number, or what makes a socket."""

    def build(tree):
        node = tree.nodes.new("ShaderNodeMixShader")
        if callable(factor):
            tree.links.new(factor(tree), node.inputs[0])
        else:
            node.inputs[0].default_value = factor
        for at, part in enumerate((first, second), 1):
            if part is not None:
                tree.links.new(part(tree), node.inputs[at])
        return node.outputs[0]

    return build


def added(*parts):
    def build(tree):
        node = tree.nodes.new("ShaderNodeAddShader")
        for at, part in enumerate(parts):
            tree.links.new(part(tree), node.inputs[at])
        return node.outputs[0]

    return build


def rgba(r, g, b):
    return (r, g, b, 1)


AMBER, SEA, ROSE, WHITE = rgba(0.9, 0.7, 0.3), rgba(0.4, 0.8, 0.9), rgba(0.9, 0.4, 0.5), rgba(0.95, 0.95, 0.95)


# ---- glass ----------------------------------------------------------------------------------------------------------


def glass(distribution, roughness, **inputs):
    return shader("BsdfGlass", {"distribution": distribution}, Roughness=roughness, **inputs)


def refraction(distribution, roughness, **inputs):
    return shader("BsdfRefraction", {"distribution": distribution}, Roughness=roughness, **inputs)


@balls(bounces=BOUNCES)
def sharp_glass():
    return [
        glass("GGX", 0, IOR=1.5, Color=WHITE),
        glass("BECKMANN", 0, IOR=1.5, Color=AMBER),
        glass("MULTI_GGX", 0, IOR=1.1, Color=SEA),
        glass("GGX", 0, IOR=1.0, Color=ROSE),
        glass("GGX", 0, IOR=0.8, Color=WHITE),
        glass("GGX", 0, IOR=2.5, Color=WHITE),
        refraction("GGX", 0, IOR=1.5, Color=WHITE),
        refraction("BECKMANN", 0, IOR=1.2, Color=SEA),
        refraction("GGX", 0, IOR=0.9, Color=AMBER),
        refraction("GGX", 0, IOR=1.0, Color=ROSE),
        glass("SHARP", 0.5, IOR=1.3, Color=AMBER) if OLD else glass("GGX", 0.001, IOR=1.3, Color=AMBER),
        shader("BsdfTransparent", Color=SEA),
    ]


# a factor that keeps the energy, where Cycles 3.4 follows light from facet to facet
MANY_OF_3_4 = (
    {"within": 0.08, "why": "multiple reflection between facets is a factor, in Cycles 3.4 a walk"} if OLD else {}
)


@balls(bounces=BOUNCES)
def rough_glass():
    return [
        *(glass(d, r, IOR=1.45, Color=WHITE) for r in (0.15, 0.4, 0.8) for d in ("GGX", "BECKMANN")),
        glass("GGX", 0.3, IOR=0.8, Color=AMBER),
        glass("GGX", 0.5, IOR=2, Color=SEA),
        glass("BECKMANN", 1, IOR=1.1, Color=ROSE),
    ]


@balls(bounces=BOUNCES, samples=32, **MANY_OF_3_4 | ({"within": 0.12} if OLD else {}))
def rough_glass_multiple():
    """Of an index below 1 and a roughness of 0.8 it differs most."""
    return [
        *(glass("MULTI_GGX", r, IOR=ior, Color=WHITE) for r in (0.15, 0.4, 0.8) for ior in (1.45, 0.8)),
        glass("MULTI_GGX", 0.5, IOR=2, Color=SEA),
    ]


@balls(bounces=BOUNCES)
def rough_refraction():
    return [
        *(refraction(d, r, IOR=1.45, Color=WHITE) for r in (0.1, 0.3, 0.6, 0.9) for d in ("GGX", "BECKMANN")),
        refraction("GGX", 0.4, IOR=0.8, Color=AMBER),
        refraction("BECKMANN", 0.3, IOR=2, Color=SEA),
        refraction("GGX", 1, IOR=1.2, Color=ROSE),
        refraction("GGX", 0.4, IOR=1.0, Color=ROSE),
    ]


@balls(bounces=BOUNCES)
def indices():
    """From below that of air to that of gems."""
    return [kind("GGX", r, IOR=ior) for ior in (0.9, 1.05, 3) for kind in (glass, refraction) for r in (0, 0.4)]


# ---- transparency ---------------------------------------------------------------------------------------------------


def checked(tree):
    coordinates = add(tree, "TexCoord").outputs["Generated"]
    return add(tree, "TexChecker", Scale=5, Vector=coordinates).outputs["Fac"]


@scene(bounces=BOUNCES)
def alpha():
    """Whose shadows are coloured, and thrown through several."""
    paint, window = shader("BsdfDiffuse", Color=AMBER), shader("BsdfTransparent", Color=WHITE)
    pane = shader("BsdfTransparent", Color=ROSE)
    on_balls(
        mixed(0.3, window, paint),
        mixed(0.7, window, paint),
        mixed(0.5, pane, paint),
        pane,
        mixed(checked, window, paint),
        mixed(checked, pane, shader("BsdfTransparent", Color=SEA)),
        mixed(0.5, window, shader(GLOSSY, Roughness=0.3, Color=AMBER)),
        mixed(0.5, window, glass("GGX", 0, IOR=1.3)),
        added(shader("BsdfTransparent", Color=rgba(0.3, 0.4, 0.2)), shader("BsdfDiffuse", Color=rgba(0.2, 0.3, 0.5))),
        mixed(0.5, window, shader("Emission", Color=SEA, Strength=0.7)),
        mixed(0.5, window, shader("BsdfTranslucent", Color=SEA)),
        mixed(0.4, None, paint),
    )


@scene(bounces=BOUNCES)
def sheets():
    """Five of them behind each other, at an angle."""
    on_balls()
    for number in range(5):
        of, tree, output = material()
        window = mixed(0.35, shader("BsdfTransparent", Color=SEA), shader("BsdfDiffuse", Color=AMBER))
        tree.links.new(window(tree), output.inputs["Surface"])
        made = mesh("Sheet", [(-1, 0, -1), (1, 0, -1), (1, 0, 1), (-1, 0, 1)], [(0, 1, 2, 3)], of)
        made.location, made.rotation_euler = (0.25 * number - 0.5, 0.7 - 0.3 * number, 0.1 * number), (0.2, 0, 0.3)


def ray(output):
    return lambda tree: add(tree, "LightPath").outputs[output]


@scene(bounces=BOUNCES)
def light_path():
    """The usual tricks: no shadow, seen by the camera alone, light for some rays, glass without caustics."""
    paint, window = shader("BsdfDiffuse", Color=AMBER), shader("BsdfTransparent")
    on_balls(
        mixed(ray("Is Camera Ray"), window, paint),
        mixed(ray("Is Shadow Ray"), paint, window),
        mixed(ray("Is Camera Ray"), paint, window),
        mixed(ray("Is Shadow Ray"), glass("GGX", 0, IOR=1.5), shader("BsdfTransparent", Color=ROSE)),
        mixed(ray("Is Diffuse Ray"), paint, window),
        mixed(ray("Is Glossy Ray"), window, paint),
        mixed(ray("Is Transmission Ray"), glass("GGX", 0, IOR=1.2), shader("Emission", Color=SEA, Strength=0.5)),
        mixed(ray("Is Camera Ray"), shader("Emission", Color=ROSE, Strength=2), paint),
        mixed(ray("Is Reflection Ray"), shader(GLOSSY, Roughness=0.5, Color=WHITE), paint),
        mixed(ray("Is Singular Ray"), glass("GGX", 0, IOR=1.2), shader("BsdfDiffuse", Color=ROSE)),
        mixed(ray("Is Glossy Ray"), shader(GLOSSY, Roughness=0.2, Color=WHITE), paint),
        mixed(ray("Is Camera Ray"), shader("BsdfTranslucent", Color=SEA), shader("BsdfDiffuse", Color=ROSE)),
    )


# ---- reflection -----------------------------------------------------------------------------------------------------

REFLECTIONS = ("GGX", "BECKMANN", "MULTI_GGX", "ASHIKHMIN_SHIRLEY")


def glossy(distribution, roughness, anisotropy=0.0, rotation=0.0, color=WHITE, **inputs):
    if OLD and anisotropy == 0:
        return shader("BsdfGlossy", {"distribution": distribution}, Roughness=roughness, Color=color, **inputs)
    shape = {"Anisotropy": anisotropy, "Rotation": rotation}
    return shader(
        "BsdfAnisotropic", {"distribution": distribution}, Roughness=roughness, Color=color, **shape, **inputs
    )


@balls(bounces=2)
def gloss():
    return [*(glossy(d, r) for r in (0, 0.3, 0.7) for d in REFLECTIONS)]


@balls(bounces=2, samples=32)
def gloss_rough_along_one_axis():
    """By both axes together so smooth that 3.4 takes one mirror's direction, of facets that are rough along one."""
    return [
        *(glossy(d, 0.017, a) for d in ("GGX", "BECKMANN") for a in (0.99, -0.99)),
        glossy("MULTI_GGX", 0.03, 0.99),
        glossy("GGX", 0.1, 0.99),
    ]


@balls(bounces=2, samples=48)
def brighter_than_white():
    """Colours above 1: what is reflected more than once takes them as they are (since 4.0), a metal of the Principled shader is white at most."""
    bright = rgba(0.5, 1.7, 1)
    many = (
        []
        if OLD
        else [glossy("MULTI_GGX", r, color=bright) for r in (0.3, 0.6)] + [glass("MULTI_GGX", 0.5, Color=bright)]
    )
    return [
        *many,
        *(glossy("GGX", r, color=bright) for r in (0.3, 0.6)),
        *(principled(Base_Color=bright, Roughness=0.5, Metallic=m) for m in (1.0, 0.5, 0.0)),
    ]


ONE_AXIS = {"within": 0.1, "why": "Cycles 3.4 draws both axes of Beckmann by one roughness"} if OLD else {}


@balls(bounces=2, **ONE_AXIS)
def anisotropic_gloss():
    """In 3.4 without the walk among facets, which is up to 27 % off the factor; that is not explained."""
    reflections = [kind for kind in REFLECTIONS if not OLD or kind != "MULTI_GGX"]
    return [
        *(glossy(d, 0.4, 0.7) for d in reflections),
        *(glossy(d, 0.6, -0.8, 0.15, AMBER) for d in reflections),
        *(glossy(d, 0.3, 0.5, 0.25, SEA) for d in reflections),
    ]


@scene(bounces=2)
def tangents():
    """Of other axes, and of a normal of its own."""

    def along(axis):
        def build(tree):
            tangent = add(tree, "Tangent", {"direction_type": "RADIAL", "axis": axis}).outputs[0]
            return glossy("GGX", 0.4, 0.8, Tangent=tangent)(tree)

        return build

    def bumped(kind, **inputs):
        def build(tree):
            height = add(tree, "TexNoise", Scale=3, Vector=add(tree, "TexCoord").outputs["Object"]).outputs[0]
            normal = add(tree, "Bump", Strength=0.5, Distance=0.2, Height=height).outputs[0]
            return add(tree, kind, Normal=normal, **inputs).outputs[0]

        return build

    on_balls(
        along("X"),
        along("Y"),
        along("Z"),
        bumped(GLOSSY, Roughness=0.3),
        bumped("BsdfDiffuse"),
        bumped("BsdfGlass", Roughness=0),
        bumped("BsdfPrincipled", Roughness=0.3),
        added(
            shader("BsdfDiffuse", Color=rgba(0.3, 0.2, 0.1)), bumped(GLOSSY, Roughness=0.2, Color=rgba(0.5, 0.5, 0.5))
        ),
    )


def sheen(distribution, roughness, color=WHITE):
    return shader("BsdfSheen", {"distribution": distribution}, Color=color, Roughness=roughness)


@balls(bounces=2)
def diffuse_and_cloth():
    cloth = (
        [shader("BsdfVelvet", Color=ROSE, Sigma=sigma) for sigma in (0.05, 0.3, 0.6, 1)]
        if OLD
        else [sheen("ASHIKHMIN", 0.3, ROSE), *(sheen("MICROFIBER", r, ROSE) for r in (0.1, 0.4, 0.9))]
    )
    return [
        *(shader("BsdfDiffuse", Color=AMBER, Roughness=r) for r in (0, 0.2, 0.6, 1)),
        *cloth,
        shader("BsdfTranslucent", Color=SEA),
        mixed(0.4, shader("BsdfTranslucent", Color=SEA), shader("BsdfDiffuse", Color=AMBER, Roughness=0.5)),
        added(shader("BsdfDiffuse", Color=rgba(0.3, 0.2, 0.1)), glossy("BECKMANN", 0.3, color=rgba(0.5, 0.5, 0.4))),
        shader("Background", Color=SEA, Strength=0.8),
    ]


@scene
def normals_away():
    """Of matte shaders, from the camera, from the light or from both."""

    def turned(kind, normal, **inputs):
        def build(tree):
            told = add(tree, "CombineXYZ", **dict(zip("XYZ", normal))).outputs[0]
            return add(tree, kind, Normal=told, Color=AMBER, **inputs).outputs[0]

        return build

    cloth = ("BsdfVelvet", {"Sigma": 0.6}) if OLD else ("BsdfSheen", {"Roughness": 0.4})
    kinds = (("BsdfDiffuse", {}), ("BsdfDiffuse", {"Roughness": 1}), ("BsdfTranslucent", {}), cloth)
    normals = ((0.9, 0.3, 0.1), (-0.8, 0.6, 0.2), (0.3, -0.5, -0.8))
    on_balls(*(turned(kind, normal, **inputs) for normal in normals for kind, inputs in kinds))


@scene
def gloss_and_lamps_behind():
    """Of normals that see them, while the faces do not."""
    normals = ((0.7, 0.1, 0.6), (-0.6, 0.5, 0.6), (0.1, -0.8, 0.5))
    kinds = (
        glossy("GGX", 0.6),
        glossy("BECKMANN", 0.4),
        named(Roughness=0.5),
        glass("GGX", 0.5, IOR=1.3),
    )

    def at(normal, kind):
        def build(tree):
            made = kind(tree)
            told = add(tree, "CombineXYZ", **dict(zip("XYZ", normal))).outputs[0]
            tree.links.new(told, made.node.inputs["Normal"])
            return made

        return build

    for row, normal in enumerate(normals):
        for column, kind in enumerate(kinds):
            of, tree, output = material()
            tree.links.new(at(normal, kind)(tree), output.inputs["Surface"])
            made = sheet(of, size=0.48)
            made.location = column - 1.5, row - 1, 0
    face_on()
    sky((0.1, 0.1, 0.1))
    for place in ((-3, 2, -1), (4, 1, -1.5), (0, -4, -0.8)):
        lamp("POINT", place, 300)


@balls(bounces=2)
def several_lobes():
    """More of them than techniques."""
    layers = [glossy(d, r, color=rgba(0.25, 0.2, 0.15)) for d, r in (("GGX", 0.1), ("BECKMANN", 0.3), ("GGX", 0.6))]
    paint = shader("BsdfDiffuse", Color=SEA)
    return [
        added(layers[0], layers[1]),
        added(layers[0], added(layers[1], layers[2])),
        added(paint, added(layers[0], layers[2])),
        mixed(0.3, added(layers[0], layers[1]), added(layers[2], shader("BsdfTranslucent", Color=ROSE))),
        mixed(0.5, glass("GGX", 0, IOR=1.4), layers[2]),
        mixed(0.5, glass("GGX", 0.3, IOR=1.4), glossy("GGX", 0)),
        mixed(0.5, glossy("GGX", 0, color=AMBER), glossy("GGX", 0, color=SEA)),
        mixed(checked, glossy("GGX", 0.2), paint),
    ]


def metal(distribution, roughness, anisotropy=0.0):
    settings = {"distribution": distribution, "fresnel_type": "F82"}
    inputs = {"Base_Color": AMBER, "Edge_Tint": ROSE, "Anisotropy": anisotropy, "Rotation": 0.1}
    return shader("BsdfMetallic", settings, Roughness=roughness, **inputs)


@balls(bounces=2, since=(4, 3))
def metals():
    return [metal(d, r, a) for d in ("GGX", "MULTI_GGX") for r, a in ((0, 0), (0.2, 0), (0.5, 0), (1, 0), (0.5, 0.7))]


# ---- Principled -----------------------------------------------------------------------------------------------------


def principled(settings=None, **inputs):
    """Of names as in this Blender."""
    return shader("BsdfPrincipled", settings, **{"Base_Color": rgba(0.7, 0.4, 0.25), **inputs})


# of the old node and the new: what to set, for each name of ours
NAMES = {
    "level": ("Specular", "Specular_IOR_Level"),
    "transmission": ("Transmission", "Transmission_Weight"),
    "coat": ("Clearcoat", "Coat_Weight"),
    "coat_roughness": ("Clearcoat_Roughness", "Coat_Roughness"),
    "sheen": ("Sheen", "Sheen_Weight"),
    "emission": ("Emission", "Emission_Color"),
}


def named(**inputs):
    return principled(
        **{NAMES[name][0 if OLD else 1] if name in NAMES else name: value for name, value in inputs.items()}
    )


@balls(bounces=2)
def principled_base():
    return [
        named(),
        *(named(Roughness=r) for r in (0, 0.2, 1)),
        *(named(Metallic=m, Roughness=0.3) for m in (0.5, 1)),
        *(named(level=level, Roughness=0.3) for level in (0, 1)),
        *(named(Anisotropic=a, Metallic=1, Roughness=0.4, Anisotropic_Rotation=r) for a, r in ((0.8, 0), (0.5, 0.2))),
        named(emission=rgba(0.2, 0.4, 0.8), Emission_Strength=0.8),
        named(IOR=1.8, Roughness=0.3),
    ]


def beyond(**inputs):
    """With these as links, which sliders do not limit; the others, whose names begin with a capital, as ever."""

    def build(tree):
        own = {name: value for name, value in inputs.items() if not isinstance(value, list)}
        socket = named(**own)(tree)
        for name in inputs.keys() - own.keys():
            (value,) = inputs[name]
            number = tree.nodes.new("ShaderNodeValue")
            number.outputs[0].default_value = value
            input_name = (NAMES[name][0 if OLD else 1] if name in NAMES else name).replace("_", " ")
            tree.links.new(number.outputs[0], socket.node.inputs[input_name])
        return socket

    return build


@balls(bounces=BOUNCES, samples=32)
def principled_beyond_its_sliders():
    return [
        beyond(Metallic=1, Roughness=0.5, Anisotropic=[-0.5]),
        beyond(Metallic=1, Roughness=0.5, Anisotropic=[1.2]),
        beyond(transmission=0.5, Roughness=0.5, IOR=[-0.5]),
        beyond(transmission=[1.5], Roughness=0.3),
        beyond(Metallic=[1.5], Roughness=[-0.4]),
        beyond(Metallic=[-0.5], Roughness=[1.4]),
        beyond(level=[2.0], coat=[1.5], Roughness=0.6),
        beyond(level=[-1.0], coat=[-0.5], sheen=[-0.5]),
        beyond(Alpha=[1.5], sheen=[2.0]),
        beyond(Alpha=[-0.5]),
        beyond(coat=1, coat_roughness=[-0.4]),
        beyond(coat=1, coat_roughness=[1.5]),
    ]


@scene(bounces=2, block=8, samples=64)
def normals_of_other_lengths():
    """Of constants, up in the world; those of 3.4 count as long as they are."""

    def up(kind, length, **inputs):
        def build(tree):
            normal = add(tree, "CombineXYZ", Z=length).outputs[0]
            return add(tree, kind, Normal=normal, **inputs).outputs[0]

        return build

    def daylight():
        structured_light()
        sun((1, 0.9, 0.8), 4.0, angle=0.3)

    on_balls(
        up("BsdfDiffuse", 0.5),
        up("BsdfDiffuse", 1.0),
        up(GLOSSY, 0.5, Roughness=0.4),
        up("BsdfTranslucent", 0.5),
        up("BsdfGlass", 0.5, Roughness=0.4),
        up("BsdfDiffuse", 0.0),
        surroundings=daylight,
    )


@scene(bounces=2, block=8, samples=256)
def principled_of_an_upright_normal():
    """Both its diffuse and its glossy part see light that is below the surface; since 5.0 it is neither's, but for its own samples."""
    sky((0.4, 0.45, 0.5))
    of, tree, output = material()
    up = add(tree, "CombineXYZ", Z=1.0).outputs[0]
    tree.links.new(named(Roughness=0.4, Normal=up)(tree), output.inputs["Surface"])
    ball(of)
    camera()


GLOWS = {"emission": rgba(0.2, 0.4, 0.8), "Emission_Strength": 0.8}


@balls(bounces=2)
def principled_sheen():
    return [
        *(named(sheen=s) for s in (0.5, 1)),
        named(sheen=1, Metallic=0.4),
        named(sheen=1, Sheen_Tint=1.0 if OLD else ROSE),
        named(sheen=1, **GLOWS),
        named(Specular_Tint=1.0 if OLD else SEA, level=1),
        *([] if OLD else [named(sheen=1, Sheen_Roughness=r) for r in (0.1, 0.3, 1)]),
    ]


@balls(constant={"samples": 24}, bounces=2)
def principled_coat():
    return [
        *(named(coat=c, Roughness=0.7) for c in (0.5, 1)),
        named(coat=1, coat_roughness=0.4, Roughness=0.8),
        named(coat=1, coat_roughness=0, Metallic=1, Roughness=0.5),
        named(coat=1, Metallic=0.4),
        named(coat=1, sheen=1),
        named(coat=1, coat_roughness=0.2, **GLOWS),
        named(coat=0.7, Alpha=0.6, **GLOWS),
        named(coat=1, transmission=1, Roughness=0.3),
        *(
            []
            if OLD
            else [named(coat=1, Coat_Tint=AMBER), named(coat=1, Coat_IOR=2.0), named(coat=1, sheen=1, **GLOWS)]
        ),
    ]


@balls(bounces=BOUNCES)
def principled_glass():
    weight = NAMES["transmission"][0 if OLD else 1]
    return [
        *(named(transmission=1, Roughness=r) for r in (0, 0.3, 0.8)),
        principled({"distribution": "GGX"}, Roughness=0.5, **{weight: 1}),
        *([] if OLD else [principled({"distribution": "MULTI_GGX"}, Roughness=0.5, **{weight: 1})]),
        named(transmission=0.5, Roughness=0.2),
        named(transmission=1, IOR=1.1, Roughness=0),
        named(transmission=1, IOR=0.8, Roughness=0.2),
        named(transmission=0.7, Metallic=0.5, Roughness=0.4),
        named(Alpha=0.3),
        named(Alpha=0.6, **GLOWS),
        named(transmission=1, Roughness=0.1, Specular_Tint=0.7 if OLD else ROSE),
    ]


@balls(bounces=2)
def principled_single():
    """Without what facets reflect again."""
    return [
        *(principled({"distribution": "GGX"}, Roughness=r, Metallic=m) for r in (0.2, 0.5, 0.8, 1) for m in (0, 0.5, 1))
    ]


@balls(bounces=2, **MANY_OF_3_4)
def principled_multiple():
    multiple = {"distribution": "MULTI_GGX"}
    return [*(principled(multiple, Roughness=r, Metallic=m) for r in (0.2, 0.5, 0.8, 1) for m in (0, 0.5, 1))]


def random_settings(seed):
    """Of every input of the node; what is not supported is left as it comes."""
    left = ("Subsurface", "Thin", "Weight")
    distributions = ["GGX"] if OLD else ["GGX", "MULTI_GGX"]
    random_number = random.Random(seed)

    def build(tree):
        node = add(tree, "BsdfPrincipled", {"distribution": random_number.choice(distributions)})
        for socket in node.inputs:
            pick = random_number.random()
            if socket.name.startswith(left) or socket.type not in {"VALUE", "RGBA"}:
                continue
            if "IOR" in socket.name and "Level" not in socket.name:
                socket.default_value = 1 + pick
            elif socket.name == "Emission Strength":
                socket.default_value = 0.5 * pick if random_number.random() < 0.2 else 0
            elif socket.type == "RGBA":
                socket.default_value = [0.2 + 0.7 * random_number.random() for _ in range(3)] + [1]
            elif socket.name == "Alpha":
                socket.default_value = pick if random_number.random() < 0.2 else 1
            else:  # half of the layers are left out
                socket.default_value = pick if random_number.random() < 0.5 else socket.default_value
        return node.outputs[0]

    return build


def at_random(tens):
    def build():
        return map(random_settings, range(10 * tens, 10 * tens + 10))

    build.__name__ = f"principled_at_random_{tens}"
    balls(bounces=BOUNCES)(build)


for tens in range(5):
    at_random(tens)


def of_direction(name, **inputs):
    """A normal or a tangent of a node, on the input of this name."""

    def build(tree):
        if name == "Tangent":
            told = add(tree, "Tangent", {"direction_type": "RADIAL", "axis": "X"}).outputs[0]
        else:
            noise = add(tree, "TexNoise", Scale=3, Vector=add(tree, "TexCoord").outputs["Object"]).outputs[0]
            told = add(tree, "Bump", Strength=0.4, Distance=0.2, Height=noise).outputs[0]
        return named(**{name: told, **inputs})(tree)

    return build


@balls(bounces=BOUNCES)
def principled_left():
    """The inputs that no other scene changes."""
    weight, coat_normal = ("Transmission", "Clearcoat_Normal") if OLD else ("Transmission_Weight", "Coat_Normal")
    return [
        of_direction("Normal", Roughness=0.3),
        of_direction("Tangent", Anisotropic=0.8, Metallic=1, Roughness=0.4),
        *([] if OLD else [of_direction(coat_normal, coat=1, Roughness=0.7)]),
        *(named(IOR=ior, Roughness=0.3) for ior in (1.1, 3)),
        *(
            [
                principled({"distribution": "GGX"}, Roughness=0.2, Transmission_Roughness=r, **{weight: 1})
                for r in (0.3, 0.6)
            ]
            if OLD
            else [named(Diffuse_Roughness=r) for r in (0.5, 1)]
        ),
    ]
