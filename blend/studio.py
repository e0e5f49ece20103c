# SPDX-License-Identifier: GPL-3.0-or-later
"""A still life of Blender's own materials alone, which both renderers show by the same formulas: a coated teapot, a goblet of
glass, balls of brushed steel and of gold, a cloth with sheen, a table of wood, by the light of a sky, a lamp and two tubes."""

import math

import bpy
import numpy as np
from parts import add_area, add_camera, add_mesh, connect, emitter, empty_world, set_up, sphere_mesh, square
from teapot_patches import tessellate

# (radius, height) of the goblet: from the middle of its foot's underside outside and up, and down inside to the bowl's bottom
FOOT = ((0, 0), (0.62, 0), (0.66, 0.03), (0.6, 0.08), (0.2, 0.14), (0.09, 0.3), (0.08, 0.85), (0.13, 1.0))
BOWL = ((0.42, 1.16), (0.62, 1.45), (0.68, 1.8), (0.62, 2.2), (0.58, 2.36), (0.55, 2.36))
INSIDE = ((0.58, 2.2), (0.635, 1.8), (0.58, 1.47), (0.38, 1.22), (0, 1.12))


def studio():
    set_up(768, 512)
    coated = principled("Coated plastic", {"Base Color": (0.5, 0.02, 0.02, 1), "Roughness": 0.5, "Clearcoat": 1.0})
    put(add_mesh("Teapot", *tessellate(16), coated, smooth=True), (-1.0, 1.3, 0), 0.8, turn=0.5)
    put(add_mesh("Goblet", *turned(smoothed(FOOT + BOWL + INSIDE, 6), 64), glass(), smooth=True), (1.9, -1.2, 0))
    steel = {"Base Color": (0.56, 0.57, 0.58, 1), "Metallic": 1.0, "Roughness": 0.35, "Anisotropic": 0.8}
    put(add_mesh("Steel ball", *sphere_mesh(64, 32), principled("Brushed steel", steel), smooth=True), (3.4, 1.9, 1.0))
    gold = principled("Gold", {"Base Color": (1.0, 0.72, 0.3, 1), "Metallic": 1.0, "Roughness": 0.15})
    put(add_mesh("Gold ball", *sphere_mesh(64, 32), gold, smooth=True), (0.45, -1.9, 0.45), 0.45)
    sheen = principled("Cloth", {"Base Color": (0.03, 0.07, 0.2, 1), "Roughness": 0.9, "Specular": 0.2, "Sheen": 1.0})
    put(add_mesh("Cloth", *cloth(80), sheen, smooth=True), (-1.85, -1.6, 0), turn=0.35)
    add_mesh("Table", *square(9), wood())
    for name, x in (("Left tube", -6.0), ("Right tube", 6.5)):
        put(add_mesh(name, *turned(((0.12, 0), (0.12, 4.5)), 24), emitter(name, 6.0)), (x, 1.5, 0.6))
    add_area((-2.5, -3.0, 7.0), (0, 0, 0.8), 3.0, 350.0).name = "Softbox"
    add_camera((1.2, -11.5, 4.6), (0.45, 0, 0.95), 39)
    sky()


def put(obj, location, scale=1.0, turn=0.0):
    obj.location, obj.scale, obj.rotation_euler.z = location, (scale, scale, scale), turn


# ---- shapes --------------------------------------------------------------------------------------------------------


def smoothed(curve, steps):
    """The points of a Catmull-Rom spline through those of `curve`, `steps` from each to the next."""
    p = np.array(curve, float)
    p = np.vstack([p[:1], p, p[-1:]])
    t = np.linspace(0, 1, steps, endpoint=False)[:, None]
    pieces = [
        b + t * ((c - a) / 2 + t * (a - 2.5 * b + 2 * c - d / 2 + t * (1.5 * (b - c) + (d - a) / 2)))
        for a, b, c, d in zip(p, p[1:], p[2:], p[3:])
    ]
    return np.vstack([*pieces, p[-1:]]) * (1, 1)


def turned(curve, segments):
    """The curve of (radius, height) turned about the z axis, faces to the right of its way; points on the axis once each."""
    radius, height = np.array(curve, float).T
    phi = np.linspace(0, 2 * math.pi, segments, endpoint=False)
    x, y, z = np.broadcast_arrays(radius[:, None] * np.cos(phi), radius[:, None] * np.sin(phi), height[:, None])
    index = np.arange(x.size).reshape(x.shape)
    index[radius < 1e-9] = index[radius < 1e-9][:, :1]
    right = np.roll(index, -1, axis=1)
    quads = np.stack([index[:-1], right[:-1], right[1:], index[1:]], axis=-1).reshape(-1, 4)
    used, quads = np.unique(quads, return_inverse=True)
    return np.stack([x, y, z], axis=-1).reshape(-1, 3)[used], quads.reshape(-1, 4)


def cloth(steps):
    """A square napkin that lies in soft folds."""
    u, v = np.meshgrid(np.linspace(-1, 1, steps + 1), np.linspace(-1, 1, steps + 1))
    folds = 0.17 * np.sin(5 * u + 2 * np.sin(2 * v)) + 0.1 * np.sin(7 * v + 2 * u) + 0.06 * np.sin(12 * u * v + v)
    vertices = np.stack([1.35 * u + 0.08 * np.sin(3 * v), 1.15 * v + 0.06 * np.sin(4 * u), folds + 0.33], axis=-1)
    index = np.arange(vertices[..., 0].size).reshape(u.shape)
    quads = np.stack([index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]], axis=-1)
    return vertices.reshape(-1, 3), quads.reshape(-1, 4)


# ---- materials -----------------------------------------------------------------------------------------------------


def new_material(name):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.node_tree.nodes.clear()
    return material, material.node_tree.nodes.new, material.node_tree.links.new


def principled(name, inputs):
    material, node, _ = new_material(name)
    surface = node("ShaderNodeBsdfPrincipled")
    for socket, value in inputs.items():
        surface.inputs[socket].default_value = value
    connect(material, surface)
    return material


def glass():
    material, node, _ = new_material("Glass")
    surface = node("ShaderNodeBsdfGlass")
    surface.inputs["IOR"].default_value, surface.inputs["Roughness"].default_value = 1.5, 0.0
    connect(material, surface)
    return material


def wood():
    """Rings of a trunk whose axis lies along x, disturbed by noise, in boards that differ in tone; darker rings are rougher."""
    material, node, link = new_material("Wood")
    place, stretch = node("ShaderNodeTexCoord"), node("ShaderNodeMapping")
    stretch.inputs["Scale"].default_value = (0.08, 1.0, 1.0)
    stretch.inputs["Location"].default_value = (0.0, 0.4, 0.7)
    noise, rings = node("ShaderNodeTexNoise"), node("ShaderNodeTexWave")
    noise.inputs["Scale"].default_value, noise.inputs["Detail"].default_value = 2.5, 6.0
    rings.wave_type, rings.bands_direction = "BANDS", "Y"
    rings.inputs["Scale"].default_value, rings.inputs["Distortion"].default_value = 0.8, 11.0
    rings.inputs["Detail"].default_value, rings.inputs["Detail Scale"].default_value = 3.0, 1.2
    tone, roughness, mix = node("ShaderNodeValToRGB"), node("ShaderNodeMapRange"), node("ShaderNodeMixRGB")
    tone.color_ramp.elements[0].color = (0.13, 0.055, 0.022, 1)
    tone.color_ramp.elements[1].color = (0.36, 0.19, 0.085, 1)
    roughness.inputs["To Min"].default_value, roughness.inputs["To Max"].default_value = 0.5, 0.32
    mix.blend_type, mix.inputs["Fac"].default_value = "MULTIPLY", 0.6
    surface = node("ShaderNodeBsdfPrincipled")
    link(place.outputs["Object"], stretch.inputs["Vector"])
    for texture in (noise, rings):
        link(stretch.outputs["Vector"], texture.inputs["Vector"])
    link(rings.outputs["Fac"], tone.inputs["Fac"])
    link(tone.outputs["Color"], mix.inputs["Color1"])
    link(noise.outputs["Fac"], mix.inputs["Color2"])
    link(mix.outputs["Color"], surface.inputs["Base Color"])
    link(rings.outputs["Fac"], roughness.inputs["Value"])
    link(roughness.outputs["Result"], surface.inputs["Roughness"])
    connect(material, surface)
    return material


def sky():
    """A clear sky with a low sun behind the camera, its disk left out, dim beside the lamp."""
    world = empty_world()
    texture = world.nodes.new("ShaderNodeTexSky")
    texture.sky_type, texture.sun_disc = "NISHITA", False
    texture.sun_elevation, texture.sun_rotation = math.radians(40), math.radians(30)
    world.links.new(texture.outputs["Color"], world.nodes["Background"].inputs["Color"])
    world.nodes["Background"].inputs["Strength"].default_value = 0.1
