# SPDX-License-Identifier: GPL-3.0-or-later
"""The names that Cycles has for what it knows itself: an Attribute node that has one of them reads that, and never the user's own."""

from __future__ import annotations

from typing import Any

from ... import compat
from ..attribute import DEFAULT_COLOR, INTERCEPT, LENGTH, OF_CYCLES, POINT_RANDOM, RANDOM
from ..tree import NodeUse
from .builder import Value
from .reader import Reader

# operations, and by which factors their numbers become a node's Fac
PLACES = {"uv": (1.0, 0.0, 0.0), "generated": (1 / 3, 1 / 3, 1 / 3)}
KNOWN = {
    "vertex_color": DEFAULT_COLOR,
    "curve_intercept": INTERCEPT,
    "curve_length": LENGTH,
    "curve_random": RANDOM,
    "point_random": POINT_RANDOM,
}
UNSUPPORTED = {"pointiness", "random_per_island", "tangent", "tangent_sign"}
OF_MESHES: set[str] = set()
# of volumes, of particles and of what Cycles keeps to itself: 0 on a surface
ELSEWHERE = {
    "density",
    "color",
    "flame",
    "heat",
    "temperature",
    "velocity",
    "velocity_x",
    "velocity_y",
    "velocity_z",
    "particle",
    "undeformed",
    "ptex_face_id",
    "ptex_uv",
    "generated_transform",
    "shadow_transparency",
}
if compat.CYCLES < 5:
    ELSEWHERE |= {"motion_P", "motion_N"}
    OF_MESHES |= {"N", "Ng"}
    UNSUPPORTED |= {"undisplaced"}
else:  # in the world or not, as Cycles keeps the mesh
    ELSEWHERE |= {"undisplaced"}
    UNSUPPORTED |= {"N"}

ALL = PLACES.keys() | KNOWN.keys() | UNSUPPORTED | ELSEWHERE | OF_MESHES


def place_of(name: str, output: Any, p: Reader) -> Value | None:
    """What an output of an Attribute node is where the name is that of coordinates; None: it is not."""
    if name not in PLACES or p.kind != "material":
        return None
    if output.name == "Alpha":
        return 1.0
    value = p.place(name)
    return p("vector-dot", value, PLACES[name]) if output.type == "VALUE" else value


def known_as(use: NodeUse, name: str) -> str:
    """How the attribute is called that an Attribute node of this name reads."""
    if name in UNSUPPORTED:
        use.note(f"reads '{name}', which Cycles makes of the mesh; this is not supported, and 0 is used instead")
    return KNOWN.get(name) or (f"{OF_CYCLES}{name}" if name in ALL else name)
