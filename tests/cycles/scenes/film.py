# SPDX-License-Identifier: GPL-3.0-or-later
"""Exposure, transparency and filters of the film."""

import bpy
from stage import add, ball, box, collection, diffuse, lamp, material, mesh, scene, square, stage


def things():
    stage()
    box(diffuse((0.8, 0.4, 0.2)), location=(-1.2, 0, 0.8), scale=(0.8, 0.8, 0.8))
    ball(location=(1.3, 0, 0.9), radius=0.9)
    bpy.context.scene.camera.data.lens = 22  # the sky is in the picture
    return bpy.context.scene


def filtered(kind, width=1.5):
    made = things()
    made.cycles.pixel_filter_type, made.cycles.filter_width = kind, width


@scene
def box_filter():
    filtered("BOX")


@scene
def gaussian_filter():
    filtered("GAUSSIAN")


@scene
def wide_filter():
    filtered("BLACKMAN_HARRIS", 6)


@scene
def exposure():
    made = things()
    made.cycles.film_exposure = 2.5


@scene
def transparent():
    things().render.film_transparent = True


@scene
def view_transform():
    """An image file of linear numbers does not see the view's transform nor its exposure."""
    made = things()
    made.view_settings.exposure, made.view_settings.gamma = 1.0, 1.5


@scene
def holdout():
    """A hole in the picture, also where the sky is in it; shadows and light are as without it."""
    things()
    bpy.data.objects["Box"].is_holdout = True


@scene(bounces=2)
def holdout_transparent():
    """The light that it reflects stays."""
    made = things()
    made.render.film_transparent = True
    bpy.data.objects["Ball"].is_holdout = True
    bpy.data.objects["Box"].location.x = -0.4


@scene
def holdout_collection():
    things()
    held = collection("Held", bpy.data.objects["Box"], linked=True)
    bpy.context.view_layer.layer_collection.children[held.name].holdout = True


@scene
def holdout_before_a_lamp():
    """And behind one that the camera sees."""
    made = things()
    made.render.film_transparent = True
    bpy.data.objects["Box"].is_holdout = True
    lamp("AREA", (-1, -3, 2.2), 30, target=(-1, -7, 3), size=0.8).visible_camera = True


@scene
def holdout_shader():
    """By its share of the surface."""
    things()
    made, tree, output = material()
    mixed = add(tree, "MixShader", None)
    mixed.inputs[0].default_value = 0.3
    tree.links.new(add(tree, "Holdout").outputs[0], mixed.inputs[1])
    tree.links.new(add(tree, "BsdfDiffuse", Color=(0.2, 0.5, 0.3, 1)).outputs[0], mixed.inputs[2])
    tree.links.new(mixed.outputs[0], output.inputs["Surface"])
    bpy.data.objects["Box"].data.materials[0] = made
    bpy.data.objects["Ball"].data.materials[0], tree, output = material()
    tree.links.new(add(tree, "Holdout").outputs[0], output.inputs["Surface"])


def seen_through(*before):
    """Half-transparent sheets over a box, a hole and nothing: each of `before` makes a material's shader by its tree."""
    made = things()
    made.render.film_transparent = True
    # else its roulette ends paths behind the sheets, and those that are left count before a hole as they are: too little
    made.cycles.min_transparent_bounces = 8
    bpy.data.objects["Ball"].is_holdout = True
    for i, shader in enumerate(before):
        sheet, tree, output = material("Sheet")
        tree.links.new(shader(tree), output.inputs["Surface"])
        pane = mesh("Pane", *square(1.6), sheet)
        pane.location, pane.rotation_euler = (-0.4 + 0.5 * i, -1.4 - 0.4 * i, 2.0 - 0.3 * i), (1.4, 0, 0.1)


def mixed(tree, share, name, **inputs):
    """Of a transparent surface and another."""
    mix = add(tree, "MixShader", None)
    mix.inputs[0].default_value = share
    tree.links.new(add(tree, "BsdfTransparent", Color=(0.9, 0.8, 0.6, 1)).outputs[0], mix.inputs[1])
    tree.links.new(add(tree, name, **inputs).outputs[0], mix.inputs[2])
    return mix.outputs[0]


@scene(bounces=3, samples=64)
def transparent_behind_a_sheet():
    seen_through(lambda tree: mixed(tree, 0.4, "BsdfDiffuse", Color=(0.7, 0.3, 0.2, 1)))


@scene(bounces=3, samples=64)
def transparent_behind_two_sheets():
    seen_through(
        lambda tree: mixed(tree, 0.4, "BsdfDiffuse", Color=(0.7, 0.3, 0.2, 1)),
        lambda tree: add(tree, "BsdfPrincipled", Alpha=0.3).outputs[0],
    )


@scene(bounces=3)
def transparent_behind_a_glow():
    """Light beside what is transparent covers nothing."""

    def glow(tree):
        both = add(tree, "AddShader", None)
        tree.links.new(add(tree, "BsdfTransparent").outputs[0], both.inputs[0])
        tree.links.new(add(tree, "Emission", Color=(0.2, 0.5, 0.9, 1), Strength=0.5).outputs[0], both.inputs[1])
        return both.outputs[0]

    seen_through(glow)


@scene(bounces=3)
def transparent_behind_a_partial_hole():
    seen_through(lambda tree: mixed(tree, 0.5, "Holdout"))
