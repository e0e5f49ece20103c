# SPDX-License-Identifier: GPL-3.0-or-later
"""Zones that repeat and closures, which Blender takes out of the trees of materials, worlds and lamps since 5.0."""

import bpy
from stage import box, camera, floor, lamp, scene, sky
from trees import Tree

from .nodes import row, shaders

NUMBER, COLOR = [("FLOAT", "X")], [("RGBA", "C")]


def texture(t, vector, scale=3.0):
    return t.node("ShaderNodeTexNoise", vector, scale).outputs["Color"]


def place(t):
    return t.node("ShaderNodeTexCoord").outputs["Object"]


def warped(t, iterations, vector):
    """A pattern whose place is looked up in itself, and a colour that is mixed with it by the number of the iteration."""
    start, end = t.repeat([("VECTOR", "V"), ("RGBA", "C"), ("FLOAT", "W")], iterations, vector, (0.9, 0.3, 0.1, 1), 0.8)
    found = texture(t, start.outputs["V"])
    share = t.math("DIVIDE", start.outputs["W"], t.math("ADD", start.outputs["Iteration"], 1.0))
    t.feed(end.inputs["V"], t.node("ShaderNodeVectorMath", found, start.outputs["V"], operation="ADD").outputs[0])
    t.feed(end.inputs["C"], t.node("ShaderNodeMix", share, start.outputs["C"], found, data_type="RGBA").outputs[2])
    t.feed(end.inputs["W"], t.math("MULTIPLY", start.outputs["W"], 0.9))
    return end.outputs["C"]


def in_a_group(t):
    inside, entry, leaves = t.group([("INT", "N"), ("VECTOR", "V")], COLOR)
    inside.feed(leaves[0], warped(inside, entry["N"], entry["V"]))
    return t.use(inside, 2, place(t))[0]


def nested(t):
    """As many iterations inside as the number of that around them tells."""
    start, end = t.repeat([("VECTOR", "V")], 3, place(t))
    inner, inner_end = t.repeat([("VECTOR", "V")], start.outputs["Iteration"], start.outputs["V"])
    t.feed(inner_end.inputs["V"], texture(t, inner.outputs["V"], 4.0))
    t.feed(
        end.inputs["V"],
        t.node("ShaderNodeVectorMath", inner_end.outputs["V"], (0.6, 0.7, 0.8), operation="MULTIPLY").outputs[0],
    )
    return end.outputs["V"]


@scene(since=(5, 0))
def repeated():
    """Often, never, as often as a group is told, in each other, and as often as nothing says that Blender could know."""

    def built(build):
        return lambda tree: build(Tree(tree))

    row(
        built(lambda t: warped(t, 3, place(t))),
        built(lambda t: warped(t, 0, place(t))),
        built(in_a_group),
        built(nested),
        built(lambda t: warped(t, t.path("Ray Depth"), place(t))),
    )


def pattern(t, scale=3.0):
    """The closure of a place -> a colour there; the scale comes from outside."""
    start, end = t.closure([("VECTOR", "V")], COLOR)
    t.feed(end.inputs["C"], texture(t, start.outputs["V"], scale))
    return end.outputs[0]


def evaluated(t, closure, place):
    return t.evaluate(closure, [("VECTOR", "V")], COLOR, place)[0]


def twice(t):
    """Of a bundle, in itself."""
    closure = t.separate(t.bundle([("CLOSURE", "F"), ("INT", "N")], pattern(t), 1), [("CLOSURE", "F")])[0]
    return evaluated(t, closure, evaluated(t, closure, place(t)))


def handed_into_a_group(t):
    inside, entry, leaves = t.group([("CLOSURE", "F"), ("VECTOR", "V")], COLOR)
    inside.feed(leaves[0], evaluated(inside, entry["F"], entry["V"]))
    return t.use(inside, pattern(t, 6.0), place(t))[0]


def in_a_repeat_zone(t):
    """Made in the first iterations, of which it keeps the number, and evaluated after the last."""
    start, end = t.repeat([("CLOSURE", "F")], 4)
    t.feed(end.inputs["F"], pattern(t, t.math("ADD", start.outputs["Iteration"], 1.0)))
    return evaluated(t, end.outputs["F"], place(t))


def of_another_signature(t):
    """A number for a colour, and an input that it is not given."""
    start, end = t.closure([("RGBA", "C"), ("RGBA", "D")], COLOR)
    mixed = t.node("ShaderNodeMix", 0.25, start.outputs["C"], start.outputs["D"], data_type="RGBA").outputs[2]
    t.feed(end.inputs["C"], mixed)
    given = t.math("FRACT", t.node("ShaderNodeSeparateXYZ", place(t)).outputs[0])
    return t.evaluate(end.outputs[0], [("FLOAT", "C")], COLOR, given)[0]


@scene(since=(5, 0))
def closures():
    row(
        *(
            lambda tree, build=build: build(Tree(tree))
            for build in (twice, handed_into_a_group, in_a_repeat_zone, of_another_signature)
        )
    )


@scene(since=(5, 0))
def of_shaders():
    """Shaders that are mixed again and again, and by a closure; nothing of a tree whose zone is left; and what converts."""

    def mixed(tree):
        t = Tree(tree)
        start, end = t.repeat(
            [("SHADER", "S"), ("FLOAT", "W")], 3, t.node("ShaderNodeEmission", (0.1, 0.2, 0.6, 1)).outputs[0], 0.7
        )
        moved = t.node("ShaderNodeVectorMath", place(t), start.outputs["Iteration"]).outputs[0]
        diffuse = t.node("ShaderNodeBsdfDiffuse", texture(t, moved))
        t.feed(
            end.inputs["S"],
            t.node("ShaderNodeMixShader", start.outputs["W"], start.outputs["S"], diffuse.outputs[0]).outputs[0],
        )
        t.feed(end.inputs["W"], t.math("MULTIPLY", start.outputs["W"], 0.8))
        return end.outputs["S"]

    def closure(tree):
        t = Tree(tree)
        start, end = t.closure([("SHADER", "S"), ("FLOAT", "W")], [("SHADER", "S")])
        gloss = t.node("ShaderNodeBsdfAnisotropic", (0.8, 0.5, 0.2, 1)).outputs[0]
        t.feed(end.inputs["S"], t.node("ShaderNodeMixShader", start.outputs["W"], start.outputs["S"], gloss).outputs[0])
        given = t.node("ShaderNodeBsdfDiffuse", (0.1, 0.7, 0.2, 1)).outputs[0], 0.3
        return t.evaluate(end.outputs[0], [("SHADER", "S"), ("FLOAT", "W")], [("SHADER", "S")], *given)[0]

    def left(tree):
        t = Tree(tree)
        start, end = t.repeat([("FLOAT", "X")], 2, 0.2)
        t.feed(end.inputs["X"], t.math("ADD", start.outputs["X"], 0.1))
        return t.node("ShaderNodeBsdfDiffuse", t.math("ADD", start.outputs["X"], end.outputs["X"])).outputs[0]

    def whole(tree):
        """A number that Blender knows is a whole one from here on; and one of coordinates is not."""
        t = Tree(tree)
        start, end = t.repeat(
            [("INT", "N"), ("INT", "M")],
            2,
            t.math("ADD", 0.5, 0.7),
            t.node("ShaderNodeSeparateXYZ", place(t)).outputs[0],
        )
        for name in "NM":
            t.feed(end.inputs[name], start.outputs[name])
        return t.node("ShaderNodeEmission", end.outputs["M"], t.math("MULTIPLY", end.outputs["N"], 0.5)).outputs[0]

    shaders(mixed, closure, left, whole)


@scene(since=(5, 0))
def of_light():
    """Of a world and of a lamp."""
    floor()
    box()
    camera()
    tree = sky((1, 1, 1), 0.5)
    t = Tree(tree)
    start, end = t.repeat([("VECTOR", "V")], 2, t.node("ShaderNodeTexCoord").outputs["Generated"])
    t.feed(end.inputs["V"], texture(t, start.outputs["V"], 2.0))
    t.feed(tree.nodes["Background"].inputs["Color"], end.outputs["V"])
    made = lamp("POINT", (1, -2, 3), 300)
    made.data.use_nodes = True
    t = Tree(made.data.node_tree)
    shine = next(node for node in t.tree.nodes if node.bl_idname == "ShaderNodeEmission")
    t.feed(shine.inputs["Color"], evaluated(t, pattern(t, 2.0), t.node("ShaderNodeTexCoord").outputs["Normal"]))


@scene(since=(5, 0))
def open_inputs_of_groups():
    """A vector that nothing feeds, of a group that shows its value, and of one that does not."""
    picture = bpy.data.images.new("I", 4, 4, float_buffer=True)
    picture.pixels = [x for i in range(16) for x in (i / 16, (i % 4) / 4, 0.3, 1)]

    def used(kind, hidden, **settings):
        def build(tree):
            t = Tree(tree)
            inside, entry, leaves = t.group([("VECTOR", "V")], COLOR)
            inside.tree.interface.items_tree["V"].hide_value = hidden
            inside.feed(leaves[0], inside.node(kind, entry["V"], **settings).outputs["Color"])
            return t.use(inside)[0]

        return build

    row(
        *(used("ShaderNodeTexImage", hidden, image=picture) for hidden in (True, False)),
        *(used("ShaderNodeTexNoise", hidden) for hidden in (True, False)),
    )


@scene(since=(5, 0))
def open_normals_of_groups():
    """The same of normals, one of which is then no unit vector, one is nothing."""

    def used(hidden, value=(0, 0, 0), kind="ShaderNodeBsdfDiffuse"):
        def build(tree):
            t = Tree(tree)
            inside, entry, leaves = t.group([("VECTOR", "V")], [("SHADER", "S")])
            inside.tree.interface.items_tree["V"].hide_value = hidden
            made = inside.node(kind, (0.8, 0.4, 0.2, 1))
            inside.feed(made.inputs["Normal"], entry["V"])
            inside.feed(leaves[0], made.outputs[0])
            return t.use(inside, value)[0]

        return build

    shaders(used(True), used(False), used(False, (0.5, 0, 0.7)), used(False, (0, 0, 0), "ShaderNodeBsdfAnisotropic"))
