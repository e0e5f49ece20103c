# SPDX-License-Identifier: GPL-3.0-or-later
"""Shadow catchers: the camera sees of them what others take of their light."""

import bpy
from stage import add, ball, box, camera, diffuse, floor, lamp, material, mesh, scene, sky, square

SELDOM = {
    "transparent",
    "two",
}


def setting(transparent: bool = True):
    """Things on a floor that catches; returns the floor."""
    ground = floor()
    ground.is_shadow_catcher = True
    ball(diffuse((0.8, 0.3, 0.1)), location=(-0.9, 0.2, 1))
    box(location=(1.3, 0.4, 0.6), scale=(0.6, 0.6, 0.6))
    lamp("AREA", (1, -1, 5), 300, target=(0, 0, 0), shape="RECTANGLE", size=2, size_y=1)
    sky((0.3, 0.4, 0.5))
    camera()
    bpy.context.scene.render.film_transparent = transparent
    return ground


@scene
def transparent():
    setting()


@scene
def before_the_sky():
    setting(False)
    bpy.context.scene.camera.data.lens = 20


@scene(bounces=3)
def bounces():
    setting(False)


@scene
def lamp_of_the_picture_alone():
    """It lights things and catchers, but not the catchers that theirs are held against."""
    setting()
    lamp("POINT", (-2, -1.5, 3), 60).is_shadow_catcher = False


@scene(samples=96)
def seen_by_a_mirror():
    """Other rays meet them as anything else."""
    setting()
    made, tree, output = material("Mirror")
    tree.links.new(
        add(tree, "BsdfGlossy" if bpy.app.version < (4, 0) else "BsdfAnisotropic", Roughness=0.0).outputs[0],
        output.inputs["Surface"],
    )
    ball(made, location=(0.2, -1.2, 0.6), radius=0.6)


@scene
def behind_glass():
    setting()
    made, tree, output = material("Pane")
    tree.links.new(add(tree, "BsdfTransparent", Color=(0.8, 0.5, 0.3, 1)).outputs[0], output.inputs["Surface"])
    pane = mesh("Pane", *square(1.0), made)
    pane.location, pane.rotation_euler = (0, -2.2, 1.0), (1.4, 0, 0.1)


@scene
def light_of_a_mesh():
    """It is no catcher, so that it is not where they are alone."""
    setting()
    made, tree, output = material("Glow")
    tree.links.new(add(tree, "Emission", Strength=8.0).outputs[0], output.inputs["Surface"])
    ball(made, location=(0.3, -0.8, 0.4), radius=0.3)


@scene
def two():
    """Which shade one another."""
    setting()
    wall = mesh("Wall", *square(3), diffuse())
    wall.location, wall.rotation_euler = (0, 2.5, 1), (1.571, 0, 0)
    wall.is_shadow_catcher = True


@scene
def instanced():
    """Things of a collection, one of which catches."""
    setting(False)
    inner = bpy.data.collections.new("Inner")
    slab = box(diffuse((0.5, 0.6, 0.2)), location=(0, 0, 0.4), scale=(0.5, 0.5, 0.4))
    slab.is_shadow_catcher = True
    for collection in slab.users_collection:
        collection.objects.unlink(slab)
    inner.objects.link(slab)
    for x in (-2.2, 0.4):
        empty = bpy.data.objects.new("Many", None)
        empty.instance_type, empty.instance_collection, empty.location = "COLLECTION", inner, (x, -1.4, 0)
        bpy.context.scene.collection.objects.link(empty)


@scene
def by_their_instancer():
    setting(False).is_shadow_catcher = False
    inner = bpy.data.collections.new("Inner")
    slab = box(diffuse((0.5, 0.6, 0.2)), location=(0, 0, 0.4), scale=(0.5, 0.5, 0.4))
    for collection in slab.users_collection:
        collection.objects.unlink(slab)
    inner.objects.link(slab)
    empty = bpy.data.objects.new("Many", None)
    empty.instance_type, empty.instance_collection, empty.location = "COLLECTION", inner, (0.4, -1.4, 0)
    empty.is_shadow_catcher = True
    bpy.context.scene.collection.objects.link(empty)


@scene
def hole_too():
    setting().is_holdout = True
