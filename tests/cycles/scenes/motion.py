# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion blur: of objects, instances, shapes and the camera, and what the shutter does to it."""

import bpy
from stage import ball, box, camera, collection, daylight, diffuse, emitter, floor, instance, lamp, scene, sky, sun
from wardmis import compat

SELDOM = {
    "shutter_at_the_end",
    "shutter_at_the_start",
    "steps",
}

FRAME = 10


def move(made, path, *values, around=FRAME):
    """By steps of a frame, linearly, the middle one at the frame that is rendered."""
    first = around - len(values) // 2
    for frame, value in enumerate(values, first):
        setattr(made, path, value)
        made.keyframe_insert(path, frame=frame)
    action = made.id_data.animation_data.action
    curves = getattr(action, "fcurves", None)
    if curves is None:
        curves = [c for layer in action.layers for s in layer.strips for bag in s.channelbags for c in bag.fcurves]
    for curve in curves:
        for key in curve.keyframe_points:
            key.interpolation = "LINEAR"


def shutter(length=1.0, **settings):
    made = bpy.context.scene
    made.render.use_motion_blur, made.render.motion_blur_shutter = True, length
    for name, value in settings.items():
        setattr(compat.motion_blur_owner(made) if name == "motion_blur_position" else made.cycles, name, value)
    made.frame_set(FRAME)


def stage():
    floor()
    daylight()
    return camera()


def falling(of=None):
    made = box(of, location=(0, 0, 1.2), scale=(0.6, 0.6, 0.6))
    move(made, "location", (-1.6, 0, 0.8), (0, 0, 1.6), (1.6, 0.4, 0.8))
    return made


@scene
def objects():
    """One that moves, one that turns and grows, and one that stands."""
    stage()
    falling().location.z += 0.2
    turned = box(diffuse((0.7, 0.3, 0.2)), location=(0.4, -1.8, 0.7), scale=(0.9, 0.2, 0.5))
    move(turned, "rotation_euler", (0, 0, 0), (0.2, 0.3, 0.9), (0, 0, 1.8))
    move(turned, "scale", (0.9, 0.2, 0.5), (0.9, 0.3, 0.5), (1.0, 0.2, 0.3))
    ball(diffuse((0.2, 0.3, 0.7)), location=(-2, 1, 0.6), radius=0.6)
    shutter()


@scene
def steps():
    """A quick turn wants more of them."""
    stage()
    turned = box(diffuse((0.7, 0.3, 0.2)), location=(0, 0, 0.7), scale=(2.2, 0.2, 0.5))
    move(turned, "rotation_euler", (0, 0, -1.4), (0, 0, 0), (0, 0, 1.4))
    turned.cycles.motion_steps = 3
    shutter(2.0)


@scene
def switched_off():
    """An object's own motion, and an instancer's."""
    stage()
    falling().cycles.use_motion_blur = False
    inner = box(diffuse((0.3, 0.6, 0.3)), location=(0, 0, 0.4), scale=(0.4, 0.4, 0.4))
    empty = instance(collection("Group", inner), (0, -2, 0))
    move(empty, "location", (-1, -2, 0), (0, -2, 0), (1, -2, 0))
    empty.cycles.use_motion_blur = False
    shutter()


@scene
def instances():
    """Of two that share a mesh one moves; what an empty shows turns with it."""
    stage()
    one = falling()
    two = one.copy()
    two.animation_data_clear()
    two.location = (2.4, 1.5, 0.6)
    bpy.context.scene.collection.objects.link(two)
    inner = [box(diffuse((0.3, 0.6, 0.3)), location=(x, 0, 0.4), scale=(0.3, 0.3, 0.4)) for x in (-0.8, 0.8)]
    empty = instance(collection("Group", *inner), (0, -2, 0))
    move(empty, "rotation_euler", (0, 0, -0.7), (0, 0, 0), (0, 0, 0.7))
    shutter()


@scene
def shape_keys():
    """With the normals of a smooth surface."""
    stage()
    made = ball(diffuse((0.7, 0.3, 0.2)), location=(0, 0, 1.2), fineness=32)
    made.shape_key_add(name="Basis")
    key = made.shape_key_add(name="Long")
    for point in key.data:
        point.co.x *= 2.2
        point.co.z = 0.6 * point.co.z + 0.3 * point.co.x
    move(key, "value", 0, 0.3, 1)
    shutter()


@scene
def deforming_modifier():
    stage()
    made = box(diffuse((0.7, 0.3, 0.2)), location=(0, 0, 1), scale=(0.5, 0.5, 1))
    made.modifiers.new("Divide", "SUBSURF").subdivision_type = "SIMPLE"
    made.modifiers["Divide"].render_levels = made.modifiers["Divide"].levels = 4
    bend = made.modifiers.new("Bend", "SIMPLE_DEFORM")
    bend.deform_method, bend.deform_axis = "BEND", "X"
    for frame, angle in ((FRAME - 1, -1.0), (FRAME, 0.5), (FRAME + 1, 1.2)):
        bend.angle = angle
        bend.keyframe_insert("angle", frame=frame)
    other = made.copy()  # of its own shape, not blurred
    other.location.x = 2.5
    bpy.context.scene.collection.objects.link(other)
    other.cycles.use_deform_motion = False
    shutter()


@scene
def moving_camera():
    made = stage()
    box(diffuse((0.7, 0.3, 0.2)), location=(0.4, -1.8, 0.7), scale=(0.6, 0.4, 0.7))
    ball(location=(-1, 0.5, 1))
    x, y, z = made.location
    move(made, "location", (x - 0.5, y, z), (x, y, z + 0.2), (x + 0.5, y + 0.3, z))
    a, b, c = made.rotation_euler
    move(made, "rotation_euler", (a, b, c), (a, b, c), (a, b + 0.3, c + 0.05))
    shutter()


@scene
def zoom():
    made = stage()
    box(diffuse((0.7, 0.3, 0.2)), location=(0.4, -1.8, 0.7), scale=(0.6, 0.4, 0.7))
    move(made.data, "lens", 30, 40, 60)
    shutter()


@scene
def turning_panorama():
    made = stage()
    box(diffuse((0.7, 0.3, 0.2)), location=(0.4, -1.8, 0.7), scale=(0.6, 0.4, 0.7))
    falling()
    made.data.type = "PANO"
    compat.panorama_settings(made.data).panorama_type = "EQUIRECTANGULAR"
    made.location = (0.3, -3.4, 1.6)
    move(made, "rotation_euler", (1.4, 0, -0.3), (1.5, 0, 0), (1.6, 0, 0.3))
    shutter()


@scene
def shutter_at_the_start():
    stage()
    falling()
    shutter(0.7, motion_blur_position="START")


@scene
def shutter_at_the_end():
    move(stage().data, "lens", 35, 40, 45)
    falling()
    shutter(0.7, motion_blur_position="END")


@scene
def shutter_curve():
    stage()
    falling()
    curve = bpy.context.scene.render.motion_blur_shutter_curve
    curve.initialize()
    curve.curves[0].points[0].location = (0.0, 0.1)
    curve.curves[0].points[-1].location = (1.0, 0.8)
    curve.update()
    shutter()


@scene
def rolling_shutter():
    stage()
    falling()
    shutter(2.0, rolling_shutter_type="TOP", rolling_shutter_duration=0.3)


@scene
def moving_emitter():
    """Light of a mesh comes from where that is."""
    floor()
    sky((0.1, 0.1, 0.1))
    camera()
    box(diffuse((0.7, 0.3, 0.2)), location=(0.4, -1.8, 0.5), scale=(0.3, 0.3, 0.5))
    falling(emitter((8, 6, 4))).visible_camera = False  # its edge is the brightest noise
    shutter()


@scene
def moving_lamp():
    """Cycles takes a lamp where it is in the middle of the shutter's opening."""
    floor()
    sky((0.1, 0.1, 0.1))
    camera()
    box(diffuse((0.7, 0.3, 0.2)), location=(0.4, -1.8, 0.5), scale=(0.3, 0.3, 0.5))
    made = lamp("POINT", (0, 0, 2), 300)
    move(made, "location", (-1.5, 0, 2), (0, -0.3, 2), (1.5, 0, 2))
    shutter()


@scene(bounces=3)
def bounces():
    """A path has one time."""
    stage()
    sun((0.8, 0.9, 1))
    falling(diffuse((0.9, 0.5, 0.2)))
    box(diffuse((0.8, 0.8, 0.8)), location=(0, 1.5, 1.5), scale=(2.5, 0.1, 1.5), rotation=(0, 0, 0))
    shutter()
