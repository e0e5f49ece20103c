# SPDX-License-Identifier: GPL-3.0-or-later
"""Simplify's settings of Cycles: what is followed, and what is named."""

from __future__ import annotations

from typing import Any

import bpy
from support import SceneTest
from wardmis.export.simplify import FULL_SIZE, Shrinking, shrinking_of


class Simplify(SceneTest):
    def set(self, owner: Any, name: str, value: Any) -> None:
        self.addCleanup(setattr, owner, name, getattr(owner, name))
        setattr(owner, name, value)

    def test_what_cycles_leaves_out_to_save_time_is_named(self):
        made = self.add("Far", bpy.data.meshes.new("Far"))
        for kind in ("camera", "distance"):
            name, says = f"use_{kind}_cull", f"Simplify's {kind.title()} Culling is not supported: object '{made.name}'"
            owners = ((made.cycles, name), (self.scene.cycles, name), (self.scene.render, "use_simplify"))
            for owner, setting in owners:
                with self.subTest(name, without=setting):
                    for each, its in owners:
                        self.set(each, its, True)
                    self.assertIn(says, "\n".join(self.gather().notes))
                    setattr(owner, setting, False)
                    self.assertNotIn(says, "\n".join(self.gather().notes))
        self.set(self.scene.cycles, "use_fast_gi", True)
        self.assertIn("Fast GI Approximation is not supported", "\n".join(self.gather().notes))

    def test_limits_of_the_size_of_images(self):
        cycles = self.scene.cycles
        self.set(self.scene.render, "use_simplify", True)
        self.set(cycles, "texture_limit_render", "512")
        self.assertEqual(shrinking_of(self.scene), Shrinking(0, 512))
        if hasattr(cycles, "texture_resolution_render"):
            self.set(cycles, "texture_resolution_render", 1.0)
            for share, halvings in ((1.0, 0), (0.5, 1), (0.3, 2), (0.00001, 17)):
                cycles.texture_resolution_render = share
                self.assertEqual(shrinking_of(self.scene), Shrinking(halvings, 512))
        self.scene.render.use_simplify = False
        self.assertEqual(shrinking_of(self.scene), FULL_SIZE)
