# SPDX-License-Identifier: GPL-3.0-or-later
"""`wardmis stability`: the whole default sweep of one variant, its JSON, its figure, and its mistakes."""

import json

from command import CommandTest


class Stability(CommandTest):
    scenes = ()

    def test_sweep(self):
        figure = self.folder / "maps.svg"
        done = self.run_command("stability", "--variants", "ward-gmd", "--json", "--plot", figure)
        report = json.loads(done.stdout)
        self.assertTrue(report["pass"])
        self.assertEqual(report["cells_failed"], 0)
        axes = {cell["axis"] for cell in report["cells"]}
        self.assertEqual(axes, {"grid", "anisotropy", "energy", "light", "samples", "grazing"})
        self.assertTrue(all(cell["pass"] for cell in report["cells"]))
        self.assertTrue(all(cell["lobe"]["albedo"] <= 1 + 1e-9 for cell in report["cells"] if "lobe" in cell))
        self.assertGreater(
            max(cell["estimators"]["stiffness_log10"] for cell in report["cells"] if "estimators" in cell), 20
        )
        text = figure.read_text()
        self.assertTrue(text.rstrip().endswith("</svg>"))
        self.assertIn("ward-gmd: stiffness", text)

    def test_mistakes_end_with_2(self):
        self.refused(2, "stability", "--variants", "phong", says=["phong"])
        self.refused(2, "stability", "--variants", "ward,ward", says=["twice"])
        self.refused(2, "stability", "--plot", self.folder / "maps.pdf", says=["SVG or PNG"])
        self.refused(2, "stability", "--seed", "-1", says=["--seed"])
