# SPDX-License-Identifier: GPL-3.0-or-later
"""View layers, collections and what objects are seen by."""

import bpy
from stage import ball, box, collection, diffuse, lamp, place, scene, stage

SAMPLES = 16  # of little noise


def things():
    """A box and a ball in collections of their own."""
    stage()
    return (
        collection("One", box(diffuse((0.8, 0.4, 0.2)), location=(-1.2, 0, 0.8), scale=(0.8, 0.8, 0.8)), linked=True),
        collection("Two", ball(diffuse((0.2, 0.5, 0.8)), location=(1.3, 0, 0.9), radius=0.9), linked=True),
    )


def layer_of(made):
    return bpy.context.view_layer.layer_collection.children[made.name]


@scene
def excluded():
    layer_of(things()[0]).exclude = True


@scene
def indirect_only():
    layer_of(things()[0]).indirect_only = True


@scene
def without_environment():
    things()
    bpy.context.scene.camera.data.lens = 18
    bpy.context.view_layer.use_sky = False


@scene
def without_surfaces():
    things()
    bpy.context.view_layer.use_solid = False


@scene
def material_override():
    things()
    bpy.context.view_layer.material_override = diffuse((0.3, 0.7, 0.3))


@scene(since=(4, 2))
def world_override():
    things()
    world = bpy.data.worlds.new("Other")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = 0.1, 0.2, 0.6, 1
    bpy.context.view_layer.world_override = world


@scene
def long_name():
    things()
    bpy.context.view_layer.name = "Characters in front, without the sky, for the grading of 4"


@scene
def odd_name():
    things()
    bpy.context.view_layer.name = 'Ébène: 50 % / "b".x 漢字'


@scene
def second_layer():
    """Two layers: the render shows the first one, which has other things than the second."""
    one, two = things()
    layer_of(one).exclude = True
    other = bpy.context.scene.view_layers.new("Other")
    other.layer_collection.children[two.name].exclude = True


@scene
def hidden_objects():
    stage()
    box(location=(-1.2, 0, 0.8)).hide_render = True
    other = ball(location=(1.3, 0, 0.9), radius=0.9)
    other.hide_set(True)  # in the viewport alone


@scene
def disabled_collection():
    things()[1].hide_render = True


def seen_by(**flags):
    stage()
    made = box(diffuse((0.8, 0.4, 0.2)), location=(-1, 0, 0.9), scale=(0.9, 0.9, 0.9))
    ball(location=(1.2, 0, 0.8), radius=0.8)
    for name, value in flags.items():
        setattr(made, name, value)


@scene
def not_by_the_camera():
    seen_by(visible_camera=False)


@scene
def not_by_shadows():
    seen_by(visible_shadow=False)


@scene(bounces=2)
def not_by_diffuse_rays():
    seen_by(visible_diffuse=False)


@scene
def lamp_not_by_diffuse_surfaces():
    stage()
    ball(location=(1.2, 0, 0.8), radius=0.8)
    lamp("POINT", (-1, -1, 2), 200, (1, 0.2, 0.2)).visible_diffuse = False


@scene
def other_scene():
    """Another scene's things are not in this one."""
    things()
    other = bpy.data.scenes.new("Other")
    made = place("Elsewhere", box().data)
    bpy.context.scene.collection.objects.unlink(made)
    other.collection.objects.link(made)


@scene
def local_collections():
    """An object in two collections, one of which is hidden, is shown."""
    one, two = things()
    one.objects.link(two.objects[0])
    two.hide_render = True


@scene
def background_set():
    """The things of another scene, which stand behind this one's."""
    things()
    other = bpy.data.scenes.new("Set")
    made = ball(diffuse((0.7, 0.7, 0.2)), location=(0, 1.5, 1), radius=1)
    bpy.context.scene.collection.objects.unlink(made)
    other.collection.objects.link(made)
    bpy.context.scene.background_set = other


@scene
def hidden_in_viewports():
    """What only viewports hide, is rendered."""
    stage()
    box(location=(-1.2, 0, 0.8)).hide_viewport = True
    ball(location=(1.3, 0, 0.9), radius=0.9).display_type = "WIRE"
