# SPDX-License-Identifier: GPL-3.0-or-later
"""Run by Blender: small diffuse scenes, each rendered once by WardMIS and with several seeds by Cycles.

blender --background --factory-startup --addons wardmis --python cycles_scenes.py -- FOLDER FIRST_SEED [SCENE ...]
writes FOLDER/SCENE-wardmis.exr and FOLDER/SCENE-cycles-N.exr. A light of one primary colour on white objects has a channel of the
image for itself: three lights are compared in one scene."""

import math
import sys
from pathlib import Path

import bpy
from mathutils import Matrix, Vector

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "blend")]

import numpy as np  # noqa: E402
from make_scenes import add_mesh, connect, set_up, sphere_mesh, square  # noqa: E402
from render_with import render  # noqa: E402

CYCLES_SEEDS = 12
WARDMIS_SAMPLES, CYCLES_SAMPLES = 256, 32  # Cycles': of each seed
RED, GREEN, BLUE = (1, 0, 0), (0, 1, 0), (0, 0, 1)


# ---- the stage ------------------------------------------------------------------------------------------------------


def diffuse(name, color):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.node_tree.nodes.clear()
    node = material.node_tree.nodes.new("ShaderNodeBsdfDiffuse")
    node.inputs["Color"].default_value = (*color, 1)
    connect(material, node)
    return material


def cube_mesh():
    vertices = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
    return vertices, [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


def stage(white=(0.8, 0.8, 0.8), grey=(0.4, 0.4, 0.4)):
    """A floor, a smooth sphere, and a box whose instances stand around it."""
    floor = add_mesh("Floor", *square(6), diffuse("Floor", white))
    # finely tessellated: under interpolated normals some samples point into a facet
    sphere = add_mesh("Sphere", *sphere_mesh(192, 96), diffuse("Ball", white), smooth=True)
    sphere.location, sphere.scale = (-0.9, 0.2, 1), (1, 0.8, 1)
    box = add_mesh("Box", *cube_mesh(), diffuse("Box", grey))
    group = bpy.data.collections.new("Boxes")
    group.objects.link(box)
    bpy.context.collection.objects.unlink(box)
    for i, (x, y, size) in enumerate(((1.3, 0.4, 0.6), (0.5, -1.4, 0.25), (2.2, -1.2, 0.35), (-1.5, 2.6, 0.9))):
        empty = bpy.data.objects.new(f"Instance {i}", None)
        empty.instance_type, empty.instance_collection = "COLLECTION", group
        empty.location, empty.rotation_euler, empty.scale = (x, y, size), (0, 0, 0.5 * i + 0.3), (size, size, size)
        bpy.context.collection.objects.link(empty)
    for thing in (floor, sphere, box):
        thing.cycles.shadow_terminator_geometry_offset = 0  # Cycles moves the shadow's ray away from smooth surfaces
    return camera()


def camera(location=(0.6, -7, 4), target=(0, 0, 0.5), lens=40):
    obj = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    aim(obj, location, target)
    obj.scale = 1, 2, 0.5  # means nothing
    obj.data.lens = lens
    bpy.context.collection.objects.link(obj)
    bpy.context.scene.camera = obj
    return obj.data


def aim(obj, location, target, turned=0.0):
    obj.location = location
    matrix = (Vector(target) - Vector(location)).to_track_quat("-Z", "Y").to_matrix()
    obj.rotation_euler = (matrix @ Matrix.Rotation(turned, 3, "Z")).to_euler()


def sky(radiance):
    world = bpy.data.worlds.new("World")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (*radiance, 1)
    bpy.context.scene.world = world
    return world.node_tree


def add_light(kind, color, energy, location, target=(0, 0, 0.5), turned=0.0, scale=(1, 1, 1), **settings):
    data = bpy.data.lights.new(kind.title(), kind)
    data.energy, data.color = energy, color
    if kind in {"POINT", "SPOT"}:
        data.shadow_soft_size = 0
    for name, value in settings.items():
        setattr(data, name, value)
    obj = bpy.data.objects.new(data.name, data)
    aim(obj, location, target, turned)
    obj.scale = scale
    bpy.context.collection.objects.link(obj)
    return obj


def daylight():
    """What the scenes of the cameras are lit by."""
    sky((0.3, 0.3, 0.3))
    add_light("SUN", (1, 0.9, 0.8), 2, (3, -2, 4), angle=0.0)


# ---- cameras --------------------------------------------------------------------------------------------------------


def shifted():
    data = stage()
    daylight()
    data.shift_x, data.shift_y = 0.12, -0.08


def orthographic():
    data = stage()
    daylight()
    data.type, data.ortho_scale, data.shift_x, data.shift_y = "ORTHO", 6, 0.05, 0.1


def depth_of_field():
    data = stage()
    daylight()
    data.dof.use_dof, data.dof.focus_distance, data.dof.aperture_fstop = True, 6, 0.05


def polygonal_lens():
    data = stage()
    daylight()
    data.dof.use_dof, data.dof.aperture_fstop = True, 0.05
    data.dof.focus_object = bpy.data.objects["Instance 1"]
    data.dof.aperture_blades, data.dof.aperture_rotation, data.dof.aperture_ratio = 5, 0.4, 1.6


def orthographic_lens():
    data = stage()
    daylight()
    data.type, data.ortho_scale = "ORTHO", 6
    data.dof.use_dof, data.dof.focus_distance, data.dof.aperture_fstop = True, 7, 2
    data.dof.aperture_blades = 3


def vertical_fit():
    data = stage()
    daylight()
    data.sensor_fit, data.sensor_height, data.sensor_width, data.shift_x = "VERTICAL", 20, 50, 0.05
    settings = bpy.context.scene.render
    settings.pixel_aspect_x = 1.5


def portrait():
    data = stage()
    daylight()
    data.lens, data.shift_y = 30, 0.1
    settings = bpy.context.scene.render
    settings.resolution_x, settings.resolution_y, settings.pixel_aspect_y = 64, 96, 1.25
    bpy.context.scene.cycles.pixel_filter_type, bpy.context.scene.wardmis.filter_type = "BOX", "box"


def horizontal_fit():
    data = stage()
    daylight()
    data.sensor_fit, data.sensor_width = "HORIZONTAL", 24
    settings = bpy.context.scene.render
    settings.resolution_x, settings.resolution_y = 64, 80
    bpy.context.scene.cycles.pixel_filter_type, bpy.context.scene.wardmis.filter_type = "GAUSSIAN", "gaussian"


def border():
    stage()
    daylight()
    settings = bpy.context.scene.render
    settings.resolution_x, settings.resolution_y, settings.resolution_percentage = 333, 222, 47  # 156 x 104
    settings.use_border = settings.use_crop_to_border = True
    settings.border_min_x, settings.border_max_x, settings.border_min_y, settings.border_max_y = 0.21, 0.83, 0.13, 0.76


# ---- lights ---------------------------------------------------------------------------------------------------------


def points():
    stage()
    add_light("POINT", RED, 300, (-2, -2, 4))
    add_light("POINT", GREEN, 300, (2, -3, 3), shadow_soft_size=0.1)
    add_light("POINT", BLUE, 300, (0.5, 1, 3), shadow_soft_size=0.8)


def spots():
    stage()
    add_light("SPOT", RED, 600, (-2, -3, 4), spot_size=0.7, spot_blend=0.3)
    add_light("SPOT", GREEN, 600, (2, -3, 3), spot_size=0.8, spot_blend=1.0, shadow_soft_size=0.3, scale=(1.4, 0.7, 1))
    add_light("SPOT", BLUE, 600, (1, 1, 4), spot_size=1.5, spot_blend=0.0, shadow_soft_size=0.1)


def suns():
    stage()
    add_light("SUN", RED, 2, (-2, -3, 4), angle=0)
    add_light("SUN", GREEN, 2, (3, -3, 3), angle=0.1)
    add_light("SUN", BLUE, 2, (1, 2, 4), angle=1.2)


def areas():
    stage()
    add_light("AREA", RED, 100, (-2, -3, 3), turned=0.4, shape="RECTANGLE", size=2, size_y=0.5, scale=(1, 1.5, 1))
    add_light("AREA", GREEN, 100, (3, -2, 3), shape="SQUARE", size=0.6, spread=1.2)
    add_light("AREA", BLUE, 100, (0, 2, 3.5), shape="SQUARE", size=1.5)


def round_areas():
    stage()
    add_light("AREA", RED, 100, (-2, -3, 3), shape="DISK", size=1)
    add_light("AREA", GREEN, 100, (3, -2, 3), turned=0.5, shape="ELLIPSE", size=2, size_y=0.7)
    add_light("AREA", BLUE, 100, (0, 2, 3.5), turned=0.5, shape="ELLIPSE", size=0.5, size_y=1.5, spread=0.8)


def overcast():
    stage()
    sky((0.9, 0.5, 0.2))


def sky_image():
    """A rotated picture: smooth, with a window that is much brighter."""
    stage()
    tree = sky((1, 1, 1))
    height, width = 32, 64
    v, u = (np.mgrid[0:height, 0:width] + 0.5) / np.array([height, width])[:, None, None]
    pixels = np.ones((height, width, 4), np.float32)
    pixels[..., 0], pixels[..., 1], pixels[..., 2] = v, 0.5 + 0.5 * np.sin(2 * math.pi * u), 0.3
    pixels[20:24, 10:16, :3] = 30, 20, 10
    image = bpy.data.images.new("sky", width, height, float_buffer=True)
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = image
    mapping, coordinates = tree.nodes.new("ShaderNodeMapping"), tree.nodes.new("ShaderNodeTexCoord")
    mapping.inputs["Rotation"].default_value = 0.4, -0.3, 1.1
    tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], tree.nodes["Background"].inputs["Color"])
    tree.nodes["Background"].inputs["Strength"].default_value = 0.7


def emissive_meshes():
    """Of small triangles: 3.4's Cycles loses up to 5 % of the light of large ones (held against Lambert's formula)."""
    stage()
    grid = np.linspace(-1, 1, 25)
    x, y = np.meshgrid(grid, grid)
    corners = np.arange(x.size).reshape(x.shape)
    quads = np.stack([corners[:-1, :-1], corners[:-1, 1:], corners[1:, 1:], corners[1:, :-1]], axis=-1).reshape(-1, 4)
    sheet = np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3), quads
    for name, mesh, color, strength, location, rotation, scale in (
        ("Sheet", sheet, (1, 0.6, 0.2), 8, (0.5, 0.5, 3.2), (0.5, 0.3, 0), (0.9, 0.5, 1)),
        ("Egg", sphere_mesh(48, 24), (0.1, 0.4, 1), 20, (2.6, -2, 1), (0.3, 0, 1), (0.2, 0.2, 0.4)),
    ):
        material = bpy.data.materials.new(name)
        material.use_nodes = True
        material.node_tree.nodes.clear()
        node = material.node_tree.nodes.new("ShaderNodeEmission")
        node.inputs["Color"].default_value, node.inputs["Strength"].default_value = (*color, 1), strength
        connect(material, node)
        lamp = add_mesh(name, *mesh, material)
        lamp.location, lamp.rotation_euler, lamp.scale = location, rotation, scale


# ---- indirect light -------------------------------------------------------------------------------------------------


def room():
    """Walls of two colours around the stage, one area light: five surface hits."""
    stage()
    for name, color, location, rotation in (
        ("Left", (0.8, 0.2, 0.2), (-3, 0, 0), (0, math.pi / 2, 0)),
        ("Right", (0.2, 0.7, 0.2), (3.2, 0, 0), (0, -math.pi / 2, 0)),
        ("Back", (0.7, 0.7, 0.7), (0, 3.6, 0), (math.pi / 2, 0, 0)),
        ("Ceiling", (0.7, 0.7, 0.7), (0, 0, 5), (math.pi, 0, 0)),
    ):
        wall = add_mesh(name, *square(6), diffuse(name, color))
        wall.location, wall.rotation_euler = location, rotation
    add_light("AREA", (1, 1, 1), 200, (0.5, -0.5, 4.5), (0.3, 0, 0), shape="RECTANGLE", size=2, size_y=1)
    scene = bpy.context.scene
    scene.wardmis.integrator, scene.wardmis.max_depth = "path", 5
    scene.cycles.max_bounces = scene.cycles.diffuse_bounces = 4


SCENES = {
    scene.__name__: scene
    for scene in (
        shifted, orthographic, depth_of_field, polygonal_lens, orthographic_lens, vertical_fit, portrait, horizontal_fit, border,
        points, spots, suns, areas, round_areas, overcast, sky_image, emissive_meshes, room,
    )
}  # fmt: skip


def make(name):
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    set_up(96, 64)
    scene = bpy.context.scene
    scene.cycles.samples, scene.cycles.sampling_pattern = CYCLES_SAMPLES, "SOBOL"
    scene.cycles.max_bounces = 0  # direct light
    scene.wardmis.samples, scene.wardmis.sampler = WARDMIS_SAMPLES, "independent"  # whose Variance pass has no bias
    scene.wardmis.integrator = "direct"
    scene.view_layers[0].name = "ViewLayer"
    SCENES[name]()


def main():
    folder, first_seed, *names = sys.argv[sys.argv.index("--") + 1 :]
    for name in names or SCENES:
        make(name)
        # of its own for each scene: with one seed the same block would deviate in all of them
        first = int(first_seed) + CYCLES_SEEDS * list(SCENES).index(name)
        render(f"{folder}/{name}-wardmis.exr", ["render.engine=WARDMIS", f"wardmis.seed={first}"])
        for seed in range(first, first + CYCLES_SEEDS):
            render(f"{folder}/{name}-cycles-{seed}.exr", ["render.engine=CYCLES", f"cycles.seed={seed}"])


if __name__ == "__main__":
    main()
