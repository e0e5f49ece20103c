# SPDX-License-Identifier: GPL-3.0-or-later
"""Which exports are taken for one scene: those that differ in rounding alone."""

from __future__ import annotations

import dataclasses
import tempfile
import unittest
from pathlib import Path

import numpy as np
from comparison_support import perturb
from test_glb import scene, triangle
from wardmis.comparison.same_scene import same_but_for_rounding, settle
from wardmis.export import glb
from wardmis.export.model import ColorInput, ImageData, InstanceData, MaterialData

NORMALS = np.array([(0.6, 0, 0.8), (0, 0.6, 0.8), (0, 0, 1)], np.float32)


class SameScene(unittest.TestCase):
    def setUp(self) -> None:
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.first, self.second = (Path(temporary.name) / name for name in ("first.glb", "second.glb"))
        self.mesh = triangle(normals=NORMALS)
        self.image = ImageData("Image", "sRGB", pixels=np.full((2, 2, 3), 7, np.uint8))
        self.write(self.first)
        self.write(self.second)

    def write(self, path: Path, **parts) -> None:
        instances = [InstanceData("Instance", 0, np.eye(4))]
        glb.write_glb(scene(**{"meshes": [self.mesh], "instances": instances, "images": [self.image], **parts}), path)

    def check(self, same: bool) -> None:
        self.assertIs(same_but_for_rounding(self.first, self.second), same)
        self.assertIs(same_but_for_rounding(self.second, self.first), same)

    def test_equal_files(self):
        self.check(True)

    def test_last_bits_of_floats(self):
        perturb(self.second, "NORMAL", 3e-7)
        self.assertNotEqual(self.first.read_bytes(), self.second.read_bytes())
        self.check(True)

    def test_last_bits_of_a_bound(self):
        """It stands in the document, whose length changes with its digits."""
        moved = self.mesh.positions.copy()
        moved[1, 0] = np.nextafter(moved[1, 0], np.float32(2))
        self.write(self.second, meshes=[dataclasses.replace(self.mesh, positions=moved)])
        self.assertNotEqual(self.first.stat().st_size, self.second.stat().st_size)
        self.check(True)

    def test_small_numbers_are_measured_by_the_largest(self):
        tiny = dataclasses.replace(self.mesh, positions=self.mesh.positions * np.float32(1e-6))
        self.write(self.first, meshes=[tiny])
        self.write(self.second, meshes=[tiny])
        self.check(True)
        perturb(self.second, "POSITION", 1e-9)
        self.check(False)

    def test_a_moved_vertex(self):
        perturb(self.second, "POSITION", 1e-3)
        self.check(False)

    def test_no_number(self):
        perturb(self.second, "POSITION", float("nan"))
        self.check(False)

    def test_another_material(self):
        self.write(self.second, materials=[MaterialData("Grey", diffuse=ColorInput((0.500001, 0.5, 0.5)))])
        self.check(False)

    def test_another_pixel(self):
        pixels = self.image.pixels.copy()
        pixels[1, 1, 1] += 1
        self.write(self.second, images=[dataclasses.replace(self.image, pixels=pixels)])
        self.check(False)

    def test_another_size(self):
        self.write(self.second, meshes=[dataclasses.replace(self.mesh, normals=None)])
        self.check(False)

    def test_missing_and_damaged_files(self):
        whole = self.second.read_bytes()
        for data in (b"", b"glTF", whole[:40], whole[:-4], b"\0" * len(whole)):
            self.second.write_bytes(data)
            self.check(False)
        self.second.unlink()
        self.check(False)

    def test_settling_keeps_the_same_and_replaces_another(self):
        kept = self.first.read_bytes()
        perturb(self.second, "NORMAL", 3e-7)
        settle(self.second, self.first)
        self.assertEqual(self.first.read_bytes(), kept)
        self.assertFalse(self.second.exists())
        self.write(self.second, meshes=[dataclasses.replace(self.mesh, normals=None)])
        new = self.second.read_bytes()
        settle(self.second, self.first)
        self.assertEqual(self.first.read_bytes(), new)
        self.assertFalse(self.second.exists())
