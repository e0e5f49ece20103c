# SPDX-License-Identifier: GPL-3.0-or-later
"""What the scenes of this folder are made of: settings, meshes, materials, lights, camera and world."""

import math

import bpy
import numpy as np
from mathutils import Vector


def set_up(width, height):
    """The render settings: WardMIS, and Cycles without anything that would trade bias for less noise."""
    scene = bpy.context.scene
    render, cycles = scene.render, scene.cycles
    render.engine = "WARDMIS"
    render.resolution_x, render.resolution_y, render.resolution_percentage = width, height, 100
    scene.view_settings.view_transform = "Standard"
    cycles.samples = 64
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.light_sampling_threshold = cycles.blur_glossy = 0
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = 7  # as WardMIS' eight surface hits


def add_mesh(name, vertices, faces, material, smooth=False):
    mesh = bpy.data.meshes.new(name)
    # at a pole a face names one vertex twice
    mesh.from_pydata(
        np.asarray(vertices).tolist(), [], [list(dict.fromkeys(face)) for face in np.asarray(faces).tolist()]
    )
    mesh.validate()
    mesh.polygons.foreach_set("use_smooth", [smooth] * len(mesh.polygons))
    mesh.materials.append(material)
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(obj)
    return obj


def grey(value):
    return (value, value, value)


def square(half):
    return [(-half, -half, 0), (half, -half, 0), (half, half, 0), (-half, half, 0)], [(0, 1, 2, 3)]


def box_mesh():
    """A cube of half size 1, faces outwards."""
    vertices = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
    return vertices, [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


def sphere_mesh(segments, rings):
    """Of radius 1: a grid over longitude and latitude, welded at its seam and poles."""
    theta = np.linspace(0, math.pi, rings + 1)[:, None]
    phi = np.linspace(0, 2 * math.pi, segments, endpoint=False)
    x, y, z = np.broadcast_arrays(np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta))
    index = np.arange(x.size).reshape(x.shape)
    index[0], index[-1] = index[0, 0], index[-1, 0]
    right = np.roll(index, -1, axis=1)
    quads = np.stack([index[:-1], index[1:], right[1:], right[:-1]], axis=-1).reshape(-1, 4)
    used, quads = np.unique(quads, return_inverse=True)
    return np.stack([x, y, z], axis=-1).reshape(-1, 3)[used], quads.reshape(-1, 4)


def ward(name, diffuse, specular, alpha, variant):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.node_tree.nodes.clear()
    node = material.node_tree.nodes.new("WardBSDFNode")
    node.inputs["Diffuse Color"].default_value = (*diffuse, 1)
    node.inputs["Specular Color"].default_value = (*specular, 1)
    node.inputs["Alpha X"].default_value = node.inputs["Alpha Y"].default_value = alpha
    node.variant = variant
    connect(material, node)
    return material


def emitter(name, radiance):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.node_tree.nodes.clear()
    node = material.node_tree.nodes.new("ShaderNodeEmission")
    node.inputs["Strength"].default_value = radiance
    connect(material, node)
    return material


def connect(material, node):
    output = material.node_tree.nodes.new("ShaderNodeOutputMaterial")
    output.location.x = 250
    material.node_tree.links.new(node.outputs[0], output.inputs["Surface"])


def add_light(data, location, watts):
    data.energy = watts
    light = bpy.data.objects.new(data.name, data)
    light.location = location
    light.visible_camera = True  # new lights are not
    bpy.context.collection.objects.link(light)
    return light


def add_point(location, watts, radius):
    data = bpy.data.lights.new("Point", "POINT")
    data.shadow_soft_size = radius
    return add_light(data, location, watts)


def add_area(location, target, size, watts):
    """A square light that looks at `target`."""
    data = bpy.data.lights.new("Area", "AREA")
    data.size = size
    light = add_light(data, location, watts)
    light.rotation_euler = look_at(location, target)
    return light


def look_at(location, target):
    # of unit length: Blender takes the direction of a short vector for none
    return (Vector(target) - Vector(location)).normalized().to_track_quat("-Z", "Y").to_euler()


def add_camera(location, target, degrees):
    """A camera with this horizontal angle that looks at `target`."""
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location = location
    camera.rotation_euler = look_at(location, target)
    camera.data.angle = math.radians(degrees)
    bpy.context.collection.objects.link(camera)
    bpy.context.scene.camera = camera
    return camera


def empty_world():
    """A white sky of radiance 1; returns its node tree."""
    world = bpy.data.worlds.new("World")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (1, 1, 1, 1)
    bpy.context.scene.world = world
    return world.node_tree
