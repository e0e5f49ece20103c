# SPDX-License-Identifier: GPL-3.0-or-later
"""Every node that gives colours, numbers or vectors, by its type: what it gives at an output, as a value of a program."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..tree import NodeUse
from . import colors, inputs, patterns, sky, textures, vectors
from .builder import Value
from .reader import Reader

# None: this setting of the node, or this output, is not understood
NODES: dict[str, Callable[[NodeUse, Any, Reader], Value | None]] = {
    f"ShaderNode{name}": function
    for table in (inputs.NODES, colors.NODES, vectors.NODES, textures.NODES, patterns.NODES, sky.NODES)
    for name, function in table.items()
} | inputs.SHARED
