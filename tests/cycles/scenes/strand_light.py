# SPDX-License-Identifier: GPL-3.0-or-later
"""What is not diffuse on hair, curves and point clouds."""

from stage import add, camera, floor, material, scene, sky, sun

from scenes.strands import furry, loops, points, shape


def lit(kind, **inputs):
    """A material of one shader."""
    made, tree, output = material()
    tree.links.new(add(tree, f"Bsdf{kind}", **inputs).outputs[0], output.inputs["Surface"])
    return made


def lustrous(kind, form):
    """Nothing but a sky lights it, of which sharp things show what is hidden in a lamp's noise."""
    floor()
    sky((0.4, 0.5, 0.6))
    shape(form)
    furry(lit(kind, Roughness=0.3))
    camera()


@scene(bounces=6)
def hair_glossy():
    lustrous("Glossy", "RIBBONS")


@scene(bounces=6)
def hair_refraction():
    lustrous("Refraction", "RIBBONS")


@scene(bounces=6)
def hair_glass_tubes():
    lustrous("Glass", "THICK")


def shadows(form):
    """Of coloured transparent hair, which in Cycles are grey; of tubes twice as deep since Blender 3.6."""
    floor()
    sky((0, 0, 0))
    sun()
    camera()
    shape(form)
    furry(lit("Transparent", Color=(0.7, 0.8, 0.95, 1)))


@scene
def shadows_of_ribbons():
    shadows("RIBBONS")


@scene
def shadows_of_tubes():
    shadows("THICK")


@scene(bounces=6)
def curves_of_glass_ends():
    """Tubes whose open ends are seen, and hair whose strands lie within each other: from inside since Blender 3.6."""
    sky((0.4, 0.5, 0.6))
    shape("THICK")
    loops(0.15, lit("Refraction", Roughness=0.1))
    camera()


@scene(bounces=6)
def points_from_inside():
    points(lit("Refraction", Roughness=0.0), radius=0.3)
    sky((0.4, 0.5, 0.6))
