# SPDX-License-Identifier: GPL-3.0-or-later
"""The renders of another renderer, as `wardmis converge --external` reads them (docs/report-format.md). No bpy in here.

It is written after each render, whole, under a temporary name (one process at a time is in the folder), so that a comparison which was stopped goes on where it was.
"""

from __future__ import annotations

import contextlib
import json
from pathlib import Path
from typing import Any

from ..exr import read_pass


class Manifest:
    """The file `path`, its images beside it."""

    def __init__(self, path: Path, about: dict[str, Any], shape: tuple[int, int]) -> None:
        """`about`: name, renderer, settings, notes, common_reference. Takes over what an earlier run has rendered with it, where that
        is whole and has the images' `shape` (rows, columns).

        Raises RuntimeError where the earlier renders are of another scene or were made with other settings.
        """
        self.path = path
        self.shape = shape
        self.damaged: list[Path] = []  # of the earlier images
        self.data: dict[str, Any] = {**about, "max_spp": None, "reference": {"images": [], "spp": None}, "runs": []}
        if path.exists():
            self._resume(_read(path))

    def _resume(self, old: dict[str, Any]) -> None:
        for key in ("renderer", "settings"):
            if old.get(key) != self.data[key]:
                raise RuntimeError(
                    f"WardMIS: {self.path.parent} holds renders of another comparison: {_difference(key, old.get(key), self.data[key])}; "
                    "choose another output folder, or delete that one"
                )
        self.data["runs"] = [run for run in old["runs"] if self._there(run["path"])]
        # earlier manifests do not say it
        self.data["max_spp"] = old.get("max_spp", max((run["spp"] for run in self.data["runs"]), default=None))
        images = [name for name in old["reference"]["images"] if self._there(name)]
        self.data["reference"] = {"images": images, "spp": old["reference"]["spp"]}

    @property
    def max_spp(self) -> int | None:
        """Samples per pixel of the last checkpoint; none as long as that is not decided."""
        return self.data["max_spp"]

    @property
    def reference_spp(self) -> int:
        """Of each of the reference's images."""
        return self.data["reference"]["spp"]

    def decide(self, max_spp: int, reference_spp: int) -> None:
        """Images of a reference of other samples are no part of it any more."""
        self.data["max_spp"] = max_spp
        if self.reference_spp != reference_spp:
            self.data["reference"] = {"images": [], "spp": reference_spp}
        self.write()

    def _there(self, name: str) -> bool:
        path = self.path.parent / name
        if not path.is_file():
            return False
        with contextlib.suppress(OSError):
            if read_pass(path).shape[:2] == self.shape:
                return True
        self.damaged.append(path)
        return False

    def has_run(self, seed: int, spp: int) -> bool:
        return any((run["seed"], run["spp"]) == (seed, spp) for run in self.data["runs"])

    def has_reference(self, name: str) -> bool:
        return name in self.data["reference"]["images"]

    def add_run(self, seed: int, spp: int, name: str, wall: float | None, cpu: float | None) -> None:
        self.data["runs"].append({"seed": seed, "spp": spp, "path": name, "wall": wall, "cpu": cpu})
        self.data["runs"].sort(key=lambda run: (run["seed"], run["spp"]))
        self.write()

    def add_reference(self, name: str) -> None:
        self.data["reference"]["images"].append(name)
        self.write()

    def write(self) -> None:
        temporary = self.path.with_name(f".{self.path.name}.tmp")
        try:
            temporary.write_text(json.dumps(self.data, indent=1, ensure_ascii=False), encoding="utf-8")
            temporary.replace(self.path)
        finally:
            temporary.unlink(missing_ok=True)


def _read(path: Path) -> dict[str, Any]:
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
        data["reference"]["images"], data["reference"]["spp"], data["runs"], data["settings"]
        if not isinstance(data.get("max_spp"), (int, type(None))):
            raise TypeError(f'"max_spp" is {data["max_spp"]!r}')
    except (ValueError, KeyError, TypeError) as error:
        raise RuntimeError(
            f"WardMIS: {path} is no list of renders ({error}); delete it to render them again"
        ) from error
    return data


def _difference(key: str, old: Any, new: Any) -> str:
    if isinstance(old, dict) and isinstance(new, dict):
        names = [name for name in {**old, **new} if old.get(name) != new.get(name)]
        return "; ".join(f"{name} was {old.get(name)} and is {new.get(name)}" for name in names[:3])
    return f"{key} was {old} and is {new}"
