# SPDX-License-Identifier: GPL-3.0-or-later
"""WardMIS: a render engine with the Ward BRDF and multiple importance sampling under chosen allocations of the samples."""

bl_info = {
    "name": "WardMIS",
    "author": "The WardMIS developers",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "category": "Render",
    "location": "Render Properties > Render Engine; File > Export",
    "description": "Ward reflectance with multiple importance sampling under chosen allocations of the samples",
}

from . import (  # noqa: E402
    comparison,
    data_panels,
    engine,
    nodes,
    operators,
    panels,
    passes,
    preferences,
    properties,
    rendering,
    scripting,
    support,
    temporary,
    warning_panels,
    warnings,
)
from .comparison import compare  # noqa: E402
from .operators import export_scene  # noqa: E402

__all__ = ["compare", "export_scene", "register", "unregister"]

_PARTS = (
    temporary,
    rendering,
    warnings,
    preferences,
    properties,
    passes,
    nodes,
    engine,
    operators,
    warning_panels,  # above the settings: it is there only when there is something to be said
    panels,
    data_panels,
    comparison,
    support,
    scripting,
)


def register() -> None:
    for part in _PARTS:
        part.register()


def unregister() -> None:
    rendering.end()  # before anything that it needs goes
    for part in reversed(_PARTS):
        part.unregister()
