# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the default keeps its promise, to be in time no worse than the best fixed setting by more than its pilot: on
22 scenes, some of them against it, error and time of the default beside those of fixed settings. Run by ./dev bench
settings."""

import argparse
import json
import sys
from dataclasses import asdict, dataclass
from statistics import geometric_mean

import blender
from bench import asked, converged, of_all_pixels
from markdown import table

SCENES = (
    "veach",
    "veach-direct",
    "veach-glossiness",
    "veach-mesh-lights",
    "teapot",
    "teapot-direct",
    "studio",
    "door",
    "rooms",
    "window",
    "area-lamps",
    "image-sky",
    "lamps-1",
    "lamps-1024",
    "glowing-2",
    "glowing-20000",
    "triangles-10000",
    "instances-100",
    "stiff-alphas",
    "stiff-grazing",
    "stiff-lights",
    "stiff-mirror",
)
DEFAULT = "auto"
# of each what may be best: few samples at a hit or many, shared evenly, by albedo or by moments; pixels by their error
FIXED = {
    "equal": "allocation=equal",
    "equal-2": "allocation=equal,samples-per-hit=2",
    "equal-3": "allocation=equal,samples-per-hit=3",
    "equal-12": "allocation=equal,samples-per-hit=12",
    "albedo-2": "allocation=albedo,samples-per-hit=2",
    "second-moment": "allocation=second-moment",
    "equal-pixels": "allocation=equal,pixels=by-error",
    "albedo-2-pixels": "allocation=albedo,samples-per-hit=2,pixels=by-error",
}


@dataclass
class Over:
    """Variance x time of the default over a fixed setting's: below 1 the default is sooner there."""

    setting: str
    ratio: float
    low: float  # of 95 %
    high: float

    def __str__(self) -> str:
        return f"{self.ratio:.2f} [{self.low:.2f}, {self.high:.2f}]"


def measured(scene: str, options: argparse.Namespace) -> tuple[list[Over], str]:
    """Of each fixed setting, the best one first; and by what metric of the report."""
    print(f"bench: {scene}", file=sys.stderr, flush=True)
    words = ["-c", f"{DEFAULT}:allocation=auto,pixels=auto"]
    for name, settings in FIXED.items():
        words += ["-c", f"{name}:{settings}"]
    report = converged(scene, options.out / f"{scene}-settings", options, *words)
    of = {c["name"]: c["efficiency"]["ratio"] for c in report["configurations"]}
    found = []
    for name in FIXED:
        if ratio := of[name]:  # none where there is no noise
            found.append(Over(name, 1 / ratio["mean"], 1 / ratio["high"], 1 / ratio["low"]))
    return sorted(found, key=lambda o: -o.ratio), report["metric"]


def main() -> int:
    options = asked("settings", __doc__, SCENES, "scenes, studies and settings.json")
    found: dict[str, list[Over]] = {}
    metrics: dict[str, str] = {}
    for scene in options.scenes:
        try:
            found[scene], metrics[scene] = measured(scene, options)
        except blender.RenderFailed as error:
            sys.exit(f"bench: {error}")
        document = {name: [asdict(o) for o in over] for name, over in found.items()}
        (options.out / "settings.json").write_text(json.dumps(document, indent=1) + "\n")
    rows = [
        (scene, over[0].setting, str(over[0]), str(next(o for o in over if o.setting == "equal")))
        for scene, over in found.items()
        if over
    ]
    print(f"{options.samples} samples per pixel, {options.resolution}, {options.seeds} seeds\n")
    print(table(("scene", "best fixed setting", "error x time of the default over its", "over equal counts'"), rows, 2))
    print(of_all_pixels(metrics), end="")
    ratios = [over[0].ratio for over in found.values() if over]
    print(f"The worst is {max(ratios):.2f}, the geometric mean {geometric_mean(ratios):.2f}.")
    if silent := [scene for scene, over in found.items() if not over]:
        print(f"Without noise, so that there is nothing to compare: {', '.join(silent)}.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
