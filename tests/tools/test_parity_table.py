# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of nodes: read as it was written, and told where it is not true."""

import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/cycles"))

import parity_table  # noqa: E402

TABLE = {"3.4": {"Math": (41, 4e-6), "TexNoise": (10, 0.0)}, "5.2": {"Math": (42, 2e-4)}}


class Written(unittest.TestCase):
    def test_is_read_again(self):
        self.assertEqual(parity_table.read(parity_table.written(TABLE)), TABLE)

    def test_differences_are_rounded_up(self):
        for difference, text in ((3.01e-6, "4e-6"), (4e-6, "4e-6"), (9.2e-5, "1e-4"), (0.0, "0"), (1e-4, "1e-4")):
            self.assertIn(f"| 1: {text} |", parity_table.written({"3.4": {"Math": (1, difference)}}))

    def test_of_the_documentation_is_full_and_within_its_limit(self):
        table = parity_table.read(parity_table.DOCUMENT.read_text())
        self.assertEqual(list(table), ["3.4", "4.3", "5.2"])
        for version, column in table.items():
            self.assertGreater(len(column), 45, version)
            self.assertGreater(sum(count for count, _ in column.values()), 600, version)
            for node, (_, difference) in column.items():
                self.assertLessEqual(
                    difference, 1e-3 if node in {"Blackbody", "Bump", "TexSky"} else 1e-4, f"{node}, {version}"
                )


class Untrue(unittest.TestCase):
    def test_what_was_found_is_what_it_says(self):
        self.assertEqual(parity_table.untrue(TABLE, "3.4", {"Math": (41, 9e-6), "TexNoise": (10, 1e-6)}), [])
        self.assertEqual(parity_table.untrue(TABLE, "4.2", {"Math": (1, 1.0)}), [])  # no column

    def test_a_node_too_many_or_too_few_another_number_or_a_larger_difference(self):
        cases = (
            ({"Math": (41, 0.0)}, "TexNoise is in it, and was not compared"),
            ({**TABLE["3.4"], "Clamp": (2, 0.0)}, "Clamp is not in it"),
            ({**TABLE["3.4"], "Math": (40, 0.0)}, "Math has 40 outputs and settings, not 41"),
            ({**TABLE["3.4"], "Math": (41, 2e-5)}, "Math differs by 2.0e-05, not 4e-06"),
            ({**TABLE["3.4"], "Math": (41, float("nan"))}, "Math differs by nan, not 4e-06"),
        )
        for found, fault in cases:
            with self.subTest(fault):
                self.assertEqual(parity_table.untrue(TABLE, "3.4", found), [fault])
