# SPDX-License-Identifier: GPL-3.0-or-later
"""report.json of a comparison (docs/report-format.md), for what Blender shows of it. No bpy in here."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

SCHEMA = "wardmis-report-1"
REFERENCE = "reference"  # its image, among those of the configurations
# "baseline", of the one that the others are compared with, is none
VERDICTS = {
    "faster": "faster",
    "slower": "slower",
    "tie": "no difference found",
    "not reached": "target not surely reached",
    "under from the start": "under the target from the start",
    "not compared": "the baseline has no time",
}
# of a configuration of the command: by its name, that of the scene's setting
SETTINGS = {
    "allocation": "allocation",
    "weights": "weights",
    "integrand": "integrand",
    "integrator": "integrator",
    "sampler": "sampler",
    "samples_per_hit": "samples_per_hit",
    "pilot_spp": "pilot_samples",
    "min_fraction": "min_fraction",
    "light_paths": "light_paths",
    "connections": "connections",
    "later_connections": "later_connections",
    "light_tracing": "light_tracing",
    "max_depth": "max_depth",
}


@dataclass
class Row:
    """A configuration in words: nothing where a figure is not known."""

    name: str
    error: str = ""  # at equal time
    ratio: str = ""  # to the baseline's, with its interval
    verdict: str = ""  # on the time to the target


@dataclass
class Curve:
    name: str
    seconds: list[float]
    error: list[float]
    low: list[float]
    high: list[float]


class Report:
    """Raises RuntimeError where `folder` has none that this add-on understands."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        path = folder / "report.json"
        try:
            self.data: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        except OSError as error:
            raise RuntimeError(
                f"WardMIS: there is no report in {folder} ({error.strerror}); choose the folder of a comparison"
            ) from error
        except ValueError as error:
            raise RuntimeError(f"WardMIS: {path} is damaged ({error}); compare again") from error
        schema = self.data.get("schema") if isinstance(self.data, dict) else None
        if schema != SCHEMA:
            raise RuntimeError(
                f"WardMIS: {path} is of the kind {schema}, not {SCHEMA}; compare again with this version"
            )

    @property
    def html(self) -> Path:
        return self.folder / "report.html"

    @property
    def configurations(self) -> list[dict[str, Any]]:
        return self.data["configurations"]

    @property
    def image_names(self) -> list[str]:
        """What can be looked at, the reference last."""
        names = [c["name"] for c in self.configurations if self.image(c["name"]).is_file()]
        return [*names, REFERENCE] if self.image(REFERENCE).is_file() else names

    def image(self, name: str) -> Path:
        if name == REFERENCE:
            return self.folder / "reference.exr"
        # earlier reports do not say it
        file = next(c.get("image", f"{name}.exr") for c in self.configurations if c["name"] == name)
        return self.folder / "images" / file

    @property
    def equal_seconds(self) -> float | None:
        return next((c["equal_time"]["seconds"] for c in self.configurations if c.get("equal_time")), None)

    @property
    def target(self) -> float | None:
        """The error whose time the verdicts are about."""
        return next((c["time_to_target"]["target"] for c in self.configurations if c.get("time_to_target")), None)

    @property
    def clock(self) -> str:
        """Which time counts: "wall", or "cpu" where the machine was too busy for the other."""
        return str(self.data.get("clock", "wall"))

    @property
    def metric(self) -> str:
        """As it is written."""
        name = self.data.get("metric", "relmse")
        return next((m["label"] for m in self.data.get("metrics", []) if m["name"] == name), str(name))

    @property
    def verdict(self) -> str:
        """What to use, and what it brings, in a line; nothing in earlier reports."""
        return str((self.data.get("verdict") or {}).get("text", ""))

    @property
    def why(self) -> list[str]:
        """Of configurations that are better in one column and worse in another."""
        return list((self.data.get("verdict") or {}).get("why", []))

    @property
    def recommended(self) -> str | None:
        """The configuration to use."""
        return (self.data.get("verdict") or {}).get("use")

    def speeds(self) -> tuple[float | None, float | None]:
        """Camera samples a second by the wall clock: of the slowest configuration, and of the slowest other renderer."""
        pixels = self.data["width"] * self.data["height"]
        own: list[float] = []
        others: list[float] = []
        for c in self.configurations:
            last = c["curve"][-1]
            if last.get("wall") and last["wall"]["mean"] > 0:
                list_ = own if c.get("estimates") else others
                list_.append(pixels * last["spp"] / last["wall"]["mean"])
        return min(own, default=None), min(others, default=None)

    def settings(self, name: str) -> dict[str, Any]:
        """Of a configuration, by the names that a scene's settings have."""
        found = next(c["settings"] for c in self.configurations if c["name"] == name)
        return {SETTINGS[key]: value for key, value in found.items() if key in SETTINGS}

    def rows(self) -> list[Row]:
        return [_row(c) for c in self.configurations]

    def curves(self) -> list[Curve]:
        """Error against time; without what is not positive, which has no place on the scales."""
        curves = []
        for c in self.configurations:
            curve = Curve(c["name"], [], [], [], [])
            for point in c.get("curve", []):
                seconds, error = point.get(self.clock), point.get(self.data.get("metric", "relmse"))
                if seconds and error and seconds["mean"] > 0 and error["mean"] > 0:
                    curve.seconds.append(seconds["mean"])
                    curve.error.append(error["mean"])
                    # an interval may reach below zero; the band then ends where it can still be seen
                    curve.low.append(max(error["low"], 0.1 * error["mean"]))
                    curve.high.append(error["high"])
            if curve.seconds:
                curves.append(curve)
        return curves


def _row(c: dict[str, Any]) -> Row:
    row = Row(c["name"])
    equal_time = c.get("equal_time") or {}
    if equal_time.get("error"):
        row.error = f"{equal_time['error']['mean']:.3g}"
    ratio = equal_time.get("ratio")
    if ratio:
        mean, low, high = (f"{x:.2f}" if x >= 0.1 else f"{x:.2g}" for x in (ratio["mean"], ratio["low"], ratio["high"]))
        row.ratio = f"{mean} ({low}–{high})"
    row.verdict = VERDICTS.get(str((c.get("time_to_target") or {}).get("verdict")), "")
    return row
