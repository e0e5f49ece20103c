# SPDX-License-Identifier: GPL-3.0-or-later
"""Zones, bundles and menus of materials, which Blender 5 takes out of a tree before Cycles sees it: from a tree the same is read as
from what Blender makes of it."""

import dataclasses
import random
import sys
import unittest
from pathlib import Path

import bpy
import numpy as np
from wardmis.export.context import ExportContext
from wardmis.export.image import export_image
from wardmis.export.material import export_material
from wardmis.export.unrolled import MOST_ITERATIONS

sys.path[:0] = [str(Path(__file__).resolve().parents[1] / "cycles")]

from trees import Tree  # noqa: E402

X = [("FLOAT", "X")]


class Inlined:
    """A material whose tree is what Blender gives to Cycles."""

    def __init__(self, material):
        self._material, self._inlined = material, material.inline_shader_nodes()
        self.node_tree = self._inlined.node_tree

    def __getattr__(self, name):
        return getattr(self._material, name)


@unittest.skipIf(bpy.app.version < (5, 0, 0), "materials have zones since Blender 5.0")
class Zones(unittest.TestCase):
    def setUp(self):
        for collection in (bpy.data.materials, bpy.data.images, bpy.data.node_groups):
            bpy.data.batch_remove(list(collection))
        self.material = bpy.data.materials.new("M")
        self.t = Tree(self.material.node_tree)
        self.t.tree.nodes.clear()
        self.output = self.t.node("ShaderNodeOutputMaterial")
        self.context = ExportContext(export_image)

    def check(self, value):
        """That a value, of whichever kind, as what a surface shines comes to the same as Blender's own tree."""
        shines = value if value.type == "SHADER" else self.t.node("ShaderNodeEmission", value).outputs[0]
        self.t.feed(self.output.inputs["Surface"], shines)
        bpy.context.view_layer.update()
        self.context = ExportContext(export_image)
        found = export_material(self.material, self.context)
        expected = export_material(Inlined(self.material), ExportContext(export_image))
        self.assertAlike(dataclasses.asdict(found), dataclasses.asdict(expected))
        return found

    def assertAlike(self, a, b, where=""):
        """Blender computes constants in single precision, and with other digits of a colour's luminance."""
        if isinstance(a, dict):
            self.assertEqual(a.keys(), b.keys(), where)
            for key in a:
                self.assertAlike(a[key], b[key], f"{where}.{key}")
        elif isinstance(a, list | tuple):
            self.assertEqual(len(a), len(b), f"{where}: {a} {b}")
            for i, (x, y) in enumerate(zip(a, b)):
                self.assertAlike(x, y, f"{where}[{i}]")
        elif isinstance(a, float):
            self.assertTrue(np.isclose(a, b, 1e-4, 1e-6), f"{where}: {a} {b}")
        else:
            self.assertEqual(a, b, where)

    def assertNoted(self, *words):
        text = "\n".join(self.context.notes)
        for word in words:
            self.assertIn(word, text)

    # ---- repeat zones -----------------------------------------------------------------------------------------------

    def powers(self, iterations, first=0.5, t=None):
        """(x + 1/2) l, repeated."""
        t = t or self.t
        start, end = t.repeat(X, iterations, first)
        t.feed(end.inputs["X"], t.math("MULTIPLY", t.math("ADD", start.outputs["X"], 0.5), t.path()))
        return end.outputs["X"]

    def test_repeated(self):
        for count in (3, 1, 0, -2):
            with self.subTest(iterations=count):
                self.check(self.powers(count))
        self.assertEqual(self.context.notes, [])

    def test_nodes_of_zones_cannot_be_muted(self):
        for node in (*self.t.repeat(X, 2), *self.t.closure(X, X)):
            node.mute = True
            self.assertFalse(node.mute)

    def test_what_counts_as_a_constant_number_of_iterations(self):
        t = self.t
        for constant in (
            t.node("FunctionNodeInputInt", integer=3).outputs[0],
            t.math("ADD", 1.2, 1.7),
            t.node("ShaderNodeGamma", (3, 3, 3, 1), 1.0).outputs[0],
            t.node("ShaderNodeVectorMath", (1, 2, 3), (1, 1, 1)).outputs[0],
            t.node("ShaderNodeMix", 0.5, 1.0, 3.0).outputs[0],
        ):
            with self.subTest(constant.node.bl_idname):
                self.check(self.powers(constant))
        self.assertEqual(self.context.notes, [])
        for other in (
            t.path(),
            t.node("ShaderNodeRGB").outputs[0],
            t.node("ShaderNodeMix", t.path(), 2.0, 2.0).outputs[0],
            t.node("ShaderNodeTexChecker").outputs[1],
        ):
            with self.subTest(other.node.bl_idname):
                self.check(self.powers(other))
                self.assertNoted("no constant", "as in Cycles")

    def test_iteration_and_items_that_exchange_their_values(self):
        t = self.t
        start, end = t.repeat([("FLOAT", "A"), ("FLOAT", "B"), ("INT", "N")], 5, t.path(), 0.25, 3)
        t.feed(end.inputs["A"], t.math("ADD", start.outputs["B"], start.outputs["Iteration"]))
        t.feed(end.inputs["B"], t.math("MULTIPLY", start.outputs["A"], start.outputs["N"]))
        t.feed(end.inputs["N"], start.outputs["N"])
        self.check(t.math("SUBTRACT", end.outputs["A"], end.outputs["B"]))

    def test_what_items_convert(self):
        """Blender what it knows itself; the rest is handed on as it is."""
        t = self.t
        kinds = ["INT", "BOOLEAN", "FLOAT", "VECTOR", "RGBA"]
        color = t.node("ShaderNodeCombineXYZ", 0.2, 0.4, 2.6).outputs[0]
        for value in (t.math("ADD", 2.6, 0.0), color, t.path(), t.node("ShaderNodeTexCoord").outputs[0], None):
            for kind in kinds:
                with self.subTest(value and value.node.bl_idname, item=kind):
                    own = value if value else {"INT": 3, "BOOLEAN": True, "FLOAT": 1.5}.get(kind, (0.2, 0.4, 0.6))
                    own = (*own, 1.0) if value is None and kind == "RGBA" else own
                    start, end = t.repeat([(kind, "V")], 2, own)
                    t.feed(end.inputs["V"], start.outputs["V"])
                    self.check(end.outputs["V"])
                    self.check(t.math("ADD", end.outputs["V"], t.path()))

    def test_what_else_converts(self):
        """A node for that, and vectors of two and four numbers."""
        t = self.t
        color = t.node("ShaderNodeCombineXYZ", 0.2, 0.4, 2.6).outputs[0]
        for given in (color, t.node("ShaderNodeTexCoord").outputs[0], None):
            for kind in ("INT", "BOOLEAN", "FLOAT", "VECTOR", "RGBA"):
                node = t.tree.nodes.new("NodeImplicitConversion")
                node.data_type = kind
                t.feed(node.inputs[0], given)
                self.check(node.outputs[0])
                self.assertEqual(self.context.notes, [])
            for dimensions in (2, 3, 4):
                inside, entry, leaves = t.group([("VECTOR", "V")], [("RGBA", "C")])
                inside.tree.interface.items_tree["V"].dimensions = dimensions
                inside.feed(leaves[0], entry["V"])
                own = (0.2, 0.4, 0.6, 0.8)[:dimensions]
                self.check(t.use(inside, given or own)[0])

    def test_shaders_are_items(self):
        t = self.t
        for given in (None, t.node("ShaderNodeBsdfDiffuse").outputs[0], t.math("ADD", 0.7, 0.0), t.path()):
            start, end = t.repeat([("SHADER", "S"), ("FLOAT", "W")], 3, given, 0.5)
            t.feed(end.inputs["W"], t.math("MULTIPLY", start.outputs["W"], t.path()))
            gloss = t.node("ShaderNodeBsdfAnisotropic", (0.8, 0.5, 0.2, 1), start.outputs["W"]).outputs[0]
            t.feed(end.inputs["S"], t.node("ShaderNodeMixShader", 0.25, start.outputs["S"], gloss).outputs[0])
            self.check(end.outputs["S"])

    def test_nested(self):
        """Also where only what is repeated inside hangs on the zone around it."""
        t = self.t
        for given in (None, "X"):
            start, end = t.repeat(X, 3, 1.0)
            inner_start, inner_end = t.repeat(
                X, start.outputs["Iteration"], start.outputs[given] if given else t.path()
            )
            t.feed(inner_end.inputs["X"], t.math("ADD", inner_start.outputs["X"], start.outputs["Iteration"]))
            t.feed(end.inputs["X"], t.math("MULTIPLY", inner_end.outputs["X"], start.outputs["X"]))
            self.check(end.outputs["X"])

    def test_in_a_group_by_its_input(self):
        t = self.t
        inside, entry, leaves = t.group([("FLOAT", "V"), ("INT", "N")], X)
        inside.feed(leaves[0], self.powers(entry["N"], entry["V"], inside))
        both = [t.use(inside, value, count)[0] for value, count in ((0.3, 2), (t.path("Ray Depth"), 4))]
        self.check(t.math("ADD", *both))

    def test_images_and_patterns_inside(self):
        """Whose vectors nothing feeds, outside: none is of coordinates, unless neither side shows a value."""
        t = self.t
        image = bpy.data.images.new("I", 2, 2)
        for kind, settings in (("ShaderNodeTexImage", {"image": image}), ("ShaderNodeTexNoise", {})):
            start, end = t.repeat([("VECTOR", "V")], 2)
            texture = t.node(kind, start.outputs["V"], **settings)
            group, entry, leaves = t.group([("VECTOR", "V"), ("FLOAT", "S")], [("RGBA", "C")])
            inside = group.node(kind, entry["V"], **settings)
            for node, scale in ((texture, t.path()), (inside, entry["S"])):
                if "Scale" in node.inputs:  # else Blender would make the noise a number
                    node.id_data.links.new(scale, node.inputs["Scale"])
            t.feed(end.inputs["V"], texture.outputs["Color"])
            group.feed(leaves[0], inside.outputs["Color"])
            self.check(end.outputs["V"])
            for hidden in (False, True):
                group.tree.interface.items_tree["V"].hide_value = hidden
                self.check(t.use(group, None, t.path())[0])

    def test_more_iterations_than_can_be(self):
        start, end = self.t.repeat(X, MOST_ITERATIONS + 1, 0.0)
        self.t.feed(end.inputs["X"], self.t.math("ADD", start.outputs["X"], 1.0))
        self.t.feed(self.output.inputs[0], self.t.node("ShaderNodeEmission", None, end.outputs["X"]).outputs[0])
        found = export_material(self.material, self.context)
        self.assertEqual(found.emission.value, (MOST_ITERATIONS,) * 3)
        self.assertNoted(f"has {MOST_ITERATIONS + 1} iterations", "so many are used")

    def test_alpha_of_images_inside(self):
        """Whether it is used changes their colours; here it is in none but the second iteration."""
        t = self.t
        image = bpy.data.images.new("I", 2, 2, alpha=True)
        for switched in (0.0, 1.0):
            start, end = t.repeat([("VECTOR", "V")], 2, t.node("ShaderNodeTexCoord").outputs["UV"])
            texture = t.node("ShaderNodeTexImage", start.outputs["V"], image=image)
            share = t.math("MULTIPLY", start.outputs["Iteration"], switched)
            alpha = t.math("MULTIPLY", texture.outputs["Alpha"], share)
            t.feed(
                end.inputs["V"], t.node("ShaderNodeMixRGB", alpha, texture.outputs["Color"], (1, 0, 0, 1)).outputs[0]
            )
            self.check(end.outputs["V"])

    def test_many_iterations(self):
        """A chain of nodes that is longer than Python commonly calls; and more shaders than one can wait for."""
        start, end = self.t.repeat(X, 300, self.t.path())
        self.t.feed(end.inputs["X"], self.t.math("SINE", self.t.math("ADD", start.outputs["X"], 1.0)))
        self.check(end.outputs["X"])
        start, end = self.t.repeat([("SHADER", "S")], 1000, self.t.node("ShaderNodeBsdfDiffuse").outputs[0])
        self.t.feed(end.inputs["S"], self.t.node("ShaderNodeAddShader", *[start.outputs["S"]] * 2).outputs[0])
        self.t.feed(self.output.inputs[0], end.outputs["S"])
        self.context = ExportContext(export_image)
        export_material(self.material, self.context)
        self.assertNoted("more shaders")

    def test_half_a_zone(self):
        for kind, items in (("GeometryNodeRepeatOutput", "repeat_items"), ("NodeClosureOutput", "output_items")):
            end = self.t.node(kind)
            getattr(end, items).new("FLOAT", "Y")
            value = (
                end.outputs[0]
                if end.outputs[0].type == "VALUE"
                else self.t.evaluate(end.outputs[0], [], [("FLOAT", "Y")])[0]
            )
            self.check(value)
            self.assertNoted("has no partner")
        self.check(self.t.node("GeometryNodeRepeatInput").outputs[0])

    def test_zones_that_are_left_or_overlap(self):
        t = self.t
        leaky, end = t.repeat(X, 2)
        t.feed(end.inputs["X"], t.math("ADD", leaky.outputs["X"], 1.0))
        self.check(leaky.outputs["Iteration"])
        self.assertNoted("Blender makes nothing", "is in a zone")
        self.check(t.math("ADD", leaky.outputs["X"], end.outputs["X"]))
        self.assertNoted("Blender makes nothing", "left by a link")
        t.tree.links.clear()
        other, other_end = t.repeat(X, 2)
        both = t.math("ADD", leaky.outputs["X"], other.outputs["X"])
        t.feed(end.inputs["X"], both)
        t.feed(other_end.inputs["X"], both)
        self.check(end.outputs["X"])
        self.assertNoted("Blender makes nothing", "overlap")

    def test_circles(self):
        """Of links that are muted, too, and of a zone by what is not linked inside it."""
        t = self.t
        first = t.math("ADD", t.path(), 1.0)
        last = t.math("ADD", first, 1.0)
        t.feed(first.node.inputs[1], last)
        self.check(last)
        self.assertNoted("linked in a circle", "rendered as black, as in Cycles")
        next(link for link in t.tree.links if link.to_socket == first.node.inputs[1]).is_muted = True
        self.check(t.path())
        self.assertNoted("linked in a circle")
        t.tree.links.clear()
        start, end = t.repeat(X, 2)
        t.feed(start.inputs[0], end.outputs["X"])
        self.check(end.outputs["X"])
        self.assertNoted("linked in a circle")

    # ---- closures ---------------------------------------------------------------------------------------------------

    def scaled(self, by, t=None):
        """The closure of x -> x by."""
        t = t or self.t
        start, end = t.closure(X, [("FLOAT", "Y")])
        t.feed(end.inputs["Y"], t.math("MULTIPLY", start.outputs["X"], by))
        return end.outputs[0]

    def test_evaluated_twice(self):
        f = self.scaled(self.t.path())
        once = self.t.evaluate(f, X, [("FLOAT", "Y")], 3.0)[0]
        self.check(self.t.evaluate(f, X, [("FLOAT", "Y")], self.t.math("ADD", once, 1.0))[0])
        self.assertEqual(self.context.notes, [])

    def test_signatures_that_differ(self):
        t = self.t
        f = self.scaled(t.path())
        for inputs, outputs, words in (
            ([("FLOAT", "Z")], [("FLOAT", "Y")], ["gives no 'X'"]),
            (X, [("FLOAT", "Z")], ["finds no 'Z'"]),
            ([("FLOAT", "Closure"), *X], [("FLOAT", "Closure"), ("FLOAT", "Y")], []),
            ([("RGBA", "X")], [("RGBA", "Y")], []),
            ([("INT", "X")], [("VECTOR", "Y")], []),
        ):
            for given in (None, t.path(), t.math("ADD", 2.6, 0.0), t.node("ShaderNodeTexCoord").outputs[0]):
                self.check(t.evaluate(f, inputs, outputs, *[given] * len(inputs))[-2])
                self.assertNoted(*words)

    def test_no_closure(self):
        t = self.t
        for other in (None, t.path(), t.bundle(X, 1.0)):
            self.check(t.evaluate(other, X, [("FLOAT", "Y")], t.path())[0])
            self.assertNoted("no closure")
        muted = t.evaluate(self.scaled(t.path()), X, [("FLOAT", "Y")], 3.0)
        muted[0].node.mute = True
        self.check(muted[0])
        self.check(self.scaled(2.0))

    def test_recursion(self):
        t = self.t
        sockets = [("CLOSURE", "F"), *X]
        start, end = t.closure(sockets, [("FLOAT", "Y")])
        inner = t.evaluate(start.outputs["F"], sockets, [("FLOAT", "Y")], start.outputs["F"], start.outputs["X"])[0]
        t.feed(end.inputs["Y"], t.math("ADD", inner, t.path()))
        self.check(t.evaluate(end.outputs[0], sockets, [("FLOAT", "Y")], end.outputs[0], 1.0)[0])
        self.assertNoted("evaluates a closure in itself")

    def test_closures_and_groups(self):
        """One is handed into a group and sees what is outside; one comes out of it and sees the group's input; both at once."""
        t = self.t
        caller, entry, leaves = t.group([("CLOSURE", "F")], X)
        caller.feed(leaves[0], caller.evaluate(entry["F"], X, [("FLOAT", "Y")], 2.0)[0])
        into = t.use(caller, self.scaled(t.path()))[0]
        maker, entry, leaves = t.group(X, [("CLOSURE", "F")])
        maker.feed(leaves[0], self.scaled(entry["X"], maker))
        out = t.evaluate(t.use(maker, 0.75)[0], X, [("FLOAT", "Y")], t.path())[0]
        through = t.use(caller, t.use(maker, t.path())[0])[0]
        self.check(t.math("ADD", t.math("ADD", into, out), through))
        self.assertEqual(self.context.notes, [])

    def test_closures_and_repeat_zones(self):
        """Handed through, evaluated in each iteration; and made in an iteration, of which it keeps the number."""
        t = self.t
        start, end = t.repeat([("CLOSURE", "F"), *X], 3, self.scaled(t.path()), 0.5)
        t.feed(end.inputs["F"], start.outputs["F"])
        t.feed(end.inputs["X"], t.evaluate(start.outputs["F"], X, [("FLOAT", "Y")], start.outputs["X"])[0])
        self.check(end.outputs["X"])
        start, end = t.repeat([("CLOSURE", "F")], 3)
        t.feed(end.inputs["F"], self.scaled(t.math("ADD", start.outputs["Iteration"], t.path())))
        self.check(t.evaluate(end.outputs["F"], X, [("FLOAT", "Y")], t.path())[0])

    def test_repeat_zone_in_a_closure(self):
        t = self.t
        start, end = t.closure(X, [("FLOAT", "Y")])
        t.feed(end.inputs["Y"], self.powers(start.outputs["X"], start.outputs["X"]))
        self.check(t.evaluate(end.outputs[0], X, [("FLOAT", "Y")], 3.0)[0])
        self.check(t.evaluate(end.outputs[0], X, [("FLOAT", "Y")], t.path())[0])

    def test_closures_of_shaders(self):
        t = self.t
        start, end = t.closure([("SHADER", "S"), ("FLOAT", "W")], [("SHADER", "S")])
        gloss = t.node("ShaderNodeBsdfAnisotropic", (0.8, 0.5, 0.2, 1)).outputs[0]
        t.feed(end.inputs["S"], t.node("ShaderNodeMixShader", start.outputs["W"], start.outputs["S"], gloss).outputs[0])
        diffuse = t.node("ShaderNodeBsdfDiffuse").outputs[0]
        self.check(
            t.evaluate(end.outputs[0], [("SHADER", "S"), ("FLOAT", "W")], [("SHADER", "S")], diffuse, t.path())[0]
        )

    # ---- bundles and menus ------------------------------------------------------------------------------------------

    def test_bundles(self):
        t = self.t
        f = self.scaled(t.path())
        items = [("CLOSURE", "F"), ("RGBA", "C")]
        taken = t.separate(t.bundle([("BUNDLE", "B")], t.bundle(items, f, (0.2, 0.4, 0.6, 1))), [("BUNDLE", "B")])[0]
        parts = t.separate(taken, [("CLOSURE", "F"), ("FLOAT", "C"), ("FLOAT", "Lacking")])
        self.check(t.evaluate(parts["F"], X, [("FLOAT", "Y")], parts["C"])[0])
        self.check(parts["C"])
        self.check(parts["Lacking"])
        self.check(t.separate(None, X)[0])

    def test_joined_bundles(self):
        """Of several of one name one is taken."""
        t = self.t
        join = t.node("NodeJoinBundle")
        for names, value in (("A", 1.0), ("AB", 2.0), ("BC", 3.0)):
            t.feed(join.inputs[0], t.bundle([("FLOAT", name) for name in names], *[value] * len(names)))
        for part in list(t.separate(join.outputs[0], [("FLOAT", name) for name in "ABCD"]))[:4]:
            self.check(part)

    def test_bundles_and_menus_are_items(self):
        t = self.t
        start, end = t.repeat([("BUNDLE", "B")], 3, t.bundle(X, 0.5))
        inner = t.separate(start.outputs["B"], X)["X"]
        t.feed(end.inputs["B"], t.bundle(X, t.math("MULTIPLY", t.math("ADD", inner, 1.0), t.path())))
        self.check(t.separate(end.outputs["B"], X)["X"])
        menu = t.node("FunctionNodeInputMenu")
        start, end = t.repeat([("MENU", "M"), *X], 3, menu.outputs[0], 0.5)
        switch = t.node("GeometryNodeMenuSwitch", start.outputs["M"], data_type="FLOAT")
        t.feed(switch.inputs["A"], start.outputs["X"])
        t.feed(switch.inputs["B"], t.math("MULTIPLY", t.math("ADD", start.outputs["X"], 1.0), t.path()))
        t.feed(end.inputs["M"], start.outputs["M"])
        t.feed(end.inputs["X"], switch.outputs[0])
        bpy.context.view_layer.update()
        for item in "AB":
            menu.value = item
            self.check(end.outputs["X"])

    # ---- all of it --------------------------------------------------------------------------------------------------

    def test_trees_by_chance(self):
        for seed in range(60):
            with self.subTest(seed=seed):
                self.setUp()
                self.check(Chance(self.t, random.Random(seed)).number(self.t, [], 4))


class Chance:
    """Trees of numbers, colours, groups, zones and closures within each other."""

    def __init__(self, t, rng):
        self.rng, self.t = rng, t

    def leaf(self, t, pool):
        choices = [lambda: t.path(self.rng.choice(["Ray Length", "Ray Depth", "Is Camera Ray"]))]
        choices += [
            lambda: t.math("ADD", round(self.rng.uniform(0, 2), 2), 0.25),
            lambda: t.node("ShaderNodeRGB").outputs[0],
        ]
        choices += [lambda: self.rng.choice(pool)] * (3 if pool else 0)
        return self.rng.choice(choices)()

    def number(self, t, pool, depth):
        """A socket, from those of `pool` that may be linked to here, and new nodes."""
        if depth == 0:
            return self.leaf(t, pool)
        kind = self.rng.choice([self.sum, self.vector, self.repeated, self.evaluated, self.grouped, self.bundled])
        return kind(t, pool, depth - 1)

    def item(self):
        return self.rng.choice(["FLOAT", "FLOAT", "RGBA", "VECTOR", "INT"])

    def sum(self, t, pool, depth):
        operation = self.rng.choice(["ADD", "MULTIPLY", "SUBTRACT"])
        return t.math(operation, self.number(t, pool, depth), self.number(t, pool, depth))

    def vector(self, t, pool, depth):
        values = [self.number(t, pool, depth) for _ in range(2)]
        return t.node("ShaderNodeVectorMath", *values, operation="ADD").outputs[0]

    def repeated(self, t, pool, depth):
        items = [(self.item(), name) for name in "AB"[: self.rng.randint(1, 2)]]
        count = self.rng.choice([0, 1, 2, 3, self.leaf(t, pool)])
        given = [self.rng.choice([None, self.number(t, pool, depth)]) for _ in items]
        start, end = t.repeat(items, count, *given)
        inside = [*pool, *list(start.outputs)[:-1]]
        for socket in list(end.inputs)[:-1]:
            t.feed(socket, self.rng.choice([self.number(t, inside, depth)] * 3 + [None]))
        return self.rng.choice(list(end.outputs)[:-1])

    def evaluated(self, t, pool, depth):
        inputs, outputs = [(self.item(), "X")], [(self.item(), "Y")]
        start, end = t.closure(inputs, outputs)
        t.feed(end.inputs["Y"], self.number(t, [*pool, start.outputs["X"]], depth))
        values = []
        for _ in range(2):
            given = self.number(t, [*pool, *values], depth)
            values.append(t.evaluate(end.outputs[0], [(self.item(), "X")], [(self.item(), "Y")], given)[0])
        return t.math("ADD", *values)

    def grouped(self, t, pool, depth):
        kinds = self.item(), self.item()
        inside, entry, leaves = t.group([(kinds[0], "X")], [(kinds[1], "Y")])
        inside.feed(leaves[0], self.number(inside, [entry["X"]], depth))
        values = [t.use(inside, self.rng.choice([None, self.number(t, pool, depth)]))[0] for _ in range(2)]
        return t.math("ADD", *values)

    def bundled(self, t, pool, depth):
        given = t.bundle([(self.item(), "X")], self.number(t, pool, depth))
        return t.separate(given, [(self.item(), "X")])[0]
