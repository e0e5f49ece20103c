# SPDX-License-Identifier: GPL-3.0-or-later
"""The scenes, a module a topic; importing them fills stage.SCENES."""

import importlib
import pkgutil

for _module in pkgutil.iter_modules(__path__):
    importlib.import_module(f"{__name__}.{_module.name}")
