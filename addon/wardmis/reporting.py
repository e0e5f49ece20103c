# SPDX-License-Identifier: GPL-3.0-or-later
"""How an operator of ours fails: with the message of its RuntimeError."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

Execute = Callable[[Any, Any], set[str]]


def reported(execute: Execute) -> Execute:
    @functools.wraps(execute)
    def wrapped(self: Any, context: Any) -> set[str]:
        try:
            return execute(self, context)
        except RuntimeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}

    return wrapped
