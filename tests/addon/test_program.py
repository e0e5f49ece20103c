# SPDX-License-Identifier: GPL-3.0-or-later
"""Operations as data: what they take and give, each once, folded, and without what nothing needs."""

import re
import unittest
from pathlib import Path

from wardmis.export.program.builder import Builder, Result
from wardmis.export.program.signatures import SIGNATURES

TABLE = Path(__file__).resolve().parents[2] / "native" / "program" / "operation.h"


class Programs(unittest.TestCase):
    def test_operations_are_those_of_the_renderer(self):
        rows = re.findall(r'X\(k\w+, "([a-z0-9-]+)", k(Number|Vector), "([nv]*)"', TABLE.read_text())
        kinds = {"n": "number", "v": "vector"}
        theirs = {name: (tuple(kinds[a] for a in arguments), result.lower()) for name, result, arguments in rows}
        self.assertEqual(SIGNATURES, theirs)

    def test_constants_are_folded_and_the_same_is_computed_once(self):
        p = Builder()
        self.assertEqual(p("add", 1.0, 2.0), 3.0)
        self.assertEqual(p("mix-multiply", 1.0, (1.0, 2.0, 3.0), (2.0, 2.0, 0.5)), (2.0, 4.0, 1.5))
        self.assertEqual(p("x", p("uv")), p("x", p("uv")))
        self.assertEqual(len(p.operations), 2)

    def test_what_nothing_needs_is_dropped(self):
        p = Builder()
        p("normal")
        wanted = p("x", p("uv"))
        program, number = p.program([wanted])
        self.assertEqual(program.operations, [{"op": "uv"}, {"op": "x", "in": [{"result": 0}]}])
        self.assertEqual(number[wanted.index], 1)

    def test_kinds_are_checked(self):
        with self.assertRaises(TypeError):
            Builder()("add", 1.0, (1.0, 2.0, 3.0))
        with self.assertRaises(TypeError):
            Builder()("luminance", Result(0, "number"))
