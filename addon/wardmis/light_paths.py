# SPDX-License-Identifier: GPL-3.0-or-later
"""How far light is followed, in Cycles' numbers: the scene's own limits, or those that Cycles has."""

from __future__ import annotations

from typing import Any, NamedTuple

LONGEST = 1024  # of the command, in surface hits and in bounces


class Bounces(NamedTuple):
    """At most so many of a path. What a ray meets beyond still gives its own light, and reflects none."""

    total: int
    diffuse: int
    glossy: int

    def __str__(self) -> str:
        return f"{self.total} in all, {min(self.diffuse, self.total)} diffuse, {min(self.glossy, self.total)} glossy"


def of_cycles(scene: Any) -> Bounces:
    """Its defaults where its add-on is off."""
    cycles = getattr(scene, "cycles", None)
    return Bounces(
        *(getattr(cycles, f"{kind}_bounces", least) for kind, least in (("max", 12), ("diffuse", 4), ("glossy", 4)))
    )


def of_paths(scene: Any) -> Bounces:
    """Those of the integrator Path."""
    settings = scene.wardmis
    if settings.bounces == "cycles":
        return of_cycles(scene)
    return Bounces(settings.max_depth - 1, settings.max_diffuse, settings.max_glossy)


def in_force(scene: Any) -> Bounces:
    return Bounces(0, 0, 0) if scene.wardmis.integrator == "direct" else of_paths(scene)


def ends_sooner(a: Bounces, b: Bounces) -> bool:
    """Whether `a` leaves light out that `b` shows."""
    return any(min(x, a.total) < min(y, b.total) for x, y in zip(a, b))


def options(scene: Any) -> dict[str, int]:
    """For the command, without dashes; only the limits by kind that limit anything."""
    limits = of_paths(scene)
    result = {"max-depth": min(limits.total + 1, LONGEST)}
    for kind, bounces in (("diffuse", limits.diffuse), ("glossy", limits.glossy)):
        if bounces < limits.total:
            result[f"max-{kind}"] = bounces
    return result
