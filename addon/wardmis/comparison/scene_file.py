# SPDX-License-Identifier: GPL-3.0-or-later
"""What an exported scene says about itself: which renderer can show the same. No bpy in here."""

from __future__ import annotations

import hashlib
import json
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any

EXTENSION = "WARDMIS_scene"
WARD = "WardMIS shows Ward's reflection, Cycles Beckmann's"
WALK = "WardMIS shows GGX whose lost energy is added evenly, Cycles before 4.0 light that walks from facet to facet"
BECKMANN = "WardMIS shows anisotropic Beckmann reflection, of which Cycles before 4.0 draws both axes by one roughness"


@dataclass
class SceneFile:
    sha256: str
    document: dict[str, Any]

    @property
    def film(self) -> dict[str, Any]:
        return self.document["extensions"][EXTENSION]["film"]

    @property
    def notes(self) -> list[str]:
        return self.document["extensions"][EXTENSION]["notes"]

    def other_than_blenders(self) -> list[str]:
        """Why WardMIS' converged image is not that of Cycles; empty where both have the same integrand."""
        materials: dict[str, list[str]] = {}
        for material in self.document.get("materials", []):
            for difference in sorted(_differences(material.get("extensions", {}).get(EXTENSION, {}))):
                materials.setdefault(difference, []).append(material["name"])
        return [f"{difference}, of material {_named(names)}" for difference, names in materials.items()] + self.notes


def _differences(surface: dict[str, Any]) -> set[str]:
    """What of a material's extension Cycles has no equal of."""
    found = {WARD} if "specular" in surface else set()
    for closure in surface.get("closures", []):
        found |= {WARD} if closure["type"] == "ward" else set()
        distribution = closure.get("distribution")
        found |= {WALK} if distribution == "multi-ggx" and closure.get("version") == 3 else set()
        one_axis = closure.get("alphaX") == closure.get("alphaY")
        found |= {BECKMANN} if distribution == "beckmann" and closure.get("version") == 3 and not one_axis else set()
    return found


def _named(names: list[str]) -> str:
    return ", ".join(f"'{name}'" for name in names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")


def read_scene_file(path: Path) -> SceneFile:
    data = path.read_bytes()
    (length,) = struct.unpack_from("<I", data, 12)
    return SceneFile(hashlib.sha256(data).hexdigest(), json.loads(data[20 : 20 + length]))
