# SPDX-License-Identifier: GPL-3.0-or-later
"""The comparison: the scene under several configurations, and by Cycles, until the error against time of each is known.

`wardmis converge` (docs/command.md) renders, measures and reports; here is what only Blender can do: the scene, the same scene by
Cycles, and the result shown. The parts without bpy say so.
"""

from . import command_line, images, job, leaving, operators, panels, properties
from .run import compare, prepare

__all__ = ["compare", "prepare", "register", "unregister"]

_PARTS = (images, properties, operators, panels, job, leaving, command_line)


def register() -> None:
    for part in _PARTS:
        part.register()


def unregister() -> None:
    for part in reversed(_PARTS):
        part.unregister()
