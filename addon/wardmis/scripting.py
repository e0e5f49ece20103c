# SPDX-License-Identifier: GPL-3.0-or-later
"""`import wardmis` in scripts, also where the add-on is an extension, whose module has a longer name (bl_ext.REPOSITORY.wardmis).

What scripts find there is what the add-on is meant to be used by, not its modules: those must not be loaded a second time.
"""

from __future__ import annotations

import sys
import types

from .comparison import compare
from .operators import export_scene

NAME = "wardmis"

_alias: types.ModuleType | None = None


def register() -> None:
    global _alias
    if __package__ != NAME and NAME not in sys.modules:
        _alias = types.ModuleType(NAME, f"The functions of {__package__} for scripts.")
        _alias.compare = compare  # type: ignore[attr-defined]
        _alias.export_scene = export_scene  # type: ignore[attr-defined]
        sys.modules[NAME] = _alias


def unregister() -> None:
    global _alias
    if _alias is not None and sys.modules.get(NAME) is _alias:
        del sys.modules[NAME]
    _alias = None
