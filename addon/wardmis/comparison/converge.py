# SPDX-License-Identifier: GPL-3.0-or-later
"""The command `wardmis converge` (docs/command.md) for a scene's settings. No bpy in here."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .. import light_paths, sharing

OWN = "scene"  # the configuration that the scene's own settings are
DEFAULT_CONFIGURATIONS = ("equal", "variance", "second-moment", "auto")


def checkpoints(max_spp: int) -> list[int]:
    """1, 2, 4 ... and the last."""
    powers = [1 << k for k in range(max_spp.bit_length()) if 1 << k < max_spp]
    return [*powers, max_spp]


@dataclass
class Study:
    """What is compared, and how long; the names are those of the command's options."""

    configurations: Sequence[str] = DEFAULT_CONFIGURATIONS
    seeds: int = 16
    first_seed: int = 1
    max_spp: int = 64
    budget_seconds: float | None = None
    baseline: str | None = None
    reference: Path | None = None
    reference_time: float | None = None
    target: float | None = None
    title: str = ""
    threads: int = 0


@dataclass
class Outcome:
    """Where a comparison has left what."""

    folder: Path
    scene: Path
    manifest: Path | None = None  # of Cycles' renders
    warnings: list[str] = field(default_factory=list)

    @property
    def report_html(self) -> Path:
        return self.folder / "report.html"

    @property
    def report_json(self) -> Path:
        return self.folder / "report.json"


def chosen_spp(folder: Path) -> int:
    """Samples per pixel of the runs of the command's study in `folder`. Raises RuntimeError where there is none."""
    path = folder / "study.json"
    try:
        return int(json.loads(path.read_text(encoding="utf-8"))["chosen_spp"])
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise RuntimeError(
            f"WardMIS: {path} does not say how many samples the runs have ({error}); delete the folder"
        ) from error


ENOUGH = re.compile(r"give at least (\d+) s")


def enough_of(message: str) -> float | None:
    """The seconds that a refusal of a budget asks for."""
    found = ENOUGH.search(message)
    return None if found is None else float(found[1])


def explain_half(message: str) -> str:
    """A refusal of half a budget names the half, where the user has given the whole."""
    if "--budget-seconds" not in message or "give at least" not in message:
        return message
    doubled = ENOUGH.sub(lambda found: f"give at least {2 * int(found[1])} s in all", message)
    return f"{doubled}, or compare without Cycles, which has half of the budget"


def arguments(study: Study, settings: Any, outcome: Outcome) -> list[str]:
    """Of the command, without its own name. `settings`: the scene's, which hold where a configuration says nothing else."""
    result: list[Any] = ["converge", outcome.scene, "-o", outcome.folder, "--progress", "json", "--watch-stdin"]
    for specification in study.configurations:
        result += ["--configuration", own_specification(settings) if specification == OWN else specification]
    # the weights that belong to each allocation; the scene's are those of its own configuration
    result += ["--weights", "auto", "--integrand", settings.integrand, "--integrator", settings.integrator]
    result += ["--sampler", settings.sampler, "--samples-per-hit", settings.samples_per_hit]
    result += ["--pilot-spp", settings.pilot_samples, "--min-fraction", f"{settings.min_fraction:.6g}"]
    for option, limit in light_paths.options(settings.id_data).items():
        result += [f"--{option}", limit]
    result += ["--seeds", study.seeds, "--seed", study.first_seed]
    if study.budget_seconds is not None:
        result += ["--budget-seconds", f"{study.budget_seconds:.6g}"]
    else:
        result += ["--max-spp", study.max_spp]
    for option, value in (
        ("--baseline", study.baseline),
        ("--reference", study.reference),
        ("--reference-time", study.reference_time),
        ("--target", study.target),
        ("--title", study.title or None),
        ("--threads", study.threads or None),
        ("--external", outcome.manifest),
    ):
        if value is not None:
            result += [option, value]
    return [str(argument) for argument in result]


def own_specification(settings: Any) -> str:
    """The scene's settings as a configuration."""
    pairs = {
        **sharing.options(settings),
        "integrand": settings.integrand,
        "integrator": settings.integrator,
        "sampler": settings.sampler,
        "samples-per-hit": settings.samples_per_hit,
        "pilot-spp": settings.pilot_samples,
        "min-fraction": f"{settings.min_fraction:.6g}",
        **light_paths.options(settings.id_data),
    }
    return f"{OWN}:" + ",".join(f"{key}={value}" for key, value in pairs.items())
