# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees of materials: muting, groups, arithmetic, and what nodes fall back to."""

import bpy
from stage import (
    ALPHA,
    COLOR,
    FACTOR,
    add,
    attribute,
    box,
    daylight,
    diffuse,
    face_on,
    feed,
    gradient,
    image,
    material,
    painted,
    scene,
    sheet,
    stage,
    with_properties,
)
from wardmis import compat


def row(*builders):
    """Sheets side by side, each of a colour that `builder(tree)` returns: a socket."""
    face_on()
    count = len(builders)
    for number, build in enumerate(builders):
        made = sheet(painted(build), size=0.95 / count * 2)
        made.scale = 1, count / 2 * 1.4, 1
        made.location.x = 4 * (number + 0.5) / count - 2


def shaders(*builders):
    """The same of the shader that `builder(tree)` returns."""
    face_on()
    count = len(builders)
    for number, build in enumerate(builders):
        of, tree, output = material()
        socket = build(tree)
        if socket is not None:
            tree.links.new(socket, output.inputs["Surface"])
        made = sheet(of, size=0.95 / count * 2)
        made.scale = 1, count / 2 * 1.4, 1
        made.location.x = 4 * (number + 0.5) / count - 2


def colors(tree):
    """Of numbers, and not filtered: that is a matter of images."""
    picture = image("Colours", gradient(4, 4), floats=True)
    return add(tree, "TexImage", {"image": picture, "interpolation": "Closest"}).outputs["Color"]


def math(operation, *numbers, clamp=False):
    def build(tree):
        node = add(tree, "Math", {"operation": operation, "use_clamp": clamp})
        for socket, number in zip(node.inputs, numbers):
            socket.default_value = number
        return node.outputs[0]

    return build


@scene
def attributes_that_are_properties():
    """Of few numbers, and of none."""
    with_properties(bpy.context.scene)
    wanted = [("two", COLOR), ("two", FACTOR), ("two", ALPHA), ("four", ALPHA), ("none", ALPHA)]
    row(
        *(
            lambda tree, of=of, name=name, output=output: add(tree, *attribute(of, name)).outputs[output]
            for of in ("OBJECT", "VIEW_LAYER")
            for name, output in wanted
        )
    )
    with_properties(*(made for made in bpy.context.scene.objects if made.type == "MESH"))


@scene
def arithmetic():
    row(
        math("ADD", 0.3, 0.4),
        math("POWER", 0.5, 3),
        math("POWER", -0.5, 2),
        math("DIVIDE", 0.5, 0),
        math("SUBTRACT", 1.5, 0.2, clamp=True),
        math("MULTIPLY_ADD", 0.5, 0.5, 0.3),
    )


@scene
def arithmetic_of_an_image():
    """The power of a negative base, texel by texel."""

    def build(tree):
        shifted = add(tree, "Math", {"operation": "SUBTRACT"})
        tree.links.new(colors(tree), shifted.inputs[0])
        shifted.inputs[1].default_value = 0.6
        node = add(tree, "Math", {"operation": "POWER"})
        tree.links.new(shifted.outputs[0], node.inputs[0])
        node.inputs[1].default_value = 2
        return node.outputs[0]

    def inverted(tree):
        return add(tree, "Invert", Fac=0.8, Color=colors(tree)).outputs[0]

    def gamma(tree):
        return add(tree, "Gamma", Color=colors(tree), Gamma=2.2).outputs[0]

    def contrast(tree):
        return add(tree, "BrightContrast", Color=colors(tree), Bright=0.1, Contrast=0.4).outputs[0]

    row(build, inverted, gamma, contrast)


def blended(blend):
    return lambda tree: add(
        tree, "MixRGB", {"blend_type": blend}, Fac=0.7, Color1=colors(tree), Color2=(0.3, 0.6, 0.4, 1)
    ).outputs[0]


@scene
def blends():
    row(
        *(
            blended(blend)
            for blend in ("MIX", "ADD", "MULTIPLY", "SCREEN", "SUBTRACT", "DIFFERENCE", "DARKEN", "LIGHTEN")
        )
    )


@scene
def mix_node():
    """The newer one, of colours and of numbers."""

    def build(tree):
        node = add(tree, "Mix", {"data_type": "RGBA", "blend_type": "MULTIPLY"})
        factor, a, b = (socket for socket in node.inputs if socket.enabled)
        feed(tree, factor, 0.5)
        feed(tree, a, colors(tree))
        feed(tree, b, (0.2, 0.9, 0.5, 1))
        return next(socket for socket in node.outputs if socket.enabled)

    def numbers(tree):
        node = add(tree, "Mix", {"data_type": "FLOAT"})
        factor, a, b = (socket for socket in node.inputs if socket.enabled)
        for socket, value in ((factor, 0.25), (a, 0.8), (b, 0.2)):
            feed(tree, socket, value)
        return next(socket for socket in node.outputs if socket.enabled)

    row(build, numbers)


@scene
def channels():
    def swapped(tree):
        parts = add(tree, "SeparateColor", Color=colors(tree)).outputs
        return add(tree, "CombineColor", Red=parts[2], Green=parts[0], Blue=parts[1]).outputs[0]

    def grey(tree):
        return add(tree, "RGBToBW", Color=colors(tree)).outputs[0]

    row(swapped, grey)


@scene
def muted():
    """Passed through where there is a way, else the socket's own value; a colour through a muted Math is grey."""

    def through(tree):
        return add(tree, "Gamma", {"mute": True}, Color=colors(tree), Gamma=3.0).outputs[0]

    def grey(tree):
        node = add(tree, "Math", {"operation": "MULTIPLY", "mute": True})
        tree.links.new(colors(tree), node.inputs[0])
        return node.outputs[0]

    def no_way(tree):
        return add(tree, "TexImage", {"image": image("Colours", gradient(4, 4), floats=True), "mute": True}).outputs[
            "Color"
        ]

    row(through, grey, no_way)


@scene
def muted_shaders():
    def through(tree):
        first = add(tree, "BsdfDiffuse", Color=(0.8, 0.2, 0.1, 1))
        node = tree.nodes.new("ShaderNodeAddShader")
        node.mute = True
        tree.links.new(first.outputs[0], node.inputs[0])
        return node.outputs[0]

    def none(tree):
        return add(tree, "BsdfDiffuse", {"mute": True}).outputs[0]

    shaders(through, none)


@scene
def muted_link():
    def build(tree):
        node = add(tree, "Gamma", Gamma=1.0)
        node.inputs["Color"].default_value = 0.2, 0.7, 0.3, 1
        tree.links.new(colors(tree), node.inputs["Color"])
        if hasattr(node.inputs["Color"].links[0], "is_muted"):
            node.inputs["Color"].links[0].is_muted = True
        return node.outputs[0]

    row(build)


@scene
def reroutes():
    """One that leads on, and one with nothing behind it."""

    def led(tree):
        node = tree.nodes.new("NodeReroute")
        tree.links.new(colors(tree), node.inputs[0])
        return node.outputs[0]

    def empty(tree):
        return tree.nodes.new("NodeReroute").outputs[0]

    row(led, empty)


def group(name, inputs, build):
    """A group with these (name, kind) inputs, whose Color is the socket that build(tree, input node) returns."""
    tree = bpy.data.node_groups.new(name, "ShaderNodeTree")
    for socket, kind in inputs:
        compat.add_group_socket(tree, socket, kind, "INPUT")
    compat.add_group_socket(tree, "Color", "NodeSocketColor", "OUTPUT")
    entry, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    tree.links.new(build(tree, entry), end.inputs[0])
    return tree


@scene
def groups():
    """One used twice with other inputs, and one whose number is fed with a colour."""
    tinted = group(
        "Tinted",
        [("Tint", "NodeSocketColor")],
        lambda tree, entry: add(
            tree, "MixRGB", {"blend_type": "MULTIPLY"}, Fac=1.0, Color1=colors(tree), Color2=entry.outputs[0]
        ).outputs[0],
    )
    number = group(
        "Number",
        [("Value", "NodeSocketFloat")],
        lambda tree, entry: add(tree, "Gamma", Color=entry.outputs[0], Gamma=1.0).outputs[0],
    )

    def used(tree_of, value):
        def build(tree):
            node = add(tree, "Group", {"node_tree": tree_of})
            if value is None:
                tree.links.new(colors(tree), node.inputs[0])
            else:
                node.inputs[0].default_value = value
            return node.outputs[0]

        return build

    row(used(tinted, (1, 0.4, 0.4, 1)), used(tinted, (0.4, 1, 0.4, 1)), used(number, 0.6), used(number, None))


@scene
def output_in_a_group():
    """Cycles takes an output inside a group before the one outside."""
    inner = bpy.data.node_groups.new("Inner", "ShaderNodeTree")
    shader = add(inner, "BsdfDiffuse", Color=(0.2, 0.3, 0.8, 1))
    inner.links.new(shader.outputs[0], inner.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])

    def build(tree):
        add(tree, "Group", {"node_tree": inner})
        return add(tree, "BsdfDiffuse", Color=(0.8, 0.3, 0.2, 1)).outputs[0]

    shaders(build)


@scene
def muted_output():
    def build(tree):
        for node in tree.nodes:
            node.mute = True
        return add(tree, "BsdfDiffuse", Color=(0.8, 0.3, 0.2, 1)).outputs[0]

    shaders(build, lambda tree: add(tree, "BsdfDiffuse", Color=(0.8, 0.3, 0.2, 1)).outputs[0])


@scene
def outputs():
    """One for each engine: Cycles' is taken."""

    def build(tree):
        other = tree.nodes.new("ShaderNodeOutputMaterial")
        other.target = "EEVEE"
        tree.links.new(add(tree, "BsdfDiffuse", Color=(0.2, 0.3, 0.8, 1)).outputs[0], other.inputs["Surface"])
        tree.nodes[0].target = "CYCLES"
        return add(tree, "BsdfDiffuse", Color=(0.8, 0.3, 0.2, 1)).outputs[0]

    shaders(build)


@scene
def shader_sums():
    def added(tree):
        node = tree.nodes.new("ShaderNodeAddShader")
        tree.links.new(add(tree, "BsdfDiffuse", Color=(0.4, 0.1, 0.1, 1)).outputs[0], node.inputs[0])
        tree.links.new(add(tree, "Emission", Color=(0.1, 0.3, 0.1, 1)).outputs[0], node.inputs[1])
        return node.outputs[0]

    def mixed(tree):
        node = add(tree, "MixShader", Fac=0.3)
        tree.links.new(add(tree, "BsdfDiffuse", Color=colors(tree)).outputs[0], node.inputs[1])
        tree.links.new(add(tree, "BsdfDiffuse", Color=(0.1, 0.8, 0.1, 1)).outputs[0], node.inputs[2])
        return node.outputs[0]

    def by_image(tree):
        node = add(tree, "MixShader", Fac=colors(tree))
        tree.links.new(add(tree, "BsdfDiffuse", Color=(0.8, 0.1, 0.1, 1)).outputs[0], node.inputs[1])
        tree.links.new(add(tree, "BsdfDiffuse", Color=(0.1, 0.8, 0.1, 1)).outputs[0], node.inputs[2])
        return node.outputs[0]

    shaders(added, mixed, by_image, lambda tree: None)


@scene
def color_as_surface():
    """It shines."""
    shaders(colors)


@scene
def negative_emission():
    """It takes light away."""

    def build(tree):
        node = tree.nodes.new("ShaderNodeAddShader")
        tree.links.new(add(tree, "BsdfDiffuse", Color=(0.8, 0.8, 0.8, 1)).outputs[0], node.inputs[0])
        emission = add(tree, "Emission", Color=(0.3, 0.2, 0.1, 1), Strength=-1.0)
        tree.links.new(emission.outputs[0], node.inputs[1])
        return node.outputs[0]

    shaders(build)


def neutral(kind, output, settings=None, **inputs):
    return lambda tree: add(tree, kind, settings, **inputs).outputs[output]


@scene
def fallbacks():
    """What a surface alone cannot say is neutral: nothing near is occluded, nothing is an edge."""
    row(
        neutral("AmbientOcclusion", "Color", Color=(0.7, 0.4, 0.2, 1), Distance=0.01),
        neutral("Wireframe", "Fac", Size=1e-4),
        neutral("Blackbody", "Color", Temperature=1200.0),
        neutral("Attribute", "Color", {"attribute_name": "nothing"}),
    )


@scene
def fine_checker():
    row(neutral("TexChecker", "Color", Color1=(0.8, 0.2, 0.2, 1), Color2=(0.2, 0.3, 0.8, 1), Scale=997.0))


@scene
def hidden_outputs():
    """A link from an output that another setting of its node has hidden."""

    def build(tree):
        node = add(tree, "Mix", {"data_type": "RGBA"})
        for socket in node.inputs:
            if socket.type == "RGBA":
                socket.default_value = 0.2, 0.6, 0.3, 1
        link = next(socket for socket in node.outputs if socket.enabled)
        gamma = add(tree, "Gamma", Gamma=1.0)
        gamma.inputs["Color"].default_value = 0.8, 0.1, 0.1, 1
        tree.links.new(link, gamma.inputs["Color"])
        node.data_type = "FLOAT"
        return gamma.outputs[0]

    row(build)


@scene(without=(5, 2))  # there every material has nodes, at first a Principled BSDF
def without_nodes():
    """The colours of the viewport."""
    stage()
    of = bpy.data.materials.new("Plain")
    of.diffuse_color = 0.2, 0.5, 0.8, 1
    of.use_nodes = False
    box(of)


@scene
def empty_tree():
    """Nothing in it is black."""
    daylight()
    face_on()
    of, tree, _ = material()
    tree.nodes.clear()
    sheet(of, size=1)
    sheet(diffuse(), size=3).location.z = -1


def switched(tree, kind):
    """A menu's switch whose second item is chosen."""
    node = tree.nodes.new("GeometryNodeMenuSwitch")
    node.data_type = kind
    node.inputs[0].default_value = "B"
    return node


@scene(since=(5, 0))
def of_other_kinds_of_trees():
    """Constants, menus, bundles and the time, which materials have had since then."""
    bpy.context.scene.frame_set(3)

    def constants(tree):
        whole, on, vector = (tree.nodes.new(f"FunctionNodeInput{kind}") for kind in ("Int", "Bool", "Vector"))
        whole.integer, on.boolean, vector.vector = 3, True, (0.2, 0.05, 0.1)
        scaled = add(tree, "VectorMath", {"operation": "SCALE"}, Vector=vector.outputs[0], Scale=whole.outputs[0])
        product = add(tree, "VectorMath", {"operation": "MULTIPLY"}, Vector=scaled.outputs[0])
        tree.links.new(on.outputs[0], product.inputs[1])
        return product.outputs[0]

    def menu(tree):
        node = switched(tree, "RGBA")
        node.inputs["A"].default_value, node.inputs["B"].default_value = (0.8, 0.1, 0.1, 1), (0.1, 0.8, 0.1, 1)
        return node.outputs[0]

    def bundle(tree):
        made, taken = tree.nodes.new("NodeCombineBundle"), tree.nodes.new("NodeSeparateBundle")
        for node in (made, taken):
            node.bundle_items.new("RGBA", "Paint")
        made.inputs["Paint"].default_value = 0.8, 0.4, 0.1, 1
        tree.links.new(made.outputs[0], taken.inputs[0])
        return taken.outputs["Paint"]

    def time(tree):
        node = tree.nodes.new("GeometryNodeInputSceneTime")
        return add(
            tree, "CombineXYZ", X=math_of(tree, node, "Frame", 0.2), Y=math_of(tree, node, "Seconds", 4.0)
        ).outputs[0]

    def math_of(tree, node, name, factor):
        product = add(tree, "Math", {"operation": "MULTIPLY"})
        tree.links.new(node.outputs[name], product.inputs[0])
        product.inputs[1].default_value = factor
        return product.outputs[0]

    row(constants, menu, bundle, time)


@scene(since=(5, 0))
def menus_of_shaders():
    def chosen(tree):
        node = switched(tree, "SHADER")
        tree.links.new(add(tree, "BsdfDiffuse", Color=(0.8, 0.1, 0.1, 1)).outputs[0], node.inputs["A"])
        tree.links.new(add(tree, "BsdfDiffuse", Color=(0.1, 0.8, 0.1, 1)).outputs[0], node.inputs["B"])
        return node.outputs[0]

    shaders(chosen)
