# SPDX-License-Identifier: GPL-3.0-or-later
"""Who gets how many samples, and how they are weighted, as the scene's settings say it and as the command hears it. No bpy in here."""

from __future__ import annotations

from typing import Any

WITHOUT_PILOT = {"equal", "albedo"}  # the other allocations measure first


def yields(settings: Any) -> bool:
    """Whether the automatic allocation, which predicts for balance weights, gives way to equal counts, as the command's default does."""
    return settings.allocation == "auto" and settings.weights not in {"auto", "balance"}


def uses_pilot(settings: Any) -> bool:
    return settings.allocation not in WITHOUT_PILOT and not yields(settings)


def options(settings: Any) -> dict[str, str]:
    """Of the command, whose default yields only where it is not given."""
    allocation = {} if yields(settings) else {"allocation": settings.allocation}
    return {**allocation, "pixels": settings.pixels, "weights": settings.weights, **ways(settings)}


def ways(settings: Any) -> dict[str, str]:
    """How many paths from the lights there are, and what becomes of them."""
    if settings.integrator != "bidirectional":
        return {}
    return {
        "light-paths": f"{settings.light_paths:.6g}",
        "connections": str(settings.connections),
        "later-connections": str(settings.later_connections),
        "light-tracing": "true" if settings.light_tracing else "false",
    }
