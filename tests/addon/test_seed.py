# SPDX-License-Identifier: GPL-3.0-or-later
"""Animated seeds are Cycles': its image of a frame with an animated seed is, bit for bit, that with the seed that seed.py says."""

from __future__ import annotations

import tempfile
import unittest
from pathlib import Path

import bpy
import numpy as np
from support import read_exr
from wardmis import compat
from wardmis.seed import LARGEST_INT, animated, seed_of


class AnimatedSeeds(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        bpy.ops.wm.read_homefile(use_factory_startup=True)
        self.scene = bpy.context.scene

    def cycles_image(self, name: str) -> np.ndarray:
        render, cycles = self.scene.render, self.scene.cycles
        render.engine, render.resolution_x, render.resolution_y, render.resolution_percentage = "CYCLES", 16, 16, 100
        cycles.device, cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = "CPU", 2, False, False
        for owner, setting, value in compat.multilayer_exr(render.image_settings):
            if hasattr(owner, setting):
                setattr(owner, setting, value)
        render.image_settings.exr_codec = "NONE"
        path = self.folder / f"{name}.exr"
        render.use_file_extension, render.filepath = False, str(path)
        bpy.ops.render.render(write_still=True)
        return read_exr(path)["ViewLayer.Combined.R"]

    def test_are_those_of_cycles(self):
        # Cycles' own setting takes half of the numbers; a subframe adds a number of its own
        for seed, frame, subframe in ((0, 1, 0.0), (0, 2, 0.0), (7, 250, 0.0), (2000000000, -3, 0.0), (5, 4, 0.25)):
            frame = next(f for f in range(frame, frame + 50) if animated(seed, f, subframe) <= LARGEST_INT)
            self.scene.frame_set(frame, subframe=subframe)
            cycles = self.scene.cycles
            cycles.use_animated_seed, cycles.seed = True, seed
            image = self.cycles_image("animated")
            cycles.use_animated_seed, cycles.seed = False, animated(seed, frame, subframe)
            self.assertTrue(np.array_equal(image, self.cycles_image("given")), (seed, frame, subframe))
            cycles.seed += 1
            self.assertFalse(np.array_equal(image, self.cycles_image("other")))

    def test_follow_the_frame(self):
        settings = self.scene.wardmis
        settings.seed = 3
        self.scene.frame_set(7)
        self.assertEqual(seed_of(self.scene), 3)
        settings.use_animated_seed = True
        self.assertEqual(seed_of(self.scene), animated(3, 7))
        self.scene.frame_set(8)
        self.assertEqual(seed_of(self.scene), animated(3, 8))
        self.scene.frame_set(8, subframe=0.5)
        self.assertEqual(seed_of(self.scene), animated(3, 8, 0.5))
        seeds = {animated(3, frame, part) for frame in range(-500, 500) for part in (0.0, 0.5)}
        self.assertEqual(len(seeds), 2000)
