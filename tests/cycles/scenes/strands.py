# SPDX-License-Identifier: GPL-3.0-or-later
"""Hair, curves and point clouds."""

import bpy
import numpy as np
from stage import (
    add,
    ball,
    box,
    camera,
    collection,
    diffuse,
    floor,
    instance,
    mesh,
    painted,
    place,
    scene,
    sky,
    square,
    stage,
    sun,
)

from scenes.instances import geometry_nodes, particles

SELDOM = {
    "generated_of_children",
    "generated_of_thick_curves",
}


def shape(kind, subdivisions=2):
    bpy.context.scene.cycles_curves.shape, bpy.context.scene.cycles_curves.subdivisions = kind, subdivisions


def sunny():
    """Without a sky: of what comes from behind a ribbon Cycles' own samples find a part."""
    floor()
    sky((0, 0, 0))
    sun((1, 0.9, 0.8), 3)
    sun((0.3, 0.5, 1), 2, (-4, 1, 2))
    sun((0.3, 0.8, 0.4), 2, (-1, 6, 2))
    camera()


def furry(of=None, **settings):
    """A square with thick hair that has children, of its second material."""
    made = mesh("Fur", *square(1.5), diffuse((0.6, 0.6, 0.6)))
    made.data.materials.append(of or diffuse((0.7, 0.4, 0.15)))
    values = {"type": "HAIR", "render_type": "PATH", "physics_type": "NEWTON", "hair_length": 1.2, "count": 30}
    values |= {"child_type": "INTERPOLATED", "rendered_child_count": 3, "material": 2, "root_radius": 6.0}
    values |= {"tip_radius": 1.0, "roughness_1": 0.15, "kink": "CURL", "kink_amplitude": 0.15, "render_step": 4}
    particles(made, **(values | settings))
    made.location.z, made.show_instancer_for_render = 0.05, True
    return made


@scene(samples=64)
def hair_ribbons():
    sunny()
    shape("RIBBONS")
    furry()


@scene
def hair_tubes():
    stage()
    shape("THICK")
    furry(shape=-0.5, use_close_tip=True)


def loops(thickness=0.03, of=None):
    """Curves of the new kind, which in 3.4 geometry nodes alone can fill: of the edges of a mesh, thicker where they are higher."""
    rings = [
        (np.cos(a) * 1.4, np.sin(a) * 1.2, 0.3 + 0.7 * k + 0.3 * np.sin(3 * a))
        for k in range(3)
        for a in np.arange(12) * 0.5
    ]
    data = bpy.data.meshes.new("Rings")
    data.from_pydata(rings, [(12 * k + i, 12 * k + i + 1) for k in range(3) for i in range(11)], [])
    source = place("Rings", data)
    made = place("Loops", bpy.data.hair_curves.new("Loops"))

    def build(tree, _geometry):
        kinds = ("ObjectInfo", "MeshToCurve", "SetCurveRadius", "SetMaterial", "InputPosition")
        found, curve, thick, paint, position = (tree.nodes.new(f"GeometryNode{kind}") for kind in kinds)
        parts, scaled = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("SeparateXYZ", "Math"))
        scaled.operation = "MULTIPLY"
        scaled.inputs[1].default_value = thickness
        found.inputs["Object"].default_value = source
        paint.inputs["Material"].default_value = of or diffuse((0.2, 0.5, 0.7))
        tree.links.new(position.outputs[0], parts.inputs[0])
        tree.links.new(parts.outputs["Z"], scaled.inputs[0])
        tree.links.new(found.outputs["Geometry"], curve.inputs["Mesh"])
        tree.links.new(curve.outputs[0], thick.inputs["Curve"])
        tree.links.new(scaled.outputs[0], thick.inputs["Radius"])
        tree.links.new(thick.outputs[0], paint.inputs["Geometry"])
        return paint.outputs[0]

    geometry_nodes(made, build)
    return made


@scene
def curves_ribbons():
    sunny()
    shape("RIBBONS", 1)
    loops().scale = 1, 1.2, 0.8


@scene
def curves_tubes():
    """Placed twice, so that they are squeezed as they lie."""
    stage()
    shape("THICK")
    group = collection("Group", loops())
    instance(group, (-1, 0.5, 0), (0.3, 0, 0.5), (0.9, 0.5, 0.8))
    instance(group, (1.2, -0.5, 0.2), (0, 0.4, 0), (0.6, 0.9, -0.7))


def told(kind, **scales):
    """A diffuse material whose colour is numbers of an info node, each scaled."""

    def build(tree):
        node = add(tree, kind)
        numbers = [add(tree, "Math", {"operation": "MULTIPLY"}, Value=node.outputs[name]) for name in scales]
        for number, scale in zip(numbers, scales.values()):
            number.inputs[1].default_value = scale
        color = tree.nodes.new("ShaderNodeCombineXYZ")
        for part, number in zip(color.inputs, numbers):
            tree.links.new(number.outputs[0], part)
        return color.outputs[0]

    return painted(build)


def told_by_noise(kind):
    """White noise of an info node's Random: to the number before or after it another colour belongs."""

    def build(tree):
        number = add(tree, kind).outputs["Random"]
        return add(tree, "TexWhiteNoise", {"noise_dimensions": "1D"}, W=number).outputs["Color"]

    return painted(build)


@scene
def curves_info():
    sunny()
    shape("THICK")
    loops(0.03, told("HairInfo", Intercept=0.8, Length=0.1, Random=0.8))


@scene
def curves_random():
    """To its last bit."""
    sunny()
    shape("THICK")
    loops(0.03, told_by_noise("HairInfo"))


@scene(samples=64)
def curves_info_of_hair():
    """On what is no hair all is 0."""
    sunny()
    shape("THICK")
    furry(told("HairInfo", **{"Intercept": 0.8, "Thickness": 8, "Is Strand": 0.5}))
    ball(told("HairInfo", **{"Is Strand": 0.5}), location=(0, 0, 1.6), radius=0.3)


def generated(tree):
    return add(tree, "TexCoord").outputs["Generated"]


def furry_ball(of, **settings):
    sunny()
    shape("THICK")
    made = ball(of, location=(0, 0, 1.2), radius=0.8, fineness=12)
    values = {"type": "HAIR", "render_type": "PATH", "physics_type": "NEWTON", "hair_length": 0.5}
    values |= {"count": 150, "root_radius": 6.0}
    particles(made, **(values | settings)).show_instancer_for_render = True
    made.scale = 1.3, 1, 0.8


@scene
def generated_of_hair():
    furry_ball(painted(generated))


@scene(samples=64)
def generated_of_children():
    """Where the emitter has been moved by a modifier, and by what nodes read without a link."""
    furry_ball(
        painted(lambda tree: add(tree, "TexGradient").outputs[0]), child_type="INTERPOLATED", rendered_child_count=3
    )
    made = next(o for o in bpy.context.scene.objects if o.particle_systems)
    made.modifiers.new("Bend", "SIMPLE_DEFORM").angle = 0.5


@scene
def simplified():
    """A third of the children, and one subdivision of three."""
    furry_ball(diffuse((0.6, 0.4, 0.2)), child_type="INTERPOLATED", rendered_child_count=6)
    box(location=(-1.8, 0, 0.6), scale=(0.5, 0.5, 0.5)).modifiers.new("Round", "SUBSURF").render_levels = 3
    simplify = bpy.context.scene.render
    simplify.use_simplify, simplify.simplify_subdivision_render, simplify.simplify_child_particles_render = (
        True,
        1,
        0.33,
    )


@scene
def generated_of_flat_fur():
    sunny()
    shape("THICK")
    furry(painted(generated))


@scene
def generated_of_curves():
    """They have none: it is where they are."""
    sunny()
    shape("THICK")
    loops(0.03, painted(generated))


@scene
def generated_of_thick_curves():
    stage()
    shape("THICK")
    loops(0.05, painted(generated)).scale = 1, 1.2, 0.8


@scene
def generated_of_points():
    points(painted(generated), radius=0.14)
    bpy.context.scene.objects["Ball"].scale = 1, 1, 1


@scene
def point_info():
    points(told("PointInfo", Random=0.9, Radius=3), radius=0.14)


@scene
def point_random():
    points(told_by_noise("PointInfo"), radius=0.14)


@scene
def point_info_place():
    points(painted(lambda tree: add(tree, "PointInfo").outputs["Position"]), radius=0.14)


def points(of, radius):
    stage()
    made = ball(location=(0, 0, 1.2), fineness=6)

    def build(tree, geometry):
        cloud = tree.nodes.new("GeometryNodeMeshToPoints")
        paint = tree.nodes.new("GeometryNodeSetMaterial")
        paint.inputs["Material"].default_value = of
        cloud.inputs["Radius"].default_value = radius
        tree.links.new(geometry, cloud.inputs["Mesh"])
        tree.links.new(cloud.outputs[0], paint.inputs["Geometry"])
        return paint.outputs[0]

    geometry_nodes(made, build)
    made.scale = 1.5, 1, 0.8


@scene
def point_cloud():
    points(diffuse((0.7, 0.3, 0.3)), radius=0.14)
