# SPDX-License-Identifier: GPL-3.0-or-later
"""What stands in for a node, or one of its outputs, that has no counterpart here: the value nearest to what it gives on the whole,
and its name in words.

Never black or half where that is not its mean: a surface keeps its colour, a lamp its power, a sky its light.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..tree import NodeUse
from .builder import Value
from .reader import Reader

Neutral = Callable[[NodeUse, Any, Reader], tuple[Value, str]]


def _outputs(default: float = 0.0, **values: float) -> Neutral:
    """By the output's name, with _ for a space."""
    by_name = {name.replace("_", " "): value for name, value in values.items()}

    def neutral(_use: NodeUse, output: Any, _p: Reader) -> tuple[Value, str]:
        value = by_name.get(output.name, default)
        return value, f"{value:g} as its {output.name}"

    return neutral


def _strength(use: NodeUse, _output: Any, p: Reader) -> tuple[Value, str]:
    return p.read(use, "Strength"), "its Strength"


NEUTRAL: dict[str, Neutral] = {
    f"ShaderNode{name}": neutral
    for name, neutral in {
        "NewGeometry": _outputs(Pointiness=0.5, Random_Per_Island=0.5),
        "HairInfo": _outputs(),
        "ParticleInfo": _outputs(Random=0.5),
        "VolumeInfo": _outputs(),
        "LightPath": _outputs(),
        "RadialTiling": _outputs(0.5),
        "Raycast": _outputs(),
        "TexIES": _strength,
        "TexPointDensity": _outputs(),
        "Wireframe": _outputs(),
    }.items()
}
