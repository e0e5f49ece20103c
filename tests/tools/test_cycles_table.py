# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of scenes judges what it is given: deviations, and noise that would hide them."""

import json
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests/cycles"), str(ROOT / "tools")]

import blocks  # noqa: E402
import run  # noqa: E402

SIZE = (48, 64, 4)


class Judged(unittest.TestCase):
    def fault(self, noise, *, block=8, bound=0.025, deviation=0.0):
        """Of images whose pixels scatter by `noise`; fixed random numbers."""
        random = np.random.default_rng(1)

        def images(_folder, _name, engine, _pass):
            stack = 1 + noise * random.standard_normal((5, *SIZE)) + (deviation if engine == "wardmis" else 0)
            stack[..., 3] = 1
            return stack

        limits = {"within": 0.005, "why": "", "block": block, "noise": bound, "passes": ["Combined"], "error": ""}
        with tempfile.TemporaryDirectory() as folder, mock.patch.object(blocks, "images", images):
            Path(folder, "x.json").write_text(json.dumps(limits))
            with mock.patch.object(run, "render"):  # again
                return run.compared(Path(folder), "x").fault

    def test_a_quiet_scene_passes(self):
        self.assertEqual(self.fault(0.01), "")

    def test_one_that_deviates_does_not(self):
        self.assertIn("blocks differ", self.fault(0.01, deviation=0.03))

    def test_nor_one_whose_noise_would_hide_that(self):
        """8 x 8 pixels of five seeds of each engine, each 0.5: a standard error of 4 %."""
        self.assertRegex(
            self.fault(0.5), r"a block has \d+\.\d % of noise.* 2\.5 % is allowed: give the scene more samples"
        )

    def test_larger_blocks_have_less_of_it(self):
        self.assertNotEqual(self.fault(0.22), "")
        self.assertEqual(self.fault(0.22, block=16), "")

    def test_a_scene_may_say_that_it_has_more(self):
        self.assertEqual(self.fault(0.5, bound=0.2), "")
