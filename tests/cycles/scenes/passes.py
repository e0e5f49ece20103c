# SPDX-License-Identifier: GPL-3.0-or-later
"""Passes beside the picture: what the camera meets first, colours, and light apart."""

import bpy
from stage import add, ball, box, camera, diffuse, lamp, material, scene, sheet, sky

DATA = "depth", "normal", "position", "uv", "object-index", "material-index"
COLORS = "diffuse-color", "glossy-color", "transmission-color"
FEW_PATHS = {"noise": 0.1, "why": "few paths make a pass of indirect light"}
LIGHT = tuple(f"{c}-{part}" for c in ("diffuse", "glossy", "transmission") for part in ("direct", "indirect"))


def shader(kind, settings=None, **inputs):
    made, tree, output = material(kind)
    tree.links.new(add(tree, kind, settings, **inputs).outputs[0], output.inputs["Surface"])
    return made


def room():
    """A floor that fills the picture, below a lamp and a sky."""
    sheet(diffuse((0.6, 0.5, 0.4)), size=12)
    lamp("AREA", (1, -1, 5), 300, target=(0, 0, 0), shape="RECTANGLE", size=4, size_y=3)
    sky((0.3, 0.4, 0.5))
    camera((0.6, -5, 5))


def with_indices(*things):
    for index, thing in enumerate(things, 3):
        thing.pass_index = index
        thing.data.materials[0].pass_index = 10 - index


def pane(alpha):
    made = sheet(shader("BsdfPrincipled", Alpha=alpha), size=1)
    made.location = 0, -0.5, 2
    return made


@scene(passes=DATA, samples=4, block=16)
def of_what_is_met_first():
    """A ball has no UVs."""
    room()
    with_indices(ball(diffuse()), box(diffuse(), (1.5, 0, 0.5), (0.5, 0.5, 0.5)))


@scene(passes=("position", "depth", "object-index", "material-index"), samples=1)
def through_the_centre_of_a_pixel():
    """Of one ray, so that there is no noise."""
    room()
    with_indices(ball(diffuse()), box(diffuse(), (1.5, 0, 0.5), (0.5, 0.5, 0.5)))


@scene(passes=DATA, samples=4, block=16)
def behind_what_is_hardly_there():
    room()
    with_indices(ball(diffuse()), pane(0.0))


@scene(passes=DATA, samples=4, block=16)
def of_what_is_opaque_enough():
    room()
    with_indices(ball(diffuse()), pane(0.6))


@scene(passes=("normal", "uv"), samples=256)
def behind_what_is_not_opaque_enough():
    """Position, depth and indices are of one sample, which the pane lets through by chance."""
    room()
    with_indices(ball(diffuse()), pane(0.3))


@scene(passes=("depth", "normal", "uv"), samples=64)
def of_another_threshold():
    room()
    with_indices(ball(diffuse()), pane(0.3))
    bpy.context.view_layer.pass_alpha_threshold = 0.2


@scene(passes=("position", "depth", "object-index"), samples=4)
def of_holes():
    """Before a surface, and before the sky: there is nothing there."""
    made, tree, output = material("Holes")
    holes = add(tree, "MixShader", Fac=add(tree, "TexChecker", Scale=3.0).outputs["Fac"])
    for kind, name in (("BsdfTransparent", 1), ("BsdfDiffuse", 2)):
        tree.links.new(add(tree, kind).outputs[0], holes.inputs[name])
    tree.links.new(holes.outputs[0], output.inputs["Surface"])
    with_indices(sheet(made, size=4), sheet(diffuse(), size=2))
    bpy.data.objects[-1].location.z = -1
    sky((0.3, 0.4, 0.5))
    camera((0.6, -5, 5))


def materials():
    room()
    for x, made in (
        (-1.6, shader("BsdfPrincipled", Base_Color=(0.8, 0.3, 0.1, 1), Roughness=0.4)),
        (0.0, shader("BsdfPrincipled", Base_Color=(0.9, 0.7, 0.3, 1), Metallic=1.0, Roughness=0.3)),
        (1.6, shader("BsdfGlass", Color=(0.7, 0.9, 0.8, 1), Roughness=0.3)),
    ):
        ball(made, (x, 0, 0.8), 0.75)


@scene(passes=COLORS)
def colors():
    materials()


@scene(passes=COLORS)
def colors_of_other_shaders():
    room()
    glossy = "BsdfGlossy" if bpy.app.version < (4, 0) else "BsdfAnisotropic"
    for x, made in (
        (-1.6, shader(glossy, Color=(0.8, 0.3, 0.1, 1), Roughness=0.4)),
        (0.0, shader("BsdfTranslucent", Color=(0.9, 0.7, 0.3, 1))),
        (1.6, shader("BsdfRefraction", Color=(0.7, 0.9, 0.8, 1), Roughness=0.3)),
    ):
        ball(made, (x, 0, 0.8), 0.75)


@scene(passes=COLORS, block=16)
def of_cloth():
    """Velvet counts as gloss in 3.4, sheen as what is diffuse."""
    room()
    ball(shader("BsdfVelvet" if bpy.app.version < (4, 0) else "BsdfSheen"), (-1, 0, 0.8), 0.75)
    ball(shader("BsdfPrincipled", **{"Sheen" if bpy.app.version < (4, 0) else "Sheen_Weight": 1.0}), (1, 0, 0.8), 0.75)


def multiscatter(kind, **inputs):
    return shader(kind, {"distribution": "MULTI_GGX"}, **inputs)


@scene(passes=COLORS)
def colors_of_multiscatter():
    room()
    glossy = "BsdfGlossy" if bpy.app.version < (4, 0) else "BsdfAnisotropic"
    through = "Transmission" if bpy.app.version < (4, 0) else "Transmission_Weight"
    for x, made in (
        (-1.8, multiscatter(glossy, Color=(0.8, 0.3, 0.1, 1), Roughness=0.7)),
        (-0.6, multiscatter("BsdfGlass", Color=(0.7, 0.9, 0.8, 1), Roughness=0.6)),
        (0.6, multiscatter("BsdfPrincipled", Base_Color=(0.9, 0.7, 0.3, 1), Metallic=0.5, Roughness=0.8)),
        (1.8, multiscatter("BsdfPrincipled", Base_Color=(0.5, 0.7, 0.3, 1), Roughness=0.8, **{through: 0.8})),
    ):
        ball(made, (x, 0, 0.6), 0.55)


@scene(passes=COLORS)
def colors_of_layers():
    room()
    old = bpy.app.version < (4, 0)
    coat = {"Clearcoat": 1.0, "Clearcoat_Roughness": 0.4} if old else {"Coat_Weight": 1.0, "Coat_Roughness": 0.4}
    sheen = {"Sheen": 1.0} if old else {"Sheen_Weight": 1.0}
    for x, made in (
        (-1.6, shader("BsdfPrincipled", Base_Color=(0.8, 0.3, 0.1, 1), Roughness=0.4, **coat)),
        (0.0, shader("BsdfPrincipled", Base_Color=(0.1, 0.2, 0.3, 1), Roughness=0.6, **sheen)),
        (1.6, shader("BsdfPrincipled", Base_Color=(0.7, 0.9, 0.8, 1), IOR=2.0, Alpha=0.7)),
    ):
        ball(made, (x, 0, 0.8), 0.75)


def bump(tree):
    made = add(tree, "Bump", Strength=0.6)
    tree.links.new(add(tree, "TexNoise", Scale=3.0).outputs[0], made.inputs["Height"])
    return made.outputs[0]


@scene(passes=("normal",), samples=64)
def of_what_closures_turn():
    """The normal is the mean of the closures', by their weights."""
    room()
    for x, kind in ((-1.6, "BsdfPrincipled"), (0.0, "BsdfGlass"), (1.6, "BsdfDiffuse")):
        made, tree, output = material(kind)
        both, turned = add(tree, "MixShader", Fac=0.7), add(tree, kind)
        tree.links.new(bump(tree), turned.inputs["Normal"])
        tree.links.new(add(tree, "BsdfDiffuse").outputs[0], both.inputs[1])
        tree.links.new(turned.outputs[0], both.inputs[2])
        tree.links.new(both.outputs[0], output.inputs["Surface"])
        ball(made, (x, 0, 0.8), 0.75)


@scene(passes=LIGHT[:4:2], samples=256, block=16)
def light_on_turned_normals():
    """Where lobes are more than techniques, a technique is of several components."""
    sheet(diffuse((0.6, 0.5, 0.4)), size=12)
    lamp("SUN", (1, -1, 5), 3, target=(0, 0, 0))
    camera((0.6, -5, 5))
    for x, turned in ((-1.2, False), (1.2, True)):
        made, tree, output = material("Turned" if turned else "Smooth")
        node = add(tree, "BsdfPrincipled", Roughness=0.5)
        if turned:
            tree.links.new(bump(tree), node.inputs["Normal"])
        tree.links.new(node.outputs[0], output.inputs["Surface"])
        ball(made, (x, 0, 0.9), 0.85)


def emitter():
    box(shader("Emission", Color=(1, 0.5, 0.2, 1), Strength=2.0), (0, 1.6, 0.4), (0.4, 0.4, 0.4))


@scene(passes=(*LIGHT[:4], "emission", "environment"), bounces=2, samples=256, block=16, **FEW_PATHS)
def light():
    room()
    emitter()
    ball(shader("BsdfPrincipled", Base_Color=(0.8, 0.3, 0.1, 1), Roughness=0.4), (-1.2, 0, 0.8), 0.75)
    ball(shader("BsdfPrincipled", Base_Color=(0.9, 0.7, 0.3, 1), Metallic=1.0, Roughness=0.5), (1, 0, 0.8), 0.75)


@scene(passes=("transmission-direct",), samples=256, block=16)
def light_that_passes_once():
    sky((0.3, 0.4, 0.5))
    camera((0.6, -5, 5))
    sheet(shader("BsdfRefraction", Color=(0.7, 0.9, 0.8, 1), Roughness=0.6), size=2)


@scene(passes=(*LIGHT[:4], "transmission-indirect"), bounces=3, samples=256, block=16, **FEW_PATHS)
def light_that_passes():
    """Of the sky alone: that of lamps through glass is too noisy to be compared."""
    materials()
    bpy.data.objects.remove(bpy.data.objects["Area"])
    ball(shader("BsdfTranslucent"), (0, -1.5, 0.5), 0.4)
