# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the .blend files of this folder, always the same ones: blender --background --addons wardmis --python make_scenes.py

Run it with the oldest Blender that they shall open in. Names of scenes after `--` make only those.
"""

import math
import sys
from pathlib import Path

import addon_utils
import bpy
import numpy as np
from mathutils import Vector

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "addon")]

from hidden_lamps import ajar, caustic, lamps_inside  # noqa: E402
from parts import (  # noqa: E402
    add_area,
    add_camera,
    add_mesh,
    add_point,
    box_mesh,
    connect,
    emitter,
    empty_world,
    grey,
    set_up,
    sphere_mesh,
    square,
    ward,
)
from studio import studio  # noqa: E402
from teapot_patches import tessellate  # noqa: E402


def main():
    names = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    addon_utils.enable("wardmis")
    for name in names or SCENES:
        make(name)
        for screen in bpy.data.screens:
            for area in screen.areas:
                if area.type == "VIEW_3D":
                    area.spaces.active.region_3d.view_perspective = "CAMERA"
        bpy.ops.wm.save_as_mainfile(filepath=str(HERE / f"{name}.blend"), compress=True)


def make(name):
    """The scene in place of whatever is open."""
    # the factory's file without its objects; unlike read_factory_settings this leaves add-ons and preferences alone
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    SCENES[name]()


# ---- the scenes ----------------------------------------------------------------------------------------------------


def teapot():
    """The Utah teapot on a plane under the sky L = R cos(theta), R being the strength of the world's background."""
    set_up(768, 512)
    add_mesh("Teapot", *tessellate(24), ward("Glaze", (0.34, 0.2, 0.11), (0.5, 0.5, 0.5), 0.12, "ward"), smooth=True)
    add_mesh("Ground", *square(60), ward("Ground", (0.5, 0.5, 0.5), (0, 0, 0), 0.3, "ward"))
    add_camera((2.9, -11.2, 5.6), (0.2, 0, 1.38), 35)
    world = empty_world()
    texture = world.nodes.new("ShaderNodeTexEnvironment")
    texture.image = cosine_sky()
    world.links.new(texture.outputs["Color"], world.nodes["Background"].inputs["Color"])


def veach():
    """Veach's scene for multiple importance sampling: round lights of equal power, and plates of one material."""
    veach_scene([0.03] * 4)


def veach_glossiness():
    """The same with his plates of increasing roughness, the smoothest at the back."""
    veach_scene([0.005, 0.02, 0.05, 0.12])


def furnace():
    """Two spheres that see nothing but a sky of radiance 1: the diffuse one of albedo 1/2 must look 1/2 everywhere."""
    set_up(512, 256)
    diffuse = bpy.data.materials.new("Half")
    diffuse.use_nodes = True
    diffuse.node_tree.nodes.clear()
    node = diffuse.node_tree.nodes.new("ShaderNodeBsdfDiffuse")
    node.inputs["Color"].default_value = (0.5, 0.5, 0.5, 1)
    connect(diffuse, node)
    glossy = ward("Ward", (0.3, 0.3, 0.3), (0.5, 0.5, 0.5), 0.1, "ward-gmd")
    for x, name, material in ((-1.25, "Ward", glossy), (1.25, "Diffuse", diffuse)):
        # flat faces: a shading normal that differs from the surface's own would hide a part of the sky
        sphere = add_mesh(name, *sphere_mesh(128, 64), material)
        sphere.location.x = x
        sphere.visible_diffuse = sphere.visible_glossy = sphere.visible_shadow = False
        sphere.visible_transmission = sphere.visible_volume_scatter = False
    camera = add_camera((0, -10, 0), (0, 0, 0), 50)
    camera.data.type, camera.data.ortho_scale = "ORTHO", 5
    empty_world()


# ---- what is hard on the arithmetic: each scene holds one extreme, and is otherwise as plain as can be ---------------


def stiff_mirror():
    """A plate of alpha = 1e-4 under a pin-point light and a bright sky, and two posts that reflect nothing."""
    stiff()
    add_mesh("Plate", *square(4), ward("Mirror", BLACK, grey(0.8), 1e-4, "ward-gmd"))
    for number, (x, y, height) in enumerate(((-1.5, 0.5, 1.25), (1.25, 1.5, 1.75)), 1):
        post = add_mesh(f"Post {number}", *box_mesh(), ward(f"Post {number}", BLACK, BLACK, 0.3, "ward-gmd"))
        post.location, post.scale = (x, y, height / 2), (0.25, 0.25, height / 2)
    add_point((0.2, 1, 1), 3.0, 0.01)
    add_camera((0, -6, 2.5), (0, 0.5, 0.6), 45)
    empty_world().nodes["Background"].inputs["Color"].default_value = (0.5, 0.65, 0.9, 1)


def stiff_grazing():
    """Strips, smooth and rough in each variant, seen from 5 cm above them: far away at less than a tenth of a degree."""
    stiff()
    height, near, far, width = 0.05, 0.25, 40.0, 0.035  # the width at a distance of 1
    for number, (alpha, variant) in enumerate((a, v) for a in (0.01, 0.5) for v in ("ward", "ward-dur", "ward-gmd")):
        left, right = (number - 3) * width, (number - 2) * width
        corners = [(left * near, near, 0), (right * near, near, 0), (right * far, far, 0), (left * far, far, 0)]
        name = f"{variant} {alpha}"
        add_mesh(name, corners, [(0, 1, 2, 3)], ward(name, grey(0.1), grey(0.4), alpha, variant))
    add_area((0, 45, 2.5), (0, 0, 0), 2.0, 100.0)
    add_camera((0, 0, height), (0, 1, 0), 12)
    empty_world().nodes["Background"].inputs["Strength"].default_value = 0.5


def stiff_lights():
    """A light of a tenth of a millimetre and a million watts, and a dim one of 100 m2 that lights its shadows."""
    stiff()
    add_mesh("Floor", *square(8), ward("Floor", grey(0.4), grey(0.2), 0.2, "ward-gmd"))
    screen = [(-3, -1, 0), (1.5, -1, 0), (1.5, -1, 2.5), (-3, -1, 2.5)]
    add_mesh("Screen", screen, [(0, 1, 2, 3)], ward("Screen", (0.5, 0.2, 0.1), BLACK, 0.3, "ward-gmd"))
    add_area((-120, 160, 120), (0, 0, 0), 1e-4, 1e6)
    add_area((0, 0, 6), (0, 0, 0), 10.0, 1e3)
    add_camera((2, -9, 5), (0, -1.5, 0.5), 45)
    empty_world().nodes["Background"].inputs["Strength"].default_value = 0.0


def stiff_alphas():
    """Tiles of one plane: the smoothest and the roughest that the node allows, and what lies between."""
    stiff()
    for number, alpha in enumerate((1e-6, 1e-4, 1e-2, 0.1, 1.0, 10.0)):
        x, y = 1.5 * (number % 3 - 1), 0.75 - 1.5 * (number // 3)
        tile = add_mesh(f"Tile {alpha:g}", *square(0.7), ward(f"{alpha:g}", grey(0.1), grey(0.6), alpha, "ward-gmd"))
        tile.location = x, y, 0
    add_area((-1, 4, 2.5), (-1, 0, 0), 1.5, 30.0)
    add_camera((0, -5, 3.5), (0, 0, 0), 45)
    empty_world().nodes["Background"].inputs["Strength"].default_value = 0.3


def stiff_mesh():
    """Triangles without area, vertices at one place, edges of three faces; on a lamp of such triangles too."""
    stiff()
    add_mesh("Floor", *square(4), ward("Floor", grey(0.4), grey(0.2), 0.3, "ward-gmd"))
    wings = add_mesh("Wings", *broken_mesh(), ward("Wings", (0.2, 0.4, 0.5), grey(0.3), 0.15, "ward-gmd"))
    wings.location.z = 0.1
    smooth = add_mesh("Smooth", *broken_mesh(), ward("Smooth", (0.5, 0.4, 0.1), grey(0.3), 0.15, "ward-gmd"), True)
    smooth.location, smooth.rotation_euler.z = (-1.6, 0.3, 0.1), 0.8
    lamp = add_mesh("Lamp", *broken_mesh(), emitter("Lamp", 6.0))
    lamp.location, lamp.scale = (1.5, 0.5, 0.4), (0.4, 0.4, 0.4)
    add_camera((0.5, -5.5, 3), (0, 0, 0.5), 40)
    empty_world().nodes["Background"].inputs["Strength"].default_value = 0.2


def stiff_touching():
    """A panel and a cube of light that stand on the floor, with a wall, a box, and a second box of the same mesh."""
    court(1.0, (0, 0, 0))


def stiff_large():
    """The same, a thousand times as large and a million metres from the origin along every axis."""
    court(1024.0, (1e6, 1e6, 1e6))


def stiff_small():
    """The same, a millionth as large."""
    court(2.0**-20, (0, 0, 0))


def court(size, origin):
    """Every number is a multiple of size / 16, so that the places of the vertices hold in single precision."""
    stiff()
    origin = Vector(origin)

    def put(obj, center, scale):
        obj.location, obj.scale = origin + size * Vector(center), size * Vector(scale)

    panel = [(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)], [(0, 1, 2, 3)]
    put(add_mesh("Floor", *square(1), ward("Floor", grey(0.3), grey(0.3), 0.15, "ward-gmd")), (0, 0, 0), (2.5, 2.5, 1))
    put(add_mesh("Wall", *panel, ward("Wall", grey(0.5), BLACK, 0.3, "ward-gmd")), (-2.5, 2.5, 0), (5, 1, 2))
    put(add_mesh("Panel", *panel, emitter("Panel", 3.0)), (-1.75, 1, 0), (1.5, 1, 1))
    put(add_mesh("Cube", *box_mesh(), emitter("Cube", 2.0)), (1.25, -0.5, 0.25), (0.25, 0.25, 0.25))
    stone = add_mesh("Box", *box_mesh(), ward("Stone", (0.5, 0.25, 0.1), grey(0.2), 0.3, "ward-gmd"))
    put(stone, (0, 0, 0.5), (0.5, 0.5, 0.5))
    copy = bpy.data.objects.new("Small box", stone.data)
    bpy.context.collection.objects.link(copy)
    put(copy, (-0.75, -1, 0.25), (0.25, 0.25, 0.25))
    add_area(origin + size * Vector((1, 1, 2.5)), origin + size * Vector((1, 1, 0)), size, 10 * size**2)
    camera = add_camera(origin + size * Vector((0.5, -5.5, 3)), origin + size * Vector((0, 0, 0.5)), 45)
    camera.data.clip_start, camera.data.clip_end = size, 100 * size
    empty_world().nodes["Background"].inputs["Strength"].default_value = 0.1


SCENES = {
    "teapot": teapot,
    "veach": veach,
    "veach-glossiness": veach_glossiness,
    "studio": studio,
    "ajar": ajar,
    "caustic": caustic,
    "lamps-inside": lamps_inside,
    "furnace": furnace,
    "stiff-mirror": stiff_mirror,
    "stiff-grazing": stiff_grazing,
    "stiff-lights": stiff_lights,
    "stiff-alphas": stiff_alphas,
    "stiff-mesh": stiff_mesh,
    "stiff-touching": stiff_touching,
    "stiff-large": stiff_large,
    "stiff-small": stiff_small,
}
BLACK = (0.0, 0.0, 0.0)

# Veach's plates from the back to the front: (height, depth) of the upper and of the lower edge
PLATES = (
    ((-2.70651, -0.25609), (-2.08375, 0.526323)),
    ((-3.28825, -1.36972), (-2.83856, -0.476536)),
    ((-3.73096, -2.70046), (-3.43378, -1.74564)),
    ((-3.99615, -4.0667), (-3.82069, -3.08221)),
)
LIGHTS = ((-3.75, 1 / 30), (-1.25, 0.1), (1.25, 0.3), (3.75, 0.9))  # x, radius
LIGHT_POWER = 60.0  # W, of each


def veach_scene(alphas):
    set_up(768, 512)
    for number, (((z0, y0), (z1, y1)), alpha) in enumerate(zip(PLATES, alphas), 1):
        material = ward(f"Plate {number}", (0.07, 0.09, 0.13), (0.5, 0.5, 0.5), alpha, "ward")
        add_mesh(f"Plate {number}", [(-4, y0, z0), (4, y0, z0), (4, y1, z1), (-4, y1, z1)], [(0, 1, 2, 3)], material)
    room = ward("Room", (0.4, 0.4, 0.4), (0, 0, 0), 0.3, "ward")
    floor = -4.14615
    add_mesh("Floor", [(-10, -10, floor), (10, -10, floor), (10, 10, floor), (-10, 10, floor)], [(0, 1, 2, 3)], room)
    add_mesh("Wall", [(-10, 2, floor), (10, 2, floor), (10, 2, 15), (-10, 2, 15)], [(0, 1, 2, 3)], room)
    for x, radius in LIGHTS:
        add_point((x, 0, 0), LIGHT_POWER, radius).name = f"Light {radius:.2f}"
    add_camera((0, -15, 2), (0, 0, -2.5), 42)
    empty_world().nodes["Background"].inputs["Strength"].default_value = 0.0


# ---- their parts ---------------------------------------------------------------------------------------------------


def stiff():
    """The settings that the scenes of this kind share: samples that are independent, as their tests suppose."""
    set_up(512, 384)
    bpy.context.scene.wardmis.sampler = "independent"


def broken_mesh():
    """Five wings at one upright edge; each in two triangles that do not share their vertices, and triangles without area."""
    vertices, faces = [], []
    for angle in np.arange(5) * 2 * math.pi / 5:
        x, y = math.cos(angle), math.sin(angle)
        n = len(vertices)
        vertices += [(0, 0, 0), (x, y, 0), (x, y, 1), (0, 0, 0), (x, y, 1), (0, 0, 1), (x / 2, y / 2, 0.5), (x, y, 1)]
        # the second triangles all stand on the first wing's edge from 3 to 5; the last three have their corners on a line
        faces += [(n, n + 1, n + 2), (3, n + 4, 5), (n, n + 6, n + 2), (n + 2, n + 4, n + 7), (n + 3, n + 5, n)]
    return vertices, faces


def cosine_sky():
    """cos(theta) above the horizon, 0 below it, as an equirectangular EXR: beside the .blend files, and packed in them."""
    height = 256
    theta = (np.arange(height) + 0.5) / height * math.pi - math.pi / 2  # from straight down, the bottom row
    column = np.maximum(np.sin(theta), 0.0)
    pixels = np.ones((height, 2 * height, 4), np.float32)
    pixels[..., :3] = column[:, None, None]
    image = bpy.data.images.new("cosine-sky", 2 * height, height, float_buffer=True)
    image.pixels.foreach_set(pixels.ravel())
    settings = bpy.context.scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth, settings.exr_codec = "OPEN_EXR", "RGB", "32", "ZIP"
    image.save_render(str(HERE / "cosine-sky.exr"))
    settings.file_format = "PNG"
    bpy.data.images.remove(image)
    image = bpy.data.images.load(str(HERE / "cosine-sky.exr"))
    image.pack()
    image.filepath = image.packed_files[0].filepath = "//cosine-sky.exr"
    return image


if __name__ == "__main__":
    main()
