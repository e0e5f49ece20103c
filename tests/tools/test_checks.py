# SPDX-License-Identifier: GPL-3.0-or-later
"""The checks of ./dev lint find what they are for."""

import json
import tempfile
import unittest
from pathlib import Path

from check_layers import import_problems, include_problems
from check_spdx import says_licence
from tally import tally


class Layers(unittest.TestCase):
    def includes(self, path: str, text: str) -> list[str]:
        return list(include_problems(Path(path), text))

    def test_lower_floors_and_the_own_folder_are_allowed(self):
        text = '#include "math/vec.h"\n#include "gltf/reader.h"\n#include <vector>\n'
        self.assertEqual(self.includes("native/gltf/light.cpp", text), [])

    def test_upper_floors_and_neighbours_are_not(self):
        self.assertIn("native/math/vec.h:2:", self.includes("native/math/vec.h", '\n#include "scene/scene.h"')[0])
        self.assertEqual(len(self.includes("native/bsdf/ward.h", '#include "mis/weights.h"')), 1)

    def test_embree_is_known_in_one_place(self):
        self.assertEqual(self.includes("native/world/embree.h", "#include <embree3/rtcore.h>"), [])
        self.assertEqual(len(self.includes("native/world/accel.cpp", "#include <embree3/rtcore.h>")), 1)

    def test_openimageio_is_known_in_its_module_alone(self):
        text = '#include <OpenImageIO/imageio.h>\n#include "image/oiio_interface.h"\n'
        self.assertEqual(self.includes("native/oiio/module.cpp", text), [])
        self.assertEqual(len(self.includes("native/image/file.cpp", text)), 1)

    def test_unknown_folders_are_named(self):
        self.assertIn("'misc' is on no floor", self.includes("native/misc/a.h", "")[0])

    def test_blender_stays_in_the_add_on(self):
        text = "import numpy\nfrom bpy.types import Panel\n"
        self.assertEqual(list(import_problems(Path("addon/wardmis/panels.py"), text)), [])
        self.assertIn("tools/demo.py:2", next(import_problems(Path("tools/demo.py"), text)))
        self.assertIn("model.py:2", next(import_problems(Path("addon/wardmis/export/model.py"), text)))


class Licence(unittest.TestCase):
    def test_first_line_or_second_after_the_interpreter(self):
        self.assertTrue(says_licence("# SPDX-License-Identifier: GPL-3.0-or-later\n"))
        self.assertTrue(says_licence("#!/bin/sh\n# SPDX-License-Identifier: GPL-3.0-or-later\n"))
        self.assertFalse(says_licence("import os\n# SPDX-License-Identifier: GPL-3.0-or-later\n"))


class Tally(unittest.TestCase):
    def test_counts_failures_and_crashes(self):
        with tempfile.TemporaryDirectory() as folder:
            build = Path(folder)
            (build / "test-results").mkdir()
            (build / "Testing" / "Temporary").mkdir(parents=True)
            report = {"tests": 5, "failures": 2, "disabled": 0, "errors": 0}
            (build / "test-results" / "test_math.json").write_text(json.dumps(report))
            (build / "Testing" / "Temporary" / "LastTestsFailed.log").write_text("1:math\n2:scene\n")
            self.assertEqual(tally(build), (3, 3))


if __name__ == "__main__":
    unittest.main()
