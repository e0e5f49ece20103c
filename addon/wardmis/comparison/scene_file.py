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

    @property
    def shiny(self) -> list[str]:
        """The materials that reflect specularly: by Ward's model here, by another one elsewhere."""
        materials = self.document.get("materials", [])
        return [m["name"] for m in materials if "specular" in m.get("extensions", {}).get(EXTENSION, {})]

    def other_than_blenders(self) -> list[str]:
        """Why WardMIS' converged image is not that of Cycles; empty where both have the same integrand."""
        shiny = self.shiny
        if not shiny:
            return list(self.notes)
        names = ", ".join(f"'{name}'" for name in shiny[:3]) + (f" and {len(shiny) - 3} more" if len(shiny) > 3 else "")
        return [f"WardMIS shows Ward's reflection, Cycles Beckmann's or GGX, of material {names}", *self.notes]


def read_scene_file(path: Path) -> SceneFile:
    data = path.read_bytes()
    (length,) = struct.unpack_from("<I", data, 12)
    return SceneFile(hashlib.sha256(data).hexdigest(), json.loads(data[20 : 20 + length]))
