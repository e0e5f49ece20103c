# SPDX-License-Identifier: GPL-3.0-or-later
"""Warnings that are seen: whose each is, once each in the background, and a click that selects."""

from __future__ import annotations

import types
from unittest import mock

import bpy
from support import RenderTest, SceneTest
from wardmis import warning_panels, warnings

SCRIPT = """
import os
bpy.context.view_layer.use_pass_mist = True
material = bpy.data.materials.new("Glass")
material.use_nodes = True
tree = material.node_tree
tree.links.new(tree.nodes.new("ShaderNodeBsdfToon").outputs[0], tree.get_output_node("ALL").inputs["Surface"])
bpy.data.objects["Cube"].data.materials[0] = material
"""


class InTheBackground(RenderTest):
    def test_once_each_for_all_frames_and_layers(self):
        run = self.run_blender(
            SCRIPT + "scene.frame_end = 3\nscene.view_layers.new('Second')\n", "--render-anim", fake="good"
        )
        self.assertEqual((run.code, len(run.calls)), (0, 6), run.output)
        told = [line for line in run.output.splitlines() if line.startswith("WardMIS: ")]
        said = [line for line in told if line.startswith("WardMIS: warning: ")]
        self.assertEqual(len(said), len(set(said)), told)
        self.assertEqual(len([line for line in said if "material 'Glass' on object 'Cube'" in line]), 1, told)
        self.assertIn("WardMIS: warning: this renderer is a fake", said)
        self.assertIn("WardMIS: warning: view layer 'ViewLayer': there is no pass Mist; it is left out", said)
        self.assertEqual(told[-1], f"WardMIS: {len(said)} warnings, named above")
        self.assertEqual(len(told), len(said) + 1, told)

    def test_they_are_not_among_blenders_lines(self):
        from support import blender

        process = blender(self.folder, SCRIPT, "--render-frame", "1")
        output, errors = process.communicate(timeout=120)
        self.assertNotIn("WardMIS: ", output)
        self.assertIn("WardMIS: warning: ", errors)

    def test_a_failure_has_its_warnings_too(self):
        run = self.run_blender(SCRIPT, fake="exit3")
        self.assertEqual(run.code, 1)
        self.assertIn("WardMIS: warning: material 'Glass' on object 'Cube'", run.output)


class Text(RenderTest):
    """What stands beside the time of a render, also when it has ended."""

    SHOWN = """
from wardmis import engine
engine.WARDMIS_RenderEngine.keep_text = lambda self, text: print("text:", text, flush=True)
"""

    def test_cancelled_in_every_state(self):
        for state, fake in (("True", "good"), ("self.started", "slow")):
            run = self.run_blender(f"{self.SHOWN}engine._Render._stopped = lambda self: {state}\n", fake=fake)
            self.assertEqual((run.code, run.output.count("text: Cancelled")), (1, 1), run.output)

    def test_failed(self):
        self.assertIn("text: Failed", self.run_blender(self.SHOWN, fake="exit3").output)


class Layout:
    """Records what is drawn."""

    def __init__(self):
        self.drawn, self.buttons = [], []

    def label(self, text="", icon="NONE"):
        self.drawn.append(text)

    def operator(self, name, text="", **_):
        self.drawn.append(text or name)
        self.buttons.append(types.SimpleNamespace(name="", material=""))
        return self.buttons[-1]

    def icon(self, _obj):
        return 1

    def part(self, **_):
        return self

    box = column = row = part


class Shown(SceneTest):
    def setUp(self):
        super().setUp()
        self.layer = bpy.context.view_layer
        self.place = self.scene.name, self.layer.name
        quiet = mock.patch.object(warnings, "_tell", lambda _text: None)
        quiet.start()
        self.addCleanup(quiet.stop)
        warnings.begin(*self.place)
        self.addCleanup(warnings.begin, *self.place)

    def glass(self, *objects):
        material = bpy.data.materials.new("Glass")
        material.use_nodes = True
        tree = material.node_tree
        glass = tree.nodes.new("ShaderNodeBsdfToon")
        tree.links.new(glass.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
        for obj in objects:
            obj.data.materials.append(bpy.data.materials.new("Plain"))
            obj.data.materials.append(material)

    def export(self):
        self.layer.update()
        for note in self.gather().notes:
            warnings.add(*self.place, note)
        return warnings.of_scene(self.scene)

    def test_each_names_its_object(self):
        first, second = self.add_quad("It's a 'quad'"), self.add_quad("Second")
        self.glass(first)
        self.glass(second)
        lamp = self.add("Lamp", bpy.data.lights.new("Data of the lamp", "POINT"))
        lamp.data.energy = -1
        found = {warning.owner: warning.text for warning in self.export()}
        self.assertLessEqual({"It's a 'quad'", "Second"}, set(found), found)
        self.assertIn("Glass", found["It's a 'quad'"])
        for warning in warnings.of_scene(self.scene):
            self.assertNotIn("object '", warning.short)
            self.assertIn(f"'{warning.owner}'", warning.full)

    def test_an_owner_that_the_text_does_not_name(self):
        mesh = self.add_quad("Floor")
        from wardmis.export.context import Note

        warnings.add(*self.place, Note("image 'brick.png' has no pixels", mesh.name))
        warnings.add(*self.place, "object 'Floor': told by the renderer, which knows names alone")
        warnings.add(*self.place, "a thing of the whole scene")
        warnings.add(*self.place, "a thing of the whole scene")
        found = warnings.of_scene(self.scene)
        self.assertEqual([warning.owner for warning in found], ["Floor", "Floor", ""])
        self.assertEqual(warnings.count_text(len(found)), "3 warnings")

    def test_panel_counts_and_a_click_selects(self):
        context = types.SimpleNamespace(scene=self.scene)
        self.assertFalse(warning_panels._Warnings.poll(context))
        first, second = self.add_quad("First"), self.add_quad("Second")
        self.glass(second)
        self.export()
        self.assertTrue(warning_panels._Warnings.poll(context))
        layout = Layout()
        panel = types.SimpleNamespace(layout=layout)
        warning_panels._Warnings.draw_header(panel, context)
        self.assertEqual(layout.drawn, ["1"])
        warning_panels.draw_warnings(layout, self.scene)
        self.assertIn("Second", layout.drawn)
        button = layout.buttons[0]
        self.assertEqual((button.name, button.material), ("Second", "Glass"))
        first.select_set(True)
        self.layer.objects.active = first
        self.assertEqual(bpy.ops.wardmis.show_owner(name=button.name, material=button.material), {"FINISHED"})
        self.assertEqual([obj.name for obj in self.layer.objects if obj.select_get()], ["Second"])
        self.assertEqual((self.layer.objects.active, second.active_material.name), (second, "Glass"))
        second.hide_set(True)
        self.assertEqual(bpy.ops.wardmis.show_owner(name="Second"), {"FINISHED"})
        bpy.data.objects.remove(second)
        self.assertEqual(bpy.ops.wardmis.show_owner(name="Second"), {"CANCELLED"})

    def test_many_objects_leave_the_panel_its_size(self):
        for i in range(100):
            warnings.add(*self.place, f"object '{self.add_quad(f'Quad {i}').name}': something")
        layout = Layout()
        warning_panels.draw_warnings(layout, self.scene)
        self.assertEqual(sum(text.startswith("Quad ") for text in layout.drawn), warning_panels.MOST_OWNERS)
        self.assertTrue(any("80 more objects" in text for text in layout.drawn))

    def test_another_file_begins_without(self):
        warnings.add(*self.place, "something")
        warnings._on_load()
        self.assertEqual(warnings.of_scene(self.scene), [])
