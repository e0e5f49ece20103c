# SPDX-License-Identifier: GPL-3.0-or-later
"""What Attribute nodes read: of every domain and type, and by names that are not the user's."""

import bpy
import numpy as np
from stage import add, ball, box, painted, scene, stage


def read(name, output="Vector", kind="GEOMETRY"):
    settings = {"attribute_type": kind, "attribute_name": name}
    return painted(lambda tree: add(tree, "Attribute", settings).outputs[output])


def give(made, name, kind, domain, key="value", width=1, most=1):
    """Random values up to `most`."""
    attribute = made.data.attributes.new(name, kind, domain)
    values = np.random.default_rng(5).random(len(attribute.data) * width) * most
    typed = values > 0.7 if kind == "BOOLEAN" else values.astype(int) if kind.startswith("INT") else values
    attribute.data.foreach_set(key, typed)


@scene
def vertex_groups():
    """In 3.4 there are none for Cycles. One has vertices that are not in it."""
    stage()
    for x, output in ((-1.2, "Fac"), (1.2, "Color")):
        made = ball(read("Weights", output), location=(x, 0, 1), fineness=12)
        made.vertex_groups.new(name="Others").add(range(len(made.data.vertices)), 0.9, "REPLACE")
        group = made.vertex_groups.new(name="Weights")
        for vertex in made.data.vertices:
            if vertex.co.x > -0.5:
                group.add([vertex.index], (vertex.co.z + 1) / 2, "REPLACE")


@scene
def vertex_groups_of_instances():
    """Of a mesh that geometry nodes place."""
    from scenes.instances import geometry_nodes

    stage()
    shown = box(read("Weights"), location=(0, 0, -5), scale=(0.4, 0.4, 0.4))
    shown.vertex_groups.new(name="Weights").add([0, 1, 4, 6], 0.8, "REPLACE")

    def build(tree, geometry):
        points, source = (tree.nodes.new(f"GeometryNode{kind}") for kind in ("InstanceOnPoints", "ObjectInfo"))
        source.inputs["Object"].default_value = shown
        tree.links.new(geometry, points.inputs["Points"])
        tree.links.new(source.outputs["Geometry"], points.inputs["Instance"])
        return points.outputs[0]

    geometry_nodes(box(location=(0, 0, 1), scale=(1.2, 1, 0.5)), build)


def of_edges(kind, **settings):
    stage()
    give(ball(read("Tone"), location=(-1.1, 0, 1), fineness=8), "Tone", kind, "EDGE", **settings)
    give(box(read("Tone", "Fac"), location=(1.2, 0, 0.8), scale=(0.8, 0.8, 0.8)), "Tone", kind, "EDGE", **settings)


@scene
def edge_vectors():
    of_edges("FLOAT_VECTOR", key="vector", width=3)


@scene
def edge_booleans():
    of_edges("BOOLEAN")


@scene
def edge_colors_of_bytes():
    of_edges("BYTE_COLOR", key="color", width=4)


def whole(kind, domain):
    """Whole numbers, a quarter of them."""
    stage()
    settings = {"attribute_name": "Tone"}
    made = ball(
        painted(
            lambda tree: add(
                tree, "Math", {"operation": "MULTIPLY"}, Value=add(tree, "Attribute", settings).outputs["Fac"]
            ).outputs[0]
        ),
        location=(0, 0, 1),
        fineness=8,
    )
    made.active_material.node_tree.nodes["Math"].inputs[1].default_value = 0.25
    give(made, "Tone", kind, domain, most=5)


@scene
def edge_integers():
    whole("INT", "EDGE")


@scene
def edge_bytes():
    whole("INT8", "EDGE")


@scene
def point_bytes():
    """3.4 reads none."""
    whole("INT8", "POINT")


@scene(since=(4, 1))
def quaternions():
    stage()
    made = ball(read("Turn"), location=(0, 0, 1), fineness=8)
    give(made, "Turn", "QUATERNION", "POINT", width=4)
