# SPDX-License-Identifier: GPL-3.0-or-later
"""The scenes of ./dev bench, in Blender: `blender --background --addons wardmis --python blend/bench_scenes.py -- DIR NAME...`

Those of blend/ as they are, by their own names, or with one thing changed, rooms of shaders that both renderers have alike, and those of which
there is a number of something, as in lamps-100."""

import math
import sys
from pathlib import Path

import bpy
import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE)]

from hidden_lamps import begin, box, plain  # noqa: E402
from parts import (  # noqa: E402
    add_area,
    add_camera,
    add_light,
    add_mesh,
    emitter,
    look_at,
    sphere_mesh,
    square,
)


def main(folder, names):
    for name in names:
        make(name)
        bpy.ops.wm.save_as_mainfile(filepath=str(Path(folder) / f"{name}.blend"), compress=True)


def make(name):
    kind, _, number = name.rpartition("-")
    if kind and number == "guided":  # the same, for Cycles' path guiding
        make(kind)
        bpy.context.scene.cycles.use_guiding = True
    elif kind in NUMBERED and number.isdigit():
        NUMBERED[kind](int(number))
    elif name in SCENES:
        SCENES[name]()
    else:
        opened(name)


def opened(name, integrator="path"):
    bpy.ops.wm.open_mainfile(filepath=str(HERE / f"{name}.blend"))
    bpy.context.scene.wardmis.integrator = integrator


def things():
    """A floor, and a ball and a box on it."""
    vertices, faces = square(6)
    add_mesh("Floor", vertices, faces, plain("Floor", (0.6, 0.55, 0.5), 0.6))
    vertices, faces = sphere_mesh(64, 32)
    add_mesh("Ball", np.add(vertices, (-1.2, 0, 1)), faces, plain("Ball", (0.7, 0.2, 0.1), 0.25), smooth=True)
    box("Box", (1.3, 0.3, 0.7), (0.7, 0.7, 0.7), plain("Box", (0.2, 0.4, 0.7), 0.4))


def veach_mesh_lights():
    """Spheres of the same light in place of the lamps."""
    opened("veach")
    for lamp in [o for o in bpy.data.objects if o.type == "LIGHT"]:
        radius, center = lamp.data.shadow_soft_size, lamp.location.copy()
        radiance = lamp.data.energy / (4 * math.pi**2 * radius**2)
        bpy.data.objects.remove(lamp)
        vertices, faces = sphere_mesh(24, 12)
        material = emitter("Light", radiance)
        add_mesh("Light", np.multiply(vertices, radius) + center, faces, material)


def walled(*boxes):
    """The things among walls: each a box, by its name, centre and half size."""
    begin()
    things()
    wall = plain("Wall", (0.7, 0.7, 0.7), 0.8)
    for name, center, scale in boxes:
        box(name, center, scale, wall)


def door():
    """A room without a lamp, lit through the door of another."""
    walled(
        ("Back", (0, 4, 2), (6, 0.1, 2)),
        ("Left", (-6, 0, 2), (0.1, 6, 2)),
        ("Front", (0, -6, 2), (6, 0.1, 2)),
        ("Ceiling", (0, 0, 4), (6, 6, 0.1)),
        ("Right, before the door", (3, -2.75, 2), (0.1, 3.25, 2)),
        ("Right, behind it", (3, 2.75, 2), (0.1, 1.25, 2)),
        ("Right of the other", (6, 0, 2), (0.1, 6, 2)),
    )
    add_area((4.5, 2.5, 3.8), (4.5, 2.5, 0), 1.0, 600)
    add_camera((-1, -5.5, 2.2), (0.2, 0.5, 0.9), 60)


def rooms():
    """One of sixteen rooms, with a lamp in each."""
    at = [8 * i - 12 for i in range(5)]
    walled(
        *((f"Across {x}", (x, 4, 2), (0.1, 16, 2)) for x in at),
        *((f"Along {y}", (4, y, 2), (16, 0.1, 2)) for y in at),
        ("Ceiling", (4, 4, 4), (16, 16, 0.1)),
        ("Floor", (4, 4, -0.2), (16, 16, 0.1)),
    )
    for x in range(-7, 20, 8):
        for y in range(-7, 20, 8):
            add_area((x, y, 3.8), (x, y, 0), 0.6, 100)
    add_camera((-2.5, -3.7, 2.2), (0.2, 0.5, 0.9), 65)


def window():
    """A room with a lamp, and a sun and a sky outside its window."""
    walled(
        ("Back", (0, 4, 2), (4, 0.1, 2)),
        ("Left", (-4, -1, 2), (0.1, 5, 2)),
        ("Front", (0, -6, 2), (4, 0.1, 2)),
        ("Ceiling", (0, -1, 4), (4, 5, 0.1)),
        ("Before the window", (4, -3.5, 2), (0.1, 2.5, 2)),
        ("Behind it", (4, 2.5, 2), (0.1, 1.5, 2)),
        ("Below it", (4, 0, 0.5), (0.1, 1, 0.5)),
        ("Above it", (4, 0, 3.5), (0.1, 1, 0.5)),
        ("Ground", (0, 0, -0.4), (200, 200, 0.1)),
    )
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.angle = 0.01
    add_light(sun, (0, 0, 0), 4).rotation_euler = (0, 1.0, 0.3)
    bpy.context.scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 1.0
    add_area((0, 2, 3.8), (0, 2, 0), 0.6, 60)
    add_camera((-2, -5.5, 2.2), (0.2, 0.5, 0.9), 60)


def area_lamps():
    """A hundred small ones in rows, each at another turn."""
    begin()
    things()
    random = np.random.default_rng(1)
    for x in np.linspace(-5, 5, 10):
        for y in np.linspace(-5, 5, 10):
            lamp = add_area((x, y, 4), (x, y, 0), 0.3, 8)
            lamp.rotation_euler = look_at((0, 0, 0), (*random.uniform(-0.7, 0.7, 2), -1))
    add_camera((0, -7, 3.2), (0, 0, 0.8), 50)


def image_sky():
    """A sun of some pixels in a sky that is blue above and brown below."""
    begin()
    things()
    width, height = 1024, 512
    up = np.linspace(-1, 1, height)[:, None, None]
    pixels = np.ones((height, width, 4), np.float32)
    pixels[..., :3] = np.where(up > 0, np.array((0.25, 0.4, 0.8)) * (1.2 - up), (0.12, 0.1, 0.07))
    pixels[360:366, 300:306, :3] = (4000, 3600, 3000)
    image = bpy.data.images.new("Sky", width, height, float_buffer=True)
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    tree = bpy.context.scene.world.node_tree
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = image
    background = tree.nodes["Background"]
    background.inputs["Strength"].default_value = 1.0
    tree.links.new(texture.outputs["Color"], background.inputs["Color"])
    add_camera((0, -7, 3.2), (0, 0, 0.8), 50)


def grid(side):
    """A square of side x side cells over [-1, 1]: its points, and its faces of three corners."""
    line = np.linspace(-1, 1, side + 1)
    points = np.stack([*(a.ravel() for a in np.meshgrid(line, line)), np.zeros((side + 1) ** 2)], axis=-1)
    first = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    other = first + side + 1
    return points, np.concatenate(
        [np.stack(f, axis=-1) for f in ((first, first + 1, other), (first + 1, other + 1, other))]
    )


def lamps(number):
    """So many of the same power on the whole, above things on a floor."""
    begin()
    things()
    side = round(math.sqrt(number))
    for x in (np.arange(side) + 0.5) / side * 10 - 5:
        for y in (np.arange(side) + 0.5) / side * 10 - 5:
            add_area((x, y, 4), (x, y, 0), 3 / side, 800 / side**2)
    add_camera((0, -7, 3.2), (0, 0, 0.8), 50)


def glowing(number):
    """A lamp of so many triangles over things on a floor."""
    begin()
    things()
    points, faces = grid(round(math.sqrt(number / 2)))
    add_mesh("Lamp", points * (1, 1, -1) + (0, 0, 4), faces, emitter("Light", 12))
    add_camera((0, -7, 3.2), (0, 0, 0.8), 50)


def under_a_sky():
    world = bpy.context.scene.world.node_tree.nodes["Background"]
    world.inputs["Strength"].default_value = 0.5
    add_area((-4, -4, 6), (0, 0, 0), 1, 600)
    add_camera((0, -7, 3.2), (0, 0, 0), 50)


def triangles(number):
    """Hills of so many."""
    begin()
    points, faces = grid(round(math.sqrt(number / 2)))
    x, y = points[:, 0], points[:, 1]
    points[:, 2] = 0.06 * (np.sin(9 * x) * np.cos(7 * y) + 0.4 * np.sin(61 * x + 3) * np.sin(53 * y))
    add_mesh("Hills", points * 5, faces, plain("Hills", (0.5, 0.5, 0.4), 0.5))
    under_a_sky()


def instances(number):
    """So many balls of 360 triangles in a slab."""
    begin()
    vertices, faces = sphere_mesh(20, 10)
    side = round(math.sqrt(number))
    ball = add_mesh("Ball", np.multiply(vertices, 4 / side), faces, plain("Ball", (0.6, 0.3, 0.2), 0.4), smooth=True)
    points = (grid(side - 1)[0] if side > 1 else np.zeros((1, 3))) * 5
    points[:, 2] = np.random.default_rng(1).uniform(-0.3, 0.3, len(points))
    places = add_mesh("Places", points, [], None)
    ball.parent, places.instance_type = places, "VERTS"
    under_a_sky()


NUMBERED = {"lamps": lamps, "glowing": glowing, "triangles": triangles, "instances": instances}
SCENES = {
    "veach-direct": lambda: opened("veach", "direct"),
    "teapot-direct": lambda: opened("teapot", "direct"),
    "veach-mesh-lights": veach_mesh_lights,
    "door": door,
    "rooms": rooms,
    "window": window,
    "area-lamps": area_lamps,
    "image-sky": image_sky,
}

if __name__ == "__main__":
    arguments = sys.argv[sys.argv.index("--") + 1 :]
    main(arguments[0], arguments[1:])
