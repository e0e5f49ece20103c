# SPDX-License-Identifier: GPL-3.0-or-later
"""What Attribute nodes read: of every domain and type, and by names that are not the user's."""

import numpy as np
from stage import (
    FACTOR,
    add,
    ball,
    box,
    diffuse,
    face_on,
    feed,
    mesh,
    painted,
    place,
    scene,
    sheet,
    square,
    stage,
)

from scenes.instances import geometry_nodes, particles

SELDOM = {
    "edge_booleans",
    "edge_bytes",
    "edge_integers",
    "edge_vectors",
}


def read(name, output="Vector", kind="GEOMETRY"):
    """How far its values are from 0."""
    settings = {"attribute_type": kind, "attribute_name": name}

    def build(tree):
        told = add(tree, "Attribute", settings).outputs[output]
        absolute = add(tree, "VectorMath", {"operation": "ABSOLUTE"})
        tree.links.new(told, absolute.inputs[0])
        return absolute.outputs[0]

    return painted(build)


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


def by_noise(kind, name):
    """White noise of a number: the one before or after it has another colour."""

    def build(tree):
        number = add(tree, "Attribute", {"attribute_type": kind, "attribute_name": name}).outputs[FACTOR]
        return add(tree, "TexWhiteNoise", {"noise_dimensions": "1D"}, W=number).outputs["Color"]

    return painted(build)


@scene
def numbers_to_the_last_bit():
    """Those of faces, and of objects."""
    face_on()
    made = sheet(by_noise("GEOMETRY", "Number"), 16)
    made.scale, made.location = (0.4, 0.6, 1), (-1, 0, 0)
    give(made, "Number", "FLOAT", "FACE")
    of, random = by_noise("OBJECT", "number"), np.random.default_rng(6)
    data = mesh("Tile", *square(0.09), of).data
    for x in range(10):
        for y in range(15):
            place("Tile", data, (0.1 + 0.2 * x, 0.2 * y - 1.4, 0))["number"] = random.random()


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


def named(*outputs):
    """A row of balls with UVs, colours and, under each name, an attribute of the user's; `outputs`: names, and outputs to show."""
    stage()
    for k, (name, output) in enumerate(outputs):
        made = ball(read(name, output), location=(1.3 * k - 0.65 * (len(outputs) - 1), 0, 0.8), radius=0.6, fineness=10)
        made.rotation_euler = 0.3, 0.4, 0.2
        give(made, "Colours", "FLOAT_COLOR", "POINT", key="color", width=4)
        made.data.color_attributes.render_color_index = 0
        if name not in made.data.attributes:
            give(made, name, "FLOAT_VECTOR", "POINT", key="vector", width=3)


@scene
def named_generated():
    named(("generated", "Color"), ("generated", "Fac"), ("generated", "Alpha"))


@scene
def named_uv():
    stage()
    for k, output in enumerate(("Vector", "Fac", "Alpha")):
        made = sheet(read("uv", output), size=0.6)
        made.location = 1.3 * k - 1.3, 0, 0.6
        give(made, "uv", "FLOAT_VECTOR", "POINT", key="vector", width=3)


@scene
def named_as_in_cycles():
    named(("color", "Color"), ("vertex_color", "Color"), ("velocity", "Alpha"))


@scene(without=(5, 2))
def named_as_normals():
    """In 5.2 they are named, and 0."""
    named(("N", "Color"), ("Ng", "Color"))


@scene
def color_attributes_named_as_in_cycles():
    """Color Attribute finds none of these."""
    stage()
    for k, (name, output) in enumerate((("color", "Color"), ("color", "Alpha"), ("uv", "Color"))):
        of = painted(lambda tree, n=name, o=output: add(tree, "VertexColor", {"layer_name": n}).outputs[o])
        made = ball(of, location=(1.3 * k - 1.3, 0, 0.8), radius=0.6, fineness=8)
        give(made, name, "FLOAT_COLOR", "POINT", key="color", width=4)


def link(tree, kind, *sources, **values):
    """A geometry node whose first inputs are linked, and the others, by name, are set or linked; its first output."""
    made = tree.nodes.new(f"GeometryNode{kind}")
    for socket, source in zip(made.inputs, sources):
        tree.links.new(source, socket)
    for name, value in values.items():
        feed(tree, made.inputs[name.replace("_", " ")], value)
    return made.outputs[0]


def tinted(tree, geometry, name="Tint"):
    """Instances with a colour for each."""
    stored = tree.nodes.new("GeometryNodeStoreNamedAttribute")
    stored.domain, stored.data_type = "INSTANCE", "FLOAT_VECTOR"
    tree.links.new(geometry, stored.inputs[0])
    next(s for s in stored.inputs if s.name == "Name").default_value = name
    colors = tree.nodes.new("FunctionNodeRandomValue")
    colors.data_type = "FLOAT_VECTOR"
    tree.links.new(link(tree, "InputIndex"), next(s for s in colors.inputs if s.name == "ID"))
    tree.links.new(
        next(s for s in colors.outputs if s.type == "VECTOR"),
        next(s for s in stored.inputs if s.name == "Value" and s.type == "VECTOR"),
    )
    return stored.outputs[0]


def small_box(tree, of):
    made = tree.nodes.new("GeometryNodeMeshCube")
    made.inputs[0].default_value = 0.4, 0.3, 0.5
    return link(tree, "SetMaterial", made.outputs[0], Material=of)


def by_nodes(build):
    made = box(location=(0, 0, 1), scale=(1.3, 1, 0.7))
    geometry_nodes(made, build)


@scene(since=(5, 0))
def of_instances():
    """Before, Blender does not tell them."""
    stage()
    of = read("Tint", "Color", "INSTANCER")
    by_nodes(lambda tree, points: tinted(tree, link(tree, "InstanceOnPoints", points, Instance=small_box(tree, of))))


@scene(since=(5, 0))
def of_instances_of_objects():
    stage()
    shown = box(read("Tint", "Vector", "INSTANCER"), location=(0, 0, -5), scale=(0.2, 0.3, 0.2))

    def build(tree, points):
        found = tree.nodes.new("GeometryNodeObjectInfo")
        found.inputs["Object"].default_value, found.inputs["As Instance"].default_value = shown, True
        return tinted(tree, link(tree, "InstanceOnPoints", points, Instance=found.outputs["Geometry"]))

    by_nodes(build)


@scene(since=(5, 0))
def of_nested_instances():
    """With other geometry beside the inner instances, and "id"s of which some are the same."""
    stage()
    of = read("Tint", "Vector", "INSTANCER")

    def build(tree, points):
        inner = link(tree, "MeshLine", Count=3)
        inner.node.inputs["Start Location"].default_value = 0.07, 0.05, 0.3
        inner.node.inputs["Offset"].default_value = 0.1, 0.1, 0.35
        placed = tinted(tree, link(tree, "InstanceOnPoints", inner, Instance=small_box(tree, of)))
        joined = link(tree, "JoinGeometry", placed)
        tree.links.new(small_box(tree, of), joined.node.inputs[0])
        index = link(tree, "InputIndex")
        half = tree.nodes.new("ShaderNodeMath")
        half.operation, half.inputs[1].default_value = "MODULO", 5
        tree.links.new(index, half.inputs[0])
        numbered = link(tree, "SetID", points, ID=half.outputs[0])
        return tinted(tree, link(tree, "InstanceOnPoints", numbered, Instance=joined, Scale=(0.6, 0.6, 0.6)), "Tint")

    by_nodes(build)


@scene
def of_what_places():
    """Settings of particles, the object that places, the object itself, their data: in Blender's order."""
    stage()
    for x, names in enumerate(("abcd", "bcd", "cd", "d")):
        shown = box(read("Tint", "Fac", "INSTANCER"), location=(x - 1.5, 0, -5), scale=(0.5, 0.5, 0.5))
        emitter = sheet(diffuse(), size=0.8)
        emitter.location = 1.1 * x - 1.7, 0, 0.5
        made = particles(emitter, render_type="OBJECT", instance_object=shown, count=4, particle_size=0.5)
        owners = {"a": made.particle_systems[0].settings, "b": made, "c": shown, "d": shown.data}
        for name in names:
            owners[name]["Tint"] = {"a": 0.8, "b": 0.5, "c": 0.3, "d": 0.1}[name]
        made.data["Tint"] = 0.95
