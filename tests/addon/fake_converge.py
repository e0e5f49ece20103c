# SPDX-License-Identifier: GPL-3.0-or-later
"""The fake renderer's `wardmis converge`: the events and files of docs/report-format.md, with figures of its own invention."""

import argparse
import json
import re
import time
from pathlib import Path

from fake_files import say, write_exr

ALLOCATIONS = {
    "equal": 1.0,
    "albedo": 1.1,
    "variance": 0.8,
    "standard-deviation": 0.9,
    "second-moment": 0.7,
    "inverse-variance": 0.9,
    "equalised": 0.95,
    "representativity": 0.9,
    "auto": 0.65,
}
POOR_SECONDS = 0.01  # a budget that is refused
CHOSEN_SAMPLES = 4  # where there is one
FIRST_ERROR = 0.5  # of `equal` at one sample per pixel


def parse():
    parser = argparse.ArgumentParser()
    parser.add_argument("verb", choices=["converge"])
    parser.add_argument("scene")
    parser.add_argument("-o", dest="output", required=True)
    parser.add_argument("-c", "--configuration", action="append")
    parser.add_argument("--seeds", type=int, default=16)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--max-spp", type=int, default=64)
    parser.add_argument("--external", action="append", default=[])
    parser.add_argument("--watch-stdin", action="store_true")
    parser.add_argument("--check", action="store_true")
    options = (
        "baseline budget-seconds reference reference-time target title resolution threads progress allocation pixels weights "
        "integrand integrator sampler samples-per-hit pilot-spp min-fraction max-depth max-diffuse max-glossy max-transmission max-transparent cost"
    )
    for option in options.split():
        parser.add_argument("--" + option)
    return parser.parse_args()


def converge(options, film, mode):
    if options.check:
        return None
    if options.budget_seconds:
        if float(options.budget_seconds) < POOR_SECONDS:
            message = f"--budget-seconds {options.budget_seconds}: too little; give at least 3 s, or fewer seeds"
            say(event="error", code=2, message=message)
            return 2
        options.max_spp = CHOSEN_SAMPLES
    names = [c.split(":")[0] for c in options.configuration or ["equal", "variance", "second-moment", "auto"]]
    x0, y0, x1, y1 = film["border"]
    size = {"width": x1 - x0, "height": y1 - y0}
    say(event="start", configurations=names, seeds=options.seeds, max_spp=options.max_spp, **size)
    steps = 600 if mode == "slow" else len(names) * 2
    for step in range(1, steps + 1):
        time.sleep(0.1 if mode == "slow" else 0.01)
        say(
            event="progress",
            phase="runs",
            configuration=names[step % len(names)],
            seed=1 + step % options.seeds,
            done=step,
            of=steps,
            fraction=step / steps,
            seconds=0.1 * step,
            left=0.1 * (steps - step),
        )
    say(event="warning", message="this renderer is a fake")
    folder = Path(options.output)
    (folder / "images").mkdir(parents=True, exist_ok=True)
    externals = [json.loads(Path(path).read_text(encoding="utf-8")) for path in options.external]
    for path, external in zip(options.external, externals):
        check_external(Path(path), external)
    labels = [(name, "WardMIS") for name in names] + [
        (external["name"], external["renderer"]) for external in externals
    ]
    if mode != "nothing":
        (folder / "study.json").write_text(json.dumps({"chosen_spp": options.max_spp}))
        write_exr(folder / "reference.exr", "ViewLayer", {"Combined": "RGBA", "Variance": "RGB"}, film)
        for name, _ in labels:
            file = folder / "images" / file_name(name)
            write_exr(file, "ViewLayer", {"Combined": "RGBA"}, film)
            write_exr(file.with_name(f"{file.stem}-error.exr"), "ViewLayer", {"Combined": "RGBA"}, film)
        (folder / "report.json").write_text(json.dumps(report(options, labels, size)))
        (folder / "report.html").write_text("<!doctype html><title>fake</title>")
    say(event="done", path=str(folder / "report.html"), report=str(folder / "report.json"), seconds=0.1)
    return 0


def file_name(configuration):
    return re.sub(r"[^\w-]", "_", configuration) + ".exr"


def check_external(path, external):
    """What the contract promises of an external manifest."""
    assert isinstance(external["common_reference"], bool)
    assert len(external["reference"]["images"]) >= 2 and external["reference"]["spp"] > 0
    files = external["reference"]["images"] + [run["path"] for run in external["runs"]]
    for name in files:
        assert (path.parent / name).is_file(), name
    assert len({run["seed"] for run in external["runs"]}) >= 2
    for run in external["runs"]:
        assert run["wall"] is None or run["wall"] >= 0
        assert run["cpu"] is None or run["cpu"] > 0


def interval(mean, spread=0.1):
    return {"mean": mean, "low": mean * (1 - spread), "high": mean * (1 + spread)}


def report(options, labels, size):
    checkpoints = [1 << k for k in range(options.max_spp.bit_length()) if 1 << k <= options.max_spp]
    return {
        "schema": "wardmis-report-1",
        "title": options.title or Path(options.scene).stem,
        "version": "0.0.0",
        "complete": True,
        "verdict": {
            "use": "variance",
            "text": "Use variance: the noise of equal in 80 % of its time.",
            "ratios": {},
            "why": ["auto is better and worse."],
        },
        "finding": ["The figures are invented."],
        "baseline": labels[0][0],
        "metric": "relmse",
        "metrics": [{"name": "mse", "label": "MSE"}, {"name": "relmse", "label": "relMSE"}],
        "clock": "wall",
        "seeds": list(range(options.seed, options.seed + options.seeds)),
        "checkpoints": checkpoints,
        **size,
        "configurations": [configuration(name, renderer, checkpoints) for name, renderer in labels],
    }


def configuration(name, renderer, checkpoints):
    factor = ALLOCATIONS.get(name, 1.5)
    error = FIRST_ERROR * factor
    verdict = "baseline" if factor == 1 else "faster" if factor < 1 else "slower"
    return {
        "name": name,
        "image": file_name(name),
        "renderer": renderer,
        "settings": {
            "allocation": name,
            "weights": "balance",
            "samples_per_hit": 5,
            "min_fraction": 0.2,
            "kernel": "auto",
        },
        "estimates": "paths, depth 8" if renderer == "WardMIS" else None,
        "description": name,
        "runs": 16,
        "curve": [
            {
                "spp": spp,
                "wall": interval(0.01 * spp, 0.02),
                "cpu": interval(0.02 * spp, 0.02),
                "relmse": interval(error / spp),
                "mse": interval(error / spp),
                "near_floor": False,
            }
            for spp in checkpoints
        ],
        "time_to_target": {
            "target": 0.01,
            "seconds": interval(0.5 * factor),
            "ratio": interval(factor),
            "verdict": verdict,
        },
        "equal_time": {"seconds": 0.5, "error": interval(error / 50), "ratio": interval(factor)},
        "equal_samples": {
            "spp": checkpoints[-1],
            "error": interval(error / checkpoints[-1]),
            "ratio": interval(factor),
        },
    }
