# SPDX-License-Identifier: GPL-3.0-or-later
"""What paths from the lights bring where light comes by hidden ways: error x time of the bidirectional integrator beside
the default's and Cycles', with its path guiding where it was built with that. Run by ./dev bench light-paths."""

import argparse
import json
import sys
from typing import Any

import blender
from bench import Interval, asked, compared, of_all_pixels
from markdown import table

SCENES = ("ajar", "caustic", "lamps-inside", "door")
CONFIGURATIONS = (
    "path:integrator=path,allocation=auto,pixels=auto",
    "bidirectional equal:integrator=bidirectional,allocation=equal",
    "bidirectional auto:integrator=bidirectional,allocation=auto,pixels=auto",
)
HAS_GUIDING = "import _cycles, sys; sys.exit(0 if getattr(_cycles, 'with_path_guiding', False) else 9)"


def has_guiding() -> bool:
    """Whether this Blender's Cycles can guide paths."""
    try:
        blender.run("--python-exit-code", "1", "--python-expr", HAS_GUIDING)
    except blender.RenderFailed:
        return False
    return True


def over_path(report: dict[str, Any], name: str) -> Interval | None:
    """Error x time over that of paths from the camera."""
    of = next(c for c in report["configurations"] if c["name"] == name)
    return Interval.of(of["efficiency"]["ratio"])


def cells(scene: str, options: argparse.Namespace, guiding: bool) -> tuple[list[str], str]:
    """A scene's row, and by which metric it is."""
    report = compared(scene, options, CONFIGURATIONS)
    names = [c.partition(":")[0] for c in CONFIGURATIONS[1:]] + ["Cycles"]
    ratios = [over_path(report, name) for name in names]
    if guiding:
        ratios.append(over_path(compared(f"{scene}-guided", options, CONFIGURATIONS[:1]), "Cycles"))
    return [scene, *("–" if r is None else str(r) for r in ratios)], report["metric"]


def main() -> int:
    options = asked("light-paths", __doc__, SCENES, "reports and light-paths.json")
    guiding = has_guiding()
    rows, metrics = [], {}
    try:
        for scene in options.scenes:
            row, metrics[scene] = cells(scene, options, guiding)
            rows.append(row)
            (options.out / "light-paths.json").write_text(json.dumps(rows, indent=1) + "\n")
    except blender.RenderFailed as error:
        sys.exit(f"bench: {error}")
    headings = ["error x time over path's", "bidirectional equal", "bidirectional auto", "Cycles"]
    print(table(headings + (["Cycles, guided"] if guiding else []), rows))
    print(of_all_pixels(metrics), end="")
    if not guiding:
        print("This Blender's Cycles was built without path guiding.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
