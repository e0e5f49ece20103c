# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes that something else bends, and what is no mesh until it is rendered."""

import math

import bpy
import numpy as np
from stage import ball, box, diffuse, mesh, place, scene, stage

SAMPLES = 16  # of little noise


def grid(name="Cloth", divisions=12, size=1.5, of=None):
    steps = np.linspace(-1, 1, divisions + 1)
    x, y = np.meshgrid(steps, steps)
    index = np.arange(x.size).reshape(x.shape)
    faces = np.stack([index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]], axis=-1).reshape(-1, 4)
    made = mesh(name, np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3) * size, faces, of, smooth=True)
    made.location.z = 1
    return made


@scene
def shape_keys():
    stage()
    made = grid()
    made.shape_key_add(name="Basis")
    key = made.shape_key_add(name="Wave")
    for point in key.data:
        point.co.z = 0.4 * math.sin(2 * point.co.x) * math.cos(2 * point.co.y)
    key.value = 0.8


@scene
def armature():
    stage()
    made = box(location=(0, 0, 0), scale=(1, 1, 1), rotation=(0, 0, 0))
    data = bpy.data.armatures.new("Bones")
    rig = place("Rig", data)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for name, low, high in (("Low", -1, 0), ("High", 0, 1)):
        bone = data.edit_bones.new(name)
        bone.head, bone.tail = (0, 0, low), (0, 0, high)
    bpy.ops.object.mode_set(mode="OBJECT")
    for name, members in (("Low", range(4)), ("High", range(4, 8))):
        made.vertex_groups.new(name=name).add(list(members), 1.0, "REPLACE")
    made.modifiers.new("Rig", "ARMATURE").object = rig
    made.modifiers.new("Round", "SUBSURF").render_levels = 2
    rig.pose.bones["High"].rotation_mode = "XYZ"
    rig.pose.bones["High"].rotation_euler = 0.3, 0.6, 0.2
    made.location.z = rig.location.z = 1


@scene
def lattice():
    stage()
    made = ball(location=(0, 0, 1), fineness=24)
    cage = place("Lattice", bpy.data.lattices.new("Lattice"), (0, 0, 1), scale=(2, 2, 2))
    for point in cage.data.points[:2]:
        point.co_deform.x -= 0.5
    made.modifiers.new("Lattice", "LATTICE").object = cage


@scene
def displaced():
    """By a texture of Blender's, not by the material."""
    stage()
    made = grid(divisions=40)
    texture = bpy.data.textures.new("Clouds", "CLOUDS")
    texture.noise_scale = 0.5
    bend = made.modifiers.new("Displace", "DISPLACE")
    bend.texture, bend.strength = texture, 0.6


def curve(kind="BEZIER", dimensions="3D"):
    data = bpy.data.curves.new("Curve", "CURVE")
    data.dimensions = dimensions
    data.materials.append(diffuse((0.7, 0.4, 0.2)))
    spline = data.splines.new(kind)
    points = [(-2, 0, 0.5), (-0.5, -1, 1.5), (0.7, 1, 0.7), (2, 0, 1.2)]
    if kind == "BEZIER":
        spline.bezier_points.add(len(points) - 1)
        for point, place_ in zip(spline.bezier_points, points):
            point.co, point.handle_left_type, point.handle_right_type = place_, "AUTO", "AUTO"
    else:
        spline.points.add(len(points) - 1)
        for point, place_ in zip(spline.points, points):
            point.co = (*place_, 1)
        spline.use_endpoint_u = True
    return data, spline


@scene
def bevelled_curve():
    stage()
    data, spline = curve()
    data.bevel_depth, data.bevel_resolution, data.use_fill_caps = 0.2, 4, True
    spline.bezier_points[1].radius = 2
    place("Curve", data)


@scene
def nurbs_curve():
    stage()
    data, _ = curve("NURBS")
    data.bevel_depth, data.extrude = 0.1, 0.2
    place("Curve", data)


@scene
def filled_curve():
    """A flat one, closed and thick."""
    stage()
    data, spline = curve(dimensions="2D")
    spline.use_cyclic_u = True
    data.fill_mode, data.extrude, data.bevel_depth = "BOTH", 0.2, 0.05
    place("Curve", data, (0, 0, 0.8), (0.3, 0, 0))


@scene
def curve_modifier():
    stage()
    data, _ = curve()
    path = place("Path", data)
    made = box(location=(0, 0, 0), scale=(1, 1, 1), rotation=(0, 0, 0))
    made.data.transform(place("Unit", None, scale=(0.2, 0.3, 0.2)).matrix_basis)
    array = made.modifiers.new("Array", "ARRAY")
    array.fit_type, array.curve = "FIT_CURVE", path
    made.modifiers.new("Follow", "CURVE").object = path


@scene
def text():
    stage()
    data = bpy.data.curves.new("Text", "FONT")
    data.body, data.extrude, data.bevel_depth, data.size, data.align_x = "Ward\nMIS", 0.1, 0.02, 1.3, "CENTER"
    data.materials.append(diffuse((0.3, 0.5, 0.8)))
    place("Text", data, (0, 0, 1.2), (1.2, 0, 0.1))


@scene
def metaballs():
    stage()
    data = bpy.data.metaballs.new("Meta")
    data.render_resolution = 0.1
    for x in (-0.6, 0.5):
        data.elements.new().co = (x, 0, 0)
    data.materials.append(diffuse((0.8, 0.7, 0.3)))
    place("Meta", data, (0, 0, 1))
    second = bpy.data.metaballs.new("Meta.001")
    second.elements.new().co = (0, 0.8, 0.6)
    place("Meta.001", second, (0, 0, 1))


@scene
def nurbs_surface():
    stage()
    bpy.ops.surface.primitive_nurbs_surface_torus_add(radius=1, location=(0, 0, 0.7))
    bpy.context.object.data.materials.append(diffuse())


@scene
def geometry_node_mesh():
    """A mesh that a node makes, with a material set there, and one of another type in its place."""
    from scenes.instances import geometry_nodes

    stage()
    of = diffuse((0.2, 0.6, 0.4))

    def build(tree, geometry):
        cone, paint = tree.nodes.new("GeometryNodeMeshCone"), tree.nodes.new("GeometryNodeSetMaterial")
        cone.inputs["Vertices"].default_value, cone.inputs["Depth"].default_value = 24, 1.5
        paint.inputs["Material"].default_value = of
        tree.links.new(cone.outputs["Mesh"], paint.inputs["Geometry"])
        return paint.outputs[0]

    geometry_nodes(box(location=(0, 0, 0.2)), build)


@scene
def curve_to_mesh():
    """A curve whose modifier makes a mesh of it."""
    from scenes.instances import geometry_nodes

    stage()
    data, _ = curve()
    made = place("Curve", data)

    def build(tree, geometry):
        to_mesh, circle = tree.nodes.new("GeometryNodeCurveToMesh"), tree.nodes.new("GeometryNodeCurvePrimitiveCircle")
        circle.inputs["Radius"].default_value = 0.25
        tree.links.new(geometry, to_mesh.inputs["Curve"])
        tree.links.new(circle.outputs[0], to_mesh.inputs["Profile Curve"])
        return to_mesh.outputs[0]

    geometry_nodes(made, build)


@scene
def animated():
    """Frame 12 of a movement that starts at frame 1."""
    stage()
    made = box(location=(-2, 0, 0.6), scale=(0.6, 0.6, 0.6))
    made.keyframe_insert("location", frame=1)
    made.location = 2, 1, 1.5
    made.rotation_euler = 1, 0.5, 0
    made.keyframe_insert("location", frame=21)
    made.keyframe_insert("rotation_euler", frame=21)
    bpy.context.scene.frame_set(12)


@scene
def constrained():
    stage()
    target = ball(location=(1.2, 0, 1.6), radius=0.4, fineness=24)
    made = box(location=(-0.8, 0, 0.8), scale=(0.3, 0.3, 0.8), rotation=(0, 0, 0))
    follow = made.constraints.new("DAMPED_TRACK")
    follow.target, follow.track_axis = target, "TRACK_Z"


@scene(without=(4, 3))
def fluid_domain():
    """Without a simulation, what holds it is not seen. Debian's 4.3 aborts when it loads its simulator."""
    stage()
    box(diffuse((0.8, 0.5, 0.3)), location=(0, 0, 0.5), scale=(0.5, 0.5, 0.5))
    domain = box(location=(0, 0, 1), scale=(1.4, 1.4, 1))
    made = domain.modifiers.new("Fluid", "FLUID")
    made.fluid_type = "DOMAIN"
    made.domain_settings.domain_type = "GAS"
