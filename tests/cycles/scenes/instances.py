# SPDX-License-Identifier: GPL-3.0-or-later
"""Things that are shown more than once."""

import bpy
import numpy as np
from stage import (
    add,
    ball,
    box,
    collection,
    diffuse,
    face_on,
    feed,
    gradient,
    instance,
    lamp,
    mesh,
    painted,
    place,
    scene,
    sheet,
    square,
    stage,
)
from wardmis import compat


def boxes():
    return collection(
        "Boxes",
        box(diffuse((0.7, 0.3, 0.2)), location=(0, 0, 0.4), scale=(0.3, 0.3, 0.4)),
        ball(diffuse((0.2, 0.4, 0.7)), location=(0.5, 0.3, 0.3), radius=0.3, fineness=24),
    )


@scene
def collections():
    stage()
    group = boxes()
    for i, (x, y, size) in enumerate(((1.3, 0.4, 1.6), (0.5, -1.4, 1), (-1.5, 1.2, 2), (-1.2, -1, 1.2))):
        instance(group, (x, y, 0), (0.1 * i, 0, 0.5 * i), (size, size, 0.8 * size))


@scene
def nested_collections():
    stage()
    inner = boxes()
    pair = collection("Pair", instance(inner, (-0.7, 0, 0)), instance(inner, (0.7, 0, 0), (0, 0, 1), (1, 1, 2)))
    pair.instance_offset = 0.2, 0.1, 0
    instance(pair, (-1.5, 0.5, 0), (0, 0, 0.4))
    instance(pair, (1.2, -0.8, 0), (0, 0, -0.4), (0.8, 1.2, 1))


@scene(
    within=0.05, why="a sheared rectangle: Cycles takes its axes for orthogonal, and so moves its light with the viewer"
)
def lamps():
    stage()
    box(scale=(0.5, 0.5, 0.5), location=(0, 0, 0.5))
    group = collection(
        "Lamps", lamp("POINT", (0, 0, 1.5), 30, (1, 0.2, 0.2)), lamp("AREA", (0.5, 0, 2), 20, (0.2, 1, 0.2), size=0.3)
    )
    instance(group, (-1.5, -1, 0))
    instance(group, (1.5, 0, 0), (0, 0, 1), (1, 1, 0.7))


@scene
def of_vertices():
    stage()
    parent = mesh("Parent", *square(1.5))
    parent.location.z = 0.01
    child = box(diffuse((0.3, 0.6, 0.3)), location=(0, 0, 0.4), scale=(0.3, 0.2, 0.4))
    child.parent = parent
    parent.instance_type, parent.use_instance_vertices_rotation = "VERTS", True


def box_of_balls():
    """The box that is to have a ball at each of its parts."""
    stage()
    parent = box(location=(0, 0, 0.8), scale=(0.8, 0.6, 0.8))
    child = ball(diffuse((0.6, 0.3, 0.3)), location=(0, 0, 0), radius=0.4, fineness=24)
    child.parent = parent
    return parent


@scene
def of_faces():
    parent = box_of_balls()
    parent.instance_type, parent.use_instance_faces_scale, parent.instance_faces_scale = "FACES", True, 0.5
    parent.show_instancer_for_render = True


@scene
def hidden_instancer():
    parent = box_of_balls()
    parent.instance_type, parent.show_instancer_for_render = "VERTS", False


def random_color(tree):
    """Of Object Info's Random, seen to its last bit: numbers that follow each other have nothing to do with each other."""
    return add(tree, "TexWhiteNoise", {"noise_dimensions": "1D"}, W=add(tree, "ObjectInfo").outputs["Random"]).outputs[
        "Color"
    ]


ROWS, COLUMNS = 15, 20


def tiles():
    """Where they lie, so that they fill the image."""
    return [((x + 0.5) / COLUMNS * 4 - 2, (y + 0.5) / ROWS * 3 - 1.5, 0) for y in range(ROWS) for x in range(COLUMNS)]


@scene
def random_of_instances():
    face_on()
    corners = np.array(square(0.099)[0])
    parent = mesh("Parent", (np.array(tiles())[:, None] + corners).reshape(-1, 3), np.arange(1200).reshape(-1, 4))
    child = mesh("Child", *square(0.095), painted(random_color))
    child.parent, parent.instance_type, parent.show_instancer_for_render = parent, "FACES", False


@scene
def color_of_instances():
    """That of the outermost instancer, whatever places them."""
    face_on()
    color = painted(lambda tree: add(tree, "ObjectInfo").outputs["Color"])
    child = mesh("Child", *square(0.4), color)
    parent = mesh("Parent", *square(1.5))
    child.parent, parent.instance_type, parent.show_instancer_for_render = parent, "VERTS", False
    child.color, parent.color = (0.9, 0.5, 0.2, 1), (0.1, 0.8, 0.3, 1)
    outermost = instance(collection("Inner", parent, child), location=(0.3, 0, 0))
    outermost.color = (0.1, 0.3, 0.9, 1)
    other = mesh("Placed", *square(0.3), color)
    by_faces = mesh("By faces", *square(0.5))
    other.parent, by_faces.instance_type, by_faces.show_instancer_for_render = by_faces, "FACES", False
    other.color, by_faces.color = (0.9, 0.5, 0.2, 1), (0.8, 0.1, 0.7, 1)


@scene
def random_of_names():
    face_on()
    data = mesh("Tile", *square(0.095), painted(random_color)).data
    for index, location in enumerate(tiles()):
        place(f"{('Tile', 'Größe', 'Пол', '床')[index % 4]} {index}", data, location)


def particles(made, **settings):
    made.modifiers.new("Particles", "PARTICLE_SYSTEM")
    data = made.particle_systems[0].settings
    data.count, data.frame_start, data.frame_end, data.lifetime = 30, 1, 1, 200
    data.physics_type, data.emit_from, data.particle_size, data.size_random = "NO", "FACE", 0.15, 0.5
    data.use_rotations, data.rotation_factor_random = True, 0.5
    for name, value in settings.items():
        setattr(data, name, value)
    bpy.context.scene.frame_set(10)
    return made


@scene
def particle_objects():
    stage()
    made = particles(mesh("Emitter", *square(2)), render_type="OBJECT", instance_object=box(location=(0, 0, -5)))
    made.location.z, made.show_instancer_for_render = 0.2, True


@scene
def particle_collections():
    stage()
    group = boxes()
    made = particles(
        mesh("Emitter", *square(2)), render_type="COLLECTION", instance_collection=group, particle_size=0.6
    )
    made.location.z, made.show_instancer_for_render = 0.1, False


def from_instancer(kind, output):
    """A surface that shows coordinates of the instancer's, of which some are negative."""

    def lifted(tree):
        own = add(tree, kind, {"from_instancer": True}).outputs[output]
        node = add(tree, "VectorMath", {"operation": "MULTIPLY_ADD"})
        for socket, value in zip(node.inputs, (own, (0.6,) * 3, (0.35,) * 3)):
            feed(tree, socket, value)
        return node.outputs[0]

    return painted(lifted)


@scene
def coordinates_of_faces():
    stage()
    for x, kind, output in ((-1.2, "TexCoord", "UV"), (1.2, "TexCoord", "Generated")):
        parent = sheet(diffuse(), divisions=3, size=1)
        parent.location = x, 0, 0.4
        box(from_instancer(kind, output), location=(0, 0, 0), scale=(0.2, 0.2, 0.2)).parent = parent
        parent.instance_type = "FACES"


@scene
def coordinates_of_particles():
    """And of what nothing has brought: an object itself."""
    stage()
    child = box(from_instancer("UVMap", "UV"), location=(-1.5, -1.5, 0.4), scale=(0.4, 0.4, 0.4))
    made = particles(sheet(diffuse(), size=2), render_type="OBJECT", instance_object=child, particle_size=0.6)
    made.location.z, made.show_instancer_for_render = 0.2, True


@scene
def hair_objects():
    """Hair of objects in strands' places."""
    stage()
    made = mesh("Emitter", *square(2))
    made.location.z = 0.05
    particles(
        made,
        type="HAIR",
        render_type="OBJECT",
        instance_object=box(location=(0, 0, -5)),
        particle_size=0.1,
        use_advanced_hair=True,
    )


def geometry_nodes(made, build):
    """A modifier whose geometry is the socket that build(tree, geometry socket) returns."""
    tree = bpy.data.node_groups.new("Geometry", "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        compat.add_group_socket(tree, "Geometry", "NodeSocketGeometry", way)
    entry, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    tree.links.new(build(tree, entry.outputs[0]), end.inputs[0])
    made.modifiers.new("Geometry", "NODES").node_group = tree


@scene
def geometry_node_instances():
    """On points of a grid, with the grid itself."""
    stage()
    shown = box(diffuse((0.3, 0.3, 0.7)), location=(0, 0, -5), scale=(0.25, 0.15, 0.3))

    def build(tree, geometry):
        points = tree.nodes.new("GeometryNodeInstanceOnPoints")
        source, joined = tree.nodes.new("GeometryNodeObjectInfo"), tree.nodes.new("GeometryNodeJoinGeometry")
        source.inputs["Object"].default_value = shown
        tree.links.new(geometry, points.inputs["Points"])
        tree.links.new(source.outputs["Geometry"], points.inputs["Instance"])
        points.inputs["Rotation"].default_value = 0.2, 0.1, 0.5
        points.inputs["Scale"].default_value = 1, 1.5, 1
        tree.links.new(points.outputs[0], joined.inputs[0])
        tree.links.new(geometry, joined.inputs[0])
        return joined.outputs[0]

    made = ball(location=(0, 0, 1), radius=1, fineness=4)
    geometry_nodes(made, build)


@scene
def shared_mesh_other_materials():
    """One mesh, two objects, a material of each object."""
    stage()
    first = box(location=(-1.3, 0, 1), scale=(0.7, 0.7, 1))
    twin = place("Twin", first.data, (1.3, 0, 1), (0, 0, 0.7), (0.7, 0.7, 1))
    for made, color in ((first, (0.8, 0.3, 0.2)), (twin, (0.2, 0.3, 0.8))):
        made.material_slots[0].link = "OBJECT"
        made.material_slots[0].material = diffuse(color)


@scene
def many():
    """A thousand, of an array of arrays."""
    stage()
    made = box(location=(-2, -1.2, 0.1), scale=(0.08, 0.08, 0.1), rotation=(0, 0, 0.1))
    for axis, count in enumerate((20, 10, 5)):
        array = made.modifiers.new("Array", "ARRAY")
        array.count, array.use_relative_offset, array.use_constant_offset = count, False, True
        array.constant_offset_displace = tuple(np.eye(3)[axis] * 3)


@scene
def textured():
    """Instances keep the mesh's UV map."""
    from stage import image

    stage()
    picture = image("Colours", gradient(4, 4))
    group = collection(
        "Sheets", sheet(painted(lambda tree: add(tree, "TexImage", {"image": picture}).outputs[0]), size=0.7)
    )
    instance(group, (-1, 0, 0.8), (0.9, 0, 0.2))
    instance(group, (1, 0, 0.8), (0.9, 0, -0.2), (-1, 1, 1))


@scene
def linked_library():
    """A collection of another file."""
    path = f"{bpy.app.tempdir}/library.blend"
    group = boxes()
    group.name = "Linked"
    bpy.data.libraries.write(path, {group})
    for made in list(group.objects):
        bpy.data.objects.remove(made)
    bpy.data.collections.remove(group)
    with bpy.data.libraries.load(path, link=True) as (_, wanted):
        wanted.collections = ["Linked"]
    stage()
    instance(bpy.data.collections["Linked"], (-1, 0, 0), (0, 0, 0.4), (2, 2, 2))
