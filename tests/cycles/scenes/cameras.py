# SPDX-License-Identifier: GPL-3.0-or-later
"""Cameras: their kinds, sensors, lenses, borders and pixels."""

import math

import bpy
from stage import (
    add,
    ball,
    box,
    camera,
    collection,
    daylight,
    diffuse,
    face_on,
    feed,
    floor,
    instance,
    painted,
    place,
    scene,
    sheet,
)
from wardmis import compat

SAMPLES = 16  # of little noise
SELDOM = {
    "border_uncropped",
    "fisheye_equisolid",
    "mirror_ball_lens",
    "orthographic_lens",
}


def things():
    floor()
    ball(location=(-0.9, 0.2, 1))
    box(diffuse((0.4, 0.5, 0.6)), location=(1.3, 0.4, 0.6), scale=(0.6, 0.6, 0.6))
    box(diffuse((0.6, 0.3, 0.2)), location=(0.5, -1.4, 0.25), scale=(0.25, 0.25, 0.25))
    daylight()
    made = camera()
    made.scale = 1, 2, 0.5  # means nothing
    return made.data


@scene
def shifted():
    data = things()
    data.shift_x, data.shift_y = 0.12, -0.08


@scene
def orthographic():
    data = things()
    data.type, data.ortho_scale, data.shift_x, data.shift_y = "ORTHO", 6, 0.05, 0.1


@scene
def seen_by_a_spot():
    """An active camera that is none has a lens of its own."""
    things()
    stage = bpy.context.scene
    spot = bpy.data.objects.new("Spot", bpy.data.lights.new("Spot", "SPOT"))
    stage.collection.objects.link(spot)
    spot.location, spot.rotation_euler = stage.camera.location, stage.camera.rotation_euler
    spot.data.energy, spot.data.spot_size = 50, 0.9
    stage.camera = spot


@scene
def depth_of_field():
    data = things()
    data.dof.use_dof, data.dof.focus_distance, data.dof.aperture_fstop = True, 6, 0.05


@scene
def polygonal_lens():
    data = things()
    data.dof.use_dof, data.dof.aperture_fstop = True, 0.05
    data.dof.focus_object = bpy.data.objects["Ball"]
    data.dof.aperture_blades, data.dof.aperture_rotation, data.dof.aperture_ratio = 5, 0.4, 1.6


@scene
def orthographic_lens():
    data = things()
    data.type, data.ortho_scale = "ORTHO", 6
    data.dof.use_dof, data.dof.focus_distance, data.dof.aperture_fstop = True, 7, 2
    data.dof.aperture_blades = 3


@scene
def vertical_fit():
    data = things()
    data.sensor_fit, data.sensor_height, data.sensor_width, data.shift_x = "VERTICAL", 20, 50, 0.05
    bpy.context.scene.render.pixel_aspect_x = 1.5


@scene
def portrait():
    data = things()
    data.lens, data.shift_y = 30, 0.1
    settings = bpy.context.scene.render
    settings.resolution_x, settings.resolution_y, settings.pixel_aspect_y = 48, 72, 1.25


@scene
def horizontal_fit():
    data = things()
    data.sensor_fit, data.sensor_width = "HORIZONTAL", 24
    bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y = 48, 60


@scene
def border():
    things()
    settings = bpy.context.scene.render
    settings.resolution_x, settings.resolution_y, settings.resolution_percentage = 233, 152, 47
    settings.use_border = settings.use_crop_to_border = True
    settings.border_min_x, settings.border_max_x, settings.border_min_y, settings.border_max_y = 0.21, 0.83, 0.13, 0.76


@scene
def border_and_window_coordinates():
    """These are of the whole frame, on surfaces and in the sky."""
    face_on()
    sheet(painted(lambda tree: add(tree, "TexCoord").outputs["Window"]), size=1.2)
    tree = bpy.context.scene.world.node_tree
    feed(tree, tree.nodes["Background"].inputs["Color"], add(tree, "TexCoord").outputs["Window"])
    settings = bpy.context.scene.render
    settings.use_border = settings.use_crop_to_border = True
    settings.border_min_x, settings.border_max_x, settings.border_min_y, settings.border_max_y = 0.1, 0.6, 0.3, 1


@scene
def clipped():
    data = things()
    data.clip_start, data.clip_end = 6.6, 9


@scene
def units():
    """The scale of the scene's units means nothing to a lens; a field of view does as its length."""
    data = things()
    bpy.context.scene.unit_settings.scale_length = 0.01
    data.lens_unit, data.angle = "FOV", math.radians(60)


@scene
def sheared():
    """The child of an object that is scaled unevenly."""
    things()
    made = bpy.context.scene.camera
    parent = place("Parent", None, (0, 0, 0), (0.2, 0.1, 0.4), (1, 1.5, 0.8))
    made.parent = parent


@scene
def of_an_instance():
    """What a collection's instance shows is not what the scene's camera is."""
    things()
    inner = bpy.data.objects.new("Inner", bpy.data.cameras.new("Inner"))
    instance(collection("Group", inner, box(location=(0, 2, 0.4), scale=(0.4, 0.4, 0.4))), (0, -1, 0))


@scene
def border_uncropped():
    """The rest of the frame stays empty."""
    things()
    settings = bpy.context.scene.render
    settings.use_border, settings.use_crop_to_border = True, False
    settings.border_min_x, settings.border_max_x, settings.border_min_y, settings.border_max_y = 0.25, 0.75, 0.25, 0.75


def panorama(kind, **settings):
    """In the midst of things, looking a little down; outside of what it sees the picture is black."""
    data = things()
    for x, y in ((-3, -3), (2.5, -4), (4, 2), (-4, 3)):
        box(diffuse((0.3 + 0.1 * x % 1, 0.5, 0.4)), location=(x, y, 0.7), scale=(0.5, 0.7, 0.7))
    made = bpy.context.scene.camera
    made.location, made.rotation_euler = (0.3, -2.4, 1.6), (1.3, 0.1, 0.2)
    data.type, data.clip_start = "PANO", 0.2
    owner = compat.panorama_settings(data)
    owner.panorama_type = kind
    for name, value in settings.items():
        setattr(owner, name, value)
    return data


@scene
def equirectangular():
    panorama("EQUIRECTANGULAR", latitude_min=-1.2, latitude_max=0.9, longitude_min=-2.5, longitude_max=3.0)


@scene
def fisheye_equidistant():
    data = panorama("FISHEYE_EQUIDISTANT", fisheye_fov=3.4)
    data.shift_x = 0.07


@scene
def fisheye_equisolid():
    data = panorama("FISHEYE_EQUISOLID", fisheye_lens=8.0, fisheye_fov=2.8)
    data.sensor_fit, data.sensor_height, data.shift_y = "VERTICAL", 26, -0.05
    bpy.context.scene.render.film_transparent = True


@scene
def fisheye_lens_polynomial():
    panorama("FISHEYE_LENS_POLYNOMIAL", fisheye_fov=1.1, fisheye_polynomial_k1=-0.03, fisheye_polynomial_k3=4e-5)
    bpy.context.scene.render.pixel_aspect_x = 1.3


@scene
def mirror_ball():
    panorama("MIRRORBALL")


@scene
def equiangular_cube_face():
    panorama("EQUIANGULAR_CUBEMAP_FACE")


@scene(since=(4, 3))
def central_cylindrical():
    panorama("CENTRAL_CYLINDRICAL", central_cylindrical_radius=1.5, central_cylindrical_range_v_max=0.8)


@scene
def panoramic_lens():
    data = panorama("EQUIRECTANGULAR", latitude_min=-1.0, latitude_max=0.6, longitude_min=-1.0, longitude_max=1.2)
    data.dof.use_dof, data.dof.focus_distance, data.dof.aperture_fstop = True, 2.5, 0.08
    data.dof.aperture_blades, data.dof.aperture_rotation, data.dof.aperture_ratio = 3, 0.5, 1.4


@scene
def mirror_ball_lens():
    data = panorama("MIRRORBALL")
    data.dof.use_dof, data.dof.focus_distance, data.dof.aperture_fstop = True, 2.5, 0.1
    data.dof.aperture_blades, data.dof.aperture_rotation = 3, 0.5
