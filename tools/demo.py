# SPDX-License-Identifier: GPL-3.0-or-later
"""The demonstration: each scene with each allocation at the same number of samples, and with Cycles, through Blender;
then images, error images and figures in out/demo. Run by ./dev demo."""

import argparse
import hashlib
import os
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import blender
import metrics
import table
from blender import ROOT, Rendered
from sheet import Column, contact_sheet


@dataclass
class Scene:
    reference_samples: int = 512  # per pixel: what leaves the whole demonstration below five minutes on two cores
    is_cycles_own: bool = False  # its materials, so that Cycles shows the same


SCENES = {"teapot": Scene(), "veach": Scene(1024), "studio": Scene(256, is_cycles_own=True)}
ALLOCATIONS = ("equal", "auto", "variance", "second-moment")
PAPERS = ("equal", "variance", "second-moment")  # Lopez Garces and Kong's, in the integrator and of the points they had
PAPER_NOTE = (
    "As in the paper: stratified points, its three allocations, and paths from the lights, too (bidirectional: the allocations "
    "share samples among the camera's paths, connections and light traced to the film; weights are balance's over all ways). "
    "Beside each the same by paths from the camera alone, where the allocations share the samples of a hit with the weights "
    "that the paper pairs them with."
)
REFERENCE_SEED = 1_000_003  # a stream of its own: nothing is compared with its own samples

WARD_NOTE = (
    "Cycles shows the same node as Beckmann instead of Ward reflection, so its difference from the reference is the models' "
    "and the noise together, no error: no relMSE."
)
SAME_NOTE = (
    "Cycles shows the same materials by the same formulas, and is held against the same reference, WardMIS's; what the two "
    "draw differently counts as its error."
)


@dataclass
class Effort:
    percentage: int  # of the scene's resolution
    samples: int  # camera samples per pixel, pilot included
    reference_samples: int
    equal_time: bool = False  # the time that Cycles takes for these samples, in place of as many samples
    as_in_the_paper: bool = False


@dataclass
class Variant:
    label: str
    allocation: str
    integrator: str | None = None  # of the paper's; None: the scene's, with its points


def variants(effort: Effort) -> list[Variant]:
    if effort.as_in_the_paper:
        return [Variant(f"{a}, {i}", a, i) for i in ("bidirectional", "path") for a in PAPERS]
    return [Variant(a, a) for a in (ALLOCATIONS[:2] if effort.equal_time else ALLOCATIONS)]


def what_light_paths_change(rows: list[table.Row]) -> str:
    """Error times time of one scene's bidirectional renders, over the same by paths from the camera alone."""
    cost = {r.allocation: r.rel_mse_trimmed * r.seconds for r in rows if r.rel_mse_trimmed is not None}
    told = [f"{a} {cost[f'{a}, bidirectional'] / cost[f'{a}, path']:.2f}" for a in PAPERS]
    return f"{rows[0].scene}: error times time of bidirectional, path being 1: {', '.join(told)}."


def wardmis(effort: Effort, allocation: str, samples: int, seed: int, seconds: float | None = None) -> dict[str, Any]:
    """Stopped by the seconds, where they are given, with pixels as by default."""
    stop = {"stop_by": "samples", "samples": samples, "pixels": "even"}  # at equal samples
    if seconds is not None:
        stop = {"stop_by": "seconds", "seconds": seconds}
    return {
        "render.engine": "WARDMIS",
        "render.resolution_percentage": effort.percentage,
        "wardmis.allocation": allocation,
        "wardmis.seed": seed,
        **{f"wardmis.{name}": value for name, value in stop.items()},
    }


def cycles(effort: Effort) -> dict[str, Any]:
    """The same number of camera samples, without what would change the image: clamping, blurring, guessing, denoising."""
    return {
        "render.engine": "CYCLES",
        "render.resolution_percentage": effort.percentage,
        "cycles.samples": effort.samples,
        "cycles.use_adaptive_sampling": False,
        "cycles.use_denoising": False,
        "cycles.sample_clamp_indirect": 0,
        "cycles.blur_glossy": 0,
        "cycles.light_sampling_threshold": 0,
        "cycles.max_bounces": 7,  # as WardMIS' eight surface hits
        "cycles.diffuse_bounces": 7,
        "cycles.glossy_bounces": 7,
    }


def cycles_samples(image: Rendered) -> int:
    return next(int(str(v)) for name, v in image.exr.attributes.items() if name.endswith(".samples"))


def say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def reference(blend: Path, effort: Effort) -> tuple[Rendered, bool]:
    """Made once for a scene, a renderer and an add-on, and kept in build/demo: (image, made in this run)."""
    settings = wardmis(effort, "equal", effort.reference_samples, REFERENCE_SEED)
    settings["view_layers.ViewLayer.wardmis.use_pass_variance"] = True  # its own noise is told
    digest = hashlib.sha256(repr(settings).encode())
    exporter = sorted((ROOT / "addon" / "wardmis").rglob("*.py"))
    for path in [blend, Path(os.environ["WARDMIS_BINARY"]), *exporter]:
        digest.update(path.read_bytes())
    path = ROOT / "build" / "demo" / f"{blend.stem}-{digest.hexdigest()[:16]}.exr"
    if path.exists():
        return blender.rendered(path), False
    for old in path.parent.glob(f"{blend.stem}-*.exr"):
        old.unlink()
    unfinished = path.with_suffix(".unfinished.exr")
    blender.render(blend, unfinished, settings)
    unfinished.rename(path)
    return blender.rendered(path), True


def figures(scene: str, label: str, image: Rendered, truth: Rendered | None) -> table.Row:
    statistics = image.statistics
    pixels = image.exr.passes["Combined"]
    against = None if truth is None else truth.exr.passes["Combined"]
    return table.Row(
        scene=scene,
        allocation=label,
        seconds=image.seconds,
        pilot_seconds=statistics["seconds"]["pilot"] if statistics else None,
        samples_per_pixel=statistics["samples_per_pixel"] if statistics else cycles_samples(image),
        samples=statistics["samples"]["total"] if statistics else None,
        rays=statistics["rays"]["total"] if statistics else None,
        rel_mse=None if against is None else metrics.rel_mse(pixels, against),
        rel_mse_trimmed=None if against is None else metrics.rel_mse_trimmed(pixels, against),
    )


def demonstrate(scene: str, out: Path, effort: Effort) -> tuple[list[table.Row], str, str]:
    """The scene's rows, a note on its reference and one on Cycles. Writes the images and the sheet."""
    blend = ROOT / "blend" / f"{scene}.blend"
    say(f"{blend.name}: reference, {effort.reference_samples} samples per pixel")
    truth, made = reference(blend, effort)
    truth_pixels = truth.exr.passes["Combined"]
    noise = metrics.reference_noise(truth_pixels, truth.exr.passes["Variance"])
    truth_note = (
        f"{scene}: the reference is this renderer's own, {truth.statistics['samples_per_pixel']} spp, seed {REFERENCE_SEED}, "
        f"made {'in this run' if made else 'in an earlier run'} in {truth.seconds:.0f} s; its own noise adds about {noise:.2g} to each relMSE."
    )
    rows, columns = [], []
    say(f"{blend.name}: Cycles")
    by_cycles = blender.render(blend, out / f"{scene}-cycles.exr", cycles(effort))
    seconds = by_cycles.seconds if effort.equal_time else None
    for variant in variants(effort):
        say(f"{blend.name}: {variant.label}")
        settings = wardmis(effort, variant.allocation, effort.samples, 1, seconds)
        if variant.integrator:
            settings |= {"wardmis.integrator": variant.integrator, "wardmis.sampler": "stratified"}
        image = blender.render(blend, out / f"{scene}-{variant.label.replace(', ', '-')}.exr", settings)
        row = figures(scene, variant.label, image, truth)
        rows.append(row)
        lines = [
            f"{row.samples_per_pixel} spp, {row.samples:,} samples",
            f"{row.seconds:.1f} s, relMSE {row.rel_mse:.4f}",
        ]
        columns.append(Column(variant.label, image.exr.passes["Combined"], lines))
    image = by_cycles
    same = SCENES.get(scene, Scene()).is_cycles_own
    row = figures(scene, table.CYCLES, image, truth if same else None)
    rows.append(row)
    if same:
        lines, warning = [f"{row.samples_per_pixel} spp", f"{row.seconds:.1f} s, relMSE {row.rel_mse:.4f}"], ""
    else:
        lines, warning = (
            [f"{row.samples_per_pixel} spp, {row.seconds:.1f} s", "Beckmann, not Ward"],
            "model difference + noise",
        )
    columns.append(Column(table.CYCLES, image.exr.passes["Combined"], lines, warning))
    cycles_note = SAME_NOTE if same else WARD_NOTE

    height, width = truth_pixels.shape[:2]
    # six are too many for one sheet
    of_path, columns = (columns[3:], [*columns[:3], columns[-1]]) if effort.as_in_the_paper else ([], columns)
    lines = [f"{truth.statistics['samples_per_pixel']} spp, another seed", f"own noise: relMSE {noise:.1g}"]
    for name, shown in ((scene, columns), (f"{scene}-path", of_path)):
        if shown:
            contact_sheet(
                f"{blend.name}   {width} x {height}",
                Column("reference", truth_pixels, lines),
                shown,
                [metrics.FORMULA + ". Seconds: pilot included.", cycles_note],
            ).save(out / f"{name}.png", optimize=True)
    return rows, truth_note, cycles_note


def main() -> int:
    parser = argparse.ArgumentParser(prog="./dev demo", description=__doc__)
    parser.add_argument("scenes", nargs="*", default=list(SCENES), help="names of files in blend/ (%(default)s)")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "demo")
    parser.add_argument("--samples", type=int, default=32, help="camera samples per pixel (%(default)s)")
    parser.add_argument("--reference-samples", type=int, help="of the reference (chosen for each scene)")
    how = parser.add_mutually_exclusive_group()
    how.add_argument("--equal-time", action="store_true", help="of two allocations, in the time that Cycles takes")
    how.add_argument(
        "--as-in-the-paper", action="store_true", help="its three allocations, with its integrator and its points"
    )
    parser.add_argument("--percentage", type=int, default=50, help="of the scenes' resolution (%(default)s)")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    began = time.monotonic()
    rows: list[table.Row] = []
    verdicts: list[str] = []
    of_cycles: dict[str, list[str]] = {}  # notes, and their scenes
    notes = [
        f"{metrics.FORMULA}.",
        "Seconds: pilot and render, without export and loading; one run each, so small differences mean nothing.",
    ]
    try:
        for scene in arguments.scenes:
            reference_samples = arguments.reference_samples or SCENES.get(scene, Scene()).reference_samples
            effort = Effort(
                arguments.percentage,
                arguments.samples,
                reference_samples,
                arguments.equal_time,
                arguments.as_in_the_paper,
            )
            scene_rows, truth_note, cycles_note = demonstrate(scene, arguments.out, effort)
            rows += scene_rows
            verdicts.append(table.verdict(scene_rows, scene_rows[0].allocation))
            if effort.as_in_the_paper:
                verdicts.append(what_light_paths_change(scene_rows))
            notes.append(truth_note)
            of_cycles.setdefault(cycles_note, []).append(scene)
    except blender.RenderFailed as error:
        sys.exit(f"demo: {error}")
    if arguments.as_in_the_paper:
        notes.append(PAPER_NOTE)
    notes = [*verdicts, *notes, *(f"{', '.join(scenes)}: {note}" for note, scenes in of_cycles.items())]
    (arguments.out / "table.md").write_text(table.markdown(rows, notes))
    (arguments.out / "table.json").write_text(table.as_json(rows, notes))
    print(table.plain(rows, notes))
    print(f"\n{arguments.out}: images, sheets, table.md, table.json; {time.monotonic() - began:.0f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
