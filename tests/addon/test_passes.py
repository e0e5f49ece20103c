# SPDX-License-Identifier: GPL-3.0-or-later
"""Passes that Cycles has, too, are called and made as Cycles' are, so that the compositor's links hold."""

import types

import bpy
from support import SceneTest
from wardmis import passes


class Passes(SceneTest):
    def registered(self, layer):
        found = []

        def register_pass(_scene, _layer, name, count, channels, kind):
            self.assertEqual(count, len(channels))
            found.append((name, channels, kind))

        passes.register_passes(types.SimpleNamespace(register_pass=register_pass), self.scene, layer)
        return found

    def test_names_are_those_of_cycles(self):
        from cycles import engine

        layer = bpy.context.view_layer
        for flag in passes.BLENDERS:
            setattr(layer, flag, True)
        theirs = [(name, channels, kind) for name, channels, kind in engine.list_render_passes(self.scene, layer)]
        ours = self.registered(layer)
        self.assertEqual(len(ours), 1 + len(passes.BLENDERS))
        for each in ours:
            self.assertIn(each, theirs)

    def test_what_another_engine_would_make_is_not_available(self):
        layer = bpy.context.view_layer
        layer.use_pass_z = layer.use_pass_mist = True
        layer.cycles.denoising_store_passes = layer.cycles.use_pass_shadow_catcher = True
        layer.aovs.add().name = "Mask"
        layer.lightgroups.add(name="Key")
        expected = ["Mist", "Shadow Catcher", "Denoising Data"]
        expected += ["of shader outputs, 'Mask' (AOV)", "of the light group 'Key'"]
        self.assertEqual(list(passes.not_available(layer)), expected)

    def test_option_names_what_this_blender_calls_otherwise(self):
        layer = bpy.context.view_layer
        layer.use_pass_object_index = layer.use_pass_glossy_indirect = layer.use_pass_z = True
        option = passes.passes_option(layer).split(",")
        self.assertEqual(option[:2], ["combined", "depth"])
        names = dict(part.split("=") for part in option[2:])
        new = bpy.app.version >= (5, 0, 0)
        expected = {
            "object-index": "Object Index" if new else "IndexOB",
            "glossy-indirect": "Glossy Indirect" if new else "GlossInd",
        }
        self.assertEqual(names, expected)
