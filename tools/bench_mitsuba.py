# SPDX-License-Identifier: GPL-3.0-or-later
"""Error and time of the default beside Mitsuba 3's path tracer (LLVM), on scenes of Ward lobes that Mitsuba has as
Beckmann's of the same roughness, each program against its own reference. Needs mitsuba of PyPI. Run by ./dev bench
mitsuba."""

import argparse
import importlib
import json
import math
import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import median
from time import perf_counter, process_time
from typing import Any

import blender
import numpy as np
from bench import DEFAULT, EQUAL, Interval, asked, converged, of_all_pixels
from markdown import table

SCENES = ("veach", "veach-direct", "teapot", "teapot-direct", "veach-mesh-lights")
SURFACES = {"path": 8, "direct": 1}  # that a path may meet, as in the command
REFERENCES, REFERENCE_SAMPLES = 2, 4096
ROUNDS = 3  # pairs of renders that a sample's time is measured by
COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}
NUMBERS = {5126: "<f4", 5125: "<u4", 5123: "<u2", 5121: "u1"}


class Scene:
    """A scene file of the command, as far as the scenes of this bench use it, for Mitsuba's load_dict."""

    def __init__(self, mi: Any, glb: Path) -> None:
        self.mi = mi
        content = glb.read_bytes()
        end = 20 + int.from_bytes(content[12:16], "little")
        self.json, self.buffer = json.loads(content[20:end]), content[end + 8 :]
        self.own = self.json["extensions"]["WARDMIS_scene"]

    def bytes_of(self, view: int) -> bytes:
        of = self.json["bufferViews"][view]
        begin = of.get("byteOffset", 0)
        return self.buffer[begin : begin + of["byteLength"]]

    def array(self, accessor: int) -> np.ndarray:
        of = self.json["accessors"][accessor]
        values = np.frombuffer(self.bytes_of(of["bufferView"]), NUMBERS[of["componentType"]])
        width = COMPONENTS[of["type"]]
        return values[: of["count"] * width].reshape(-1, width)

    def material(self, index: int) -> dict[str, Any]:
        of = self.json["materials"][index]["extensions"]["WARDMIS_scene"]
        rgb = {name: np.array(of[name]["value"]) for name in ("diffuse", "specular") if name in of}
        if "specular" not in rgb:
            return {"type": "twosided", "bsdf": self.diffuse(rgb.get("diffuse", np.zeros(3)))}
        lobe = {
            "type": "roughconductor",
            "distribution": "beckmann",
            "material": "none",
            "alpha_u": of["alphaX"]["value"],
            "alpha_v": of["alphaY"]["value"],
            "specular_reflectance": self.color(2 * rgb["specular"]),
        }
        # half of twice each is their sum
        both = {"type": "blendbsdf", "weight": 0.5, "first": self.diffuse(2 * rgb["diffuse"]), "second": lobe}
        return {"type": "twosided", "bsdf": both}

    def diffuse(self, color: np.ndarray) -> dict[str, Any]:
        return {"type": "diffuse", "reflectance": self.color(color)}

    def color(self, value: Any) -> dict[str, Any]:
        return {"type": "rgb", "value": [float(v) for v in value]}

    def shape(self, primitive: dict[str, Any], matrix: np.ndarray) -> Any:
        mi = self.mi
        points = self.array(primitive["attributes"]["POSITION"]) @ matrix[:3, :3].T + matrix[:3, 3]
        faces = self.array(primitive["indices"])
        props = mi.Properties()
        props["bsdf"] = mi.load_dict(self.material(primitive["material"]))
        emission = self.json["materials"][primitive["material"]]["extensions"]["WARDMIS_scene"].get("emission")
        if emission:
            props["emitter"] = mi.load_dict({"type": "area", "radiance": self.color(emission["value"])})
        normals = primitive["attributes"].get("NORMAL")
        mesh = mi.Mesh("mesh", len(points), faces.size // 3, has_vertex_normals=normals is not None, props=props)
        parameters = mi.traverse(mesh)
        parameters["vertex_positions"] = points.astype("f4").ravel()
        parameters["faces"] = faces.astype("u4").ravel()
        if normals is not None:
            turned = self.array(normals) @ np.linalg.inv(matrix[:3, :3])
            parameters["vertex_normals"] = (turned / np.linalg.norm(turned, axis=1, keepdims=True)).astype("f4").ravel()
        parameters.update()
        return mesh

    def lamp(self, of: dict[str, Any], matrix: np.ndarray) -> dict[str, Any]:
        radiance = of["intensity"] / (math.pi * of["radius"] ** 2) * np.array(of["color"])
        return {
            "type": "sphere",
            "center": [float(v) for v in matrix[:3, 3]],
            "radius": of["radius"],
            "emitter": {"type": "area", "radiance": self.color(radiance)},
        }

    def sky(self, of: dict[str, Any]) -> dict[str, Any]:
        if "texture" not in of:
            return {"type": "constant", "radiance": self.color(of["radiance"])}
        image = self.json["images"][self.json["textures"][of["texture"]["index"]]["source"]]
        stream = self.mi.MemoryStream()
        stream.write(self.bytes_of(image["bufferView"]))
        stream.seek(0)
        return {"type": "envmap", "bitmap": self.mi.Bitmap(stream)}

    def camera(self, of: dict[str, Any], matrix: np.ndarray, size: tuple[int, int]) -> dict[str, Any]:
        x0, x1, _, _ = of["extensions"]["WARDMIS_scene"]["viewPlane"]
        turned = matrix @ np.diag([-1.0, 1.0, -1.0, 1.0])  # Mitsuba's looks along +z, its x to the left
        return {
            "type": "perspective",
            "fov": math.degrees(2 * math.atan((x1 - x0) / 2)),
            "fov_axis": "x",
            "to_world": self.mi.ScalarTransform4f(turned),
            "film": {
                "type": "hdrfilm",
                "width": size[0],
                "height": size[1],
                "rfilter": {"type": "box"},
                "pixel_format": "rgb",
            },
            "sampler": {"type": "multijitter"},  # of its samplers the one with least error here
        }

    def loaded(self, surfaces: int, size: tuple[int, int]) -> Any:
        lamps = self.own.get("lights", [])
        integrator = {"type": "path", "max_depth": surfaces + 1}
        scene: dict[str, Any] = {"type": "scene", "integrator": integrator}

        def place(index: int, above: np.ndarray) -> None:
            node = self.json["nodes"][index]
            matrix = above @ np.array(node.get("matrix", np.eye(4).ravel())).reshape(4, 4).T
            own = node.get("extensions", {}).get("WARDMIS_scene", {})
            if "mesh" in node:
                for k, primitive in enumerate(self.json["meshes"][node["mesh"]]["primitives"]):
                    scene[f"shape_{index}_{k}"] = self.shape(primitive, matrix)
            if "light" in own:
                scene[f"lamp_{index}"] = self.lamp(lamps[own["light"]], matrix)
            if "camera" in node:
                scene["camera"] = self.camera(self.json["cameras"][node["camera"]], matrix, size)
            for child in node.get("children", []):
                place(child, matrix)

        for root in self.json["scenes"][self.json["scene"]]["nodes"]:
            place(root, np.eye(4))
        if "world" in self.own and any(self.own["world"]["radiance"]):
            scene["sky"] = self.sky(self.own["world"])
        return self.mi.load_dict(scene)


def squares(samples: int) -> list[int]:
    """Powers of four up to `samples`: other numbers are rounded up by the sampler."""
    counts = [1]
    while counts[-1] < samples:
        counts.append(4 * counts[-1])
    if counts[-1] != samples or samples < 16:
        sys.exit(f"bench: --samples {samples}: give a power of four from 16 on")
    return counts


def manifest(mi: Any, scene: Any, folder: Path, options: argparse.Namespace) -> Path:
    """Renders of each seed and number of samples, for `converge --external`."""
    counts = squares(options.samples)

    def render(samples: int, seed: int) -> tuple[Any, float, float]:
        wall, cpu = perf_counter(), process_time()
        image = mi.render(scene, spp=samples, seed=seed)
        image = np.array(image)  # which waits for it
        return image, perf_counter() - wall, process_time() - cpu

    def per_sample() -> tuple[float, float]:
        """Wall and processor time without what each render takes to begin: to trace and to look up the program."""
        pairs, few = [], counts[1]
        for number in range(ROUNDS + 1):  # the first one compiles
            (_, *short), (_, *long) = render(few, number), render(options.samples, number)
            pairs.append([(b - a) / (options.samples - few) for a, b in zip(short, long, strict=True)])
        return median(p[0] for p in pairs[1:]), median(p[1] for p in pairs[1:])

    def write(name: str, samples: int, seed: int) -> str:
        image, _, _ = render(samples, seed)
        mi.Bitmap(image).write(str(folder / name))
        return name

    wall, cpu = per_sample()
    runs = [
        {
            "seed": seed,
            "spp": samples,
            "path": write(f"run-{seed}-{samples}.exr", samples, 1000 * seed + samples),
            "wall": wall * samples,
            "cpu": cpu * samples,
        }
        for seed in range(1, options.seeds + 1)
        for samples in counts
    ]
    references = [write(f"reference-{k}.exr", REFERENCE_SAMPLES, 900000 + k) for k in range(REFERENCES)]
    out = folder / "manifest.json"
    document = {
        "name": "Mitsuba",
        "renderer": f"Mitsuba {mi.__version__} ({mi.variant()})",
        "settings": {"samples": "those of each run"},
        "notes": ["the time of a sample, without what each render takes to begin"],
        "reference": {"images": references, "spp": REFERENCE_SAMPLES},
        "common_reference": False,
        "runs": runs,
    }
    out.write_text(json.dumps(document) + "\n")
    return out


@dataclass
class Row:
    scene: str
    efficiency: Interval | None  # 1 / (relMSE x time) of the default over Mitsuba's
    equal: Interval | None  # the same over equal counts'
    time: float  # of the default by Mitsuba's, at the same camera samples
    error: float  # the same of the error by `metric`
    metric: str  # as the report has it


def row(scene: str, report: dict[str, Any]) -> Row:
    of = {c["name"]: c for c in report["configurations"]}
    peer, own = of["Mitsuba"], of[DEFAULT]
    clock, metric = report["effort_clock"], report["metric"]
    last = [{name: c["curve"][-1][name]["mean"] for name in (clock, metric)} for c in (own, peer)]
    over, equal = Interval.of(peer["efficiency"]["ratio"]), Interval.of(of[EQUAL]["efficiency"]["ratio"])
    return Row(scene, over, equal, last[0][clock] / last[1][clock], last[0][metric] / last[1][metric], metric)


def measured(mi: Any, name: str, options: argparse.Namespace) -> Row:
    glb = blender.exported(name.removesuffix("-direct"), options.out)
    print(f"bench: {name}", file=sys.stderr, flush=True)
    folder = options.out / f"{name}-mitsuba"
    images = folder / "mitsuba"
    images.mkdir(parents=True, exist_ok=True)
    width, height = map(int, options.resolution.split("x"))
    scene = Scene(mi, glb).loaded(SURFACES["direct" if name.endswith("-direct") else "path"], (width, height))
    words: list[str | Path | int] = [
        "-c",
        f"{DEFAULT}:allocation=auto,pixels=auto",
        "-c",
        EQUAL,
        "--max-depth",
        SURFACES["path"],
    ]
    words += ["--external", manifest(mi, scene, images, options)]
    return row(name, converged(name, folder / "study", options, *words))


def main() -> int:
    options = asked("mitsuba", __doc__, SCENES, "scenes, studies and mitsuba.json")
    try:
        mi = importlib.import_module("mitsuba")
        mi.set_variant("llvm_ad_rgb")
        mi.set_log_level(mi.LogLevel.Error)
    except ImportError as error:
        sys.exit(
            f"bench: Mitsuba is not measured: {error}; install mitsuba from PyPI for the Python that PYTHON names (docs/performance.md)"
        )
    rows = []
    for scene in options.scenes:
        try:
            rows.append(measured(mi, scene, options))
        except blender.RenderFailed as error:
            sys.exit(f"bench: {error}")
        (options.out / "mitsuba.json").write_text(json.dumps([asdict(r) for r in rows], indent=1) + "\n")
    print(
        f"Mitsuba {mi.__version__}; {options.samples} samples per pixel, {options.resolution}, {options.seeds} seeds\n"
    )
    headings = (
        "scene",
        "efficiency / Mitsuba's",
        "/ equal counts'",
        "time / Mitsuba's",
        "error / Mitsuba's",
    )
    cells = ((r.scene, str(r.efficiency), str(r.equal), f"{r.time:.2f}", f"{r.error:.2g}") for r in rows)
    print(table(headings, cells))
    print(of_all_pixels({r.scene: r.metric for r in rows}), end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
