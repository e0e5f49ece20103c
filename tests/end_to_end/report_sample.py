# SPDX-License-Identifier: GPL-3.0-or-later
"""Reports made up for the tests of the page: one with everything that docs/report-format.md knows, one with the least, some odd ones; and
the page put together as native/report does it. `report_sample.py FOLDER` leaves them there."""

import base64
import html
import io
import json
import re
import sys
from pathlib import Path

import numpy as np
from PIL import Image

WEB = Path(__file__).resolve().parents[2] / "native" / "report" / "web"
WIDTH, HEIGHT = 192, 128
CHECKPOINTS = [1, 2, 4, 8, 16, 32, 64]
TARGET = 1e-3
NAMES = ("equal", "variance", "second-moment", "auto", "Cycles")
# Of each: relMSE at one sample per pixel, seconds a sample, pilot seconds, bias², slope.
BEHAVIOUR = {
    "equal": (0.130, 0.022, 0.0, 0.0, -1.0),
    "variance": (0.118, 0.020, 0.11, 0.0, -0.98),
    "second-moment": (0.082, 0.021, 0.11, 0.0, -1.01),
    "auto": (0.076, 0.0215, 0.12, 1.5e-4, -1.0),
    "Cycles": (0.125, 0.031, 0.0, 0.0, -0.86),
}
WAY_WIDTH, WAY_HEIGHT = 48, 32
MAP_REMARK = "variance reaches the target later than equal, although it is better on more of the map."
OBLIGATORY = (
    "schema",
    "title",
    "version",
    "created",
    "complete",
    "verdict",
    "finding",
    "baseline",
    "metric",
    "seeds",
    "checkpoints",
)


def interval(mean, spread=0.05):
    return {"mean": mean, "low": mean * (1 - spread), "high": mean * (1 + spread)}


# ---- images: arrays as the renderer has them, and as PNG ---------------------------------------------------------------


def png(pixels):
    stream = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(pixels, np.uint8), "RGB").save(stream, "PNG")
    return base64.b64encode(stream.getvalue()).decode()


def pack_radiance(image):
    """Mantissas above, the exponent below: value = m * 2^(e - 136)."""
    largest = image.max(axis=2)
    exponent = np.where(largest > 0, np.floor(np.log2(np.maximum(largest, 1e-38))) + 129, 0).clip(0, 255)
    mantissa = np.round(image * 2.0 ** (136 - exponent)[..., None]).clip(0, 255)
    below = np.zeros_like(mantissa)
    below[..., 0] = exponent
    return png(np.concatenate([mantissa, below]))


def pack_scalar(image, low, high):
    known = np.isfinite(image)
    q = np.round((np.where(known, image, low) - low) / (high - low) * 65534).clip(0, 65534).astype(int)
    return png(np.stack([q >> 8, q & 255, np.where(known, 0, 255)], axis=2))


def scene():
    """Something to look at: four plates that reflect lamps of four sizes, a bright spot, a dark floor."""
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH] / HEIGHT
    image = np.stack([0.03 + 0.10 * y, 0.03 + 0.09 * y, 0.04 + 0.08 * y], axis=2)
    for j in range(4):
        image[(y > 0.2 + 0.18 * j) & (y < 0.32 + 0.18 * j) & (x > 0.15) & (x < 1.35)] = (0.06, 0.07, 0.09)
        for i, colour in enumerate(((6, 1.2, 0.8), (1, 3.5, 1), (0.9, 1.4, 5), (4, 3, 0.9))):
            size = 0.012 * (1 + i) * (1 + 0.9 * j)
            spot = np.exp(-(((x - 0.3 - 0.3 * i) / size) ** 2) - ((y - 0.26 - 0.18 * j) / 0.06) ** 2) / (1 + 0.8 * i)
            image += spot[..., None] * np.array(colour)
    image[(x - 1.4) ** 2 + (y - 0.1) ** 2 < 0.004] = (40, 36, 30)
    return image


def images():
    """[(the entry of report.json without its size, base64)]"""
    rng = np.random.default_rng(1)
    reference = scene()
    listed = [
        ({"key": "reference", "label": "reference", "group": "image", "configuration": None, "kind": "radiance",
          "text": "The reference: 4096 samples per pixel, seeds of its own."}, pack_radiance(reference))
    ]  # fmt: skip
    errors = []
    for name in NAMES:
        noise = (0.25 * BEHAVIOUR[name][0] / 0.13) ** 0.5
        noisy = reference * rng.gamma(1 / noise**2, noise**2, reference.shape)
        listed.append(
            ({"key": name, "label": name, "group": "image", "configuration": name, "kind": "radiance",
              "text": "Mean of the seeds at the last checkpoint."}, pack_radiance(noisy))
        )  # fmt: skip
        relative = np.sqrt(((noisy - reference) ** 2 / (reference**2 + 0.01)).mean(axis=2))
        relative[:2] = np.nan
        errors.append(
            ({"key": f"{name}-error", "label": f"{name}: error", "group": "error", "configuration": name, "kind": "scalar",
              "low": -3.0, "high": 0.0, "log": True, "text": "Root of the mean relative square over the seeds."},
             pack_scalar(np.log10(np.maximum(relative, 1e-9)), -3, 0))
        )  # fmt: skip
    listed += errors
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH] / HEIGHT
    for k, name in enumerate(NAMES[1:4]):
        lobe = 0.15 + 0.6 * (y if k else x / 1.5)
        cosine = 0.15 * np.ones_like(lobe)
        shares = np.round(np.stack([lobe, cosine, 1 - lobe - cosine], axis=2) * 255)
        listed.append(
            ({"key": f"{name}-allocation", "label": f"{name}: allocation", "group": "allocation", "configuration": name,
              "kind": "rgb", "text": "Shares of the samples: red lobe, green cosine, blue light."}, png(shares))
        )  # fmt: skip
    pyramid = np.zeros((HEIGHT, WIDTH, 3))
    for way in ways():
        row, column = way["surfaces"] - 1, way["surfaces"] - way["by_camera"]
        pyramid[row * WAY_HEIGHT :, column * WAY_WIDTH :][:WAY_HEIGHT, :WAY_WIDTH] = 0.5
    for kind in ("ways", "ways alone"):
        listed.append(
            ({"key": f"auto/{kind}", "label": f"auto, {kind}", "group": "ways", "configuration": "auto", "kind": "radiance",
              "text": "What each way to make a path brings."}, pack_radiance(pyramid))
        )  # fmt: skip
    for name in NAMES[1:4]:
        index = np.where((x + y) % 0.7 < 0.2, 0, np.where((x - y) % 0.9 < 0.05, 1, 2))
        index[-4:] = 255
        colours = ("#0072b2", "#d55e00", "#8a8f96")
        classes = [{"name": n, "colour": c} for n, c in zip(("better", "worse", "undecided"), colours)]
        listed.append(
            ({"key": f"{name}-wins", "label": f"{name}: who wins", "group": "map", "configuration": name, "kind": "classes",
              "classes": classes, "text": f"Variance × time of {name} against equal, where significant."},
             png(np.repeat(index[..., None], 3, axis=2)))
        )  # fmt: skip
    deviation = np.sqrt((reference**2).mean(axis=2))
    listed.append(
        ({"key": "deviation", "label": "standard deviation", "group": "map", "configuration": "equal", "kind": "scalar",
          "low": 0.0, "high": 4.0, "log": False, "text": "Standard deviation of one sample per pixel."},
         pack_scalar(deviation, 0, 4))
    )  # fmt: skip
    return [({**entry, "width": WIDTH, "height": HEIGHT}, packed) for entry, packed in listed]


# ---- report.json -------------------------------------------------------------------------------------------------------


def curve(name, least=False):
    start, second, pilot, bias, slope = BEHAVIOUR[name]
    points = []
    for n in CHECKPOINTS:
        relmse = start * n**slope + bias
        wall = pilot + second * n
        point = {
            "spp": n, "wall": interval(wall, 0.02), "cpu": interval(1.9 * wall, 0.02), "rays": None, "samples": None,
            "mse": interval(0.4 * relmse), "relmse": interval(relmse, 0.04 + 0.1 / n**0.5), "near_floor": relmse < 1.3e-3,
        }  # fmt: skip
        if name != "Cycles":
            point |= {"rays": 550_000.0 * n, "samples": 295_000.0 * n}
        if not least:
            point |= {"relmse_trimmed": interval(0.7 * relmse), "mape": interval(0.6 * relmse**0.5, 0.02)}
            point |= {"smape": interval(0.55 * relmse**0.5, 0.02), "flip": interval(0.5 * relmse**0.4, 0.03)}
        points.append(point)
    return points


def ratio_of(name, spread=0.06):
    start, second, *_ = BEHAVIOUR[name]
    base = BEHAVIOUR["equal"]
    return interval(start * second / (base[0] * base[1]), spread if name != "variance" else 0.22)


def configuration(name):
    start, second, pilot, bias, slope = BEHAVIOUR[name]
    other, first = name == "Cycles", name == "equal"
    ratio = interval(1, 0) if first else ratio_of(name)
    verdict = "tie" if ratio["low"] <= 1 <= ratio["high"] else "faster" if ratio["mean"] < 1 else "slower"
    rng = np.random.default_rng(len(name))
    edges = np.linspace(-4, 4, 33)
    counts = np.histogram(rng.normal(0.02, 0.5 + 0.1 * len(name) / 5, WIDTH * HEIGHT).clip(-4, 4), edges)[0]
    groups = [
        ("object", ("floor", "plate 1", "plate 2", "plate 3", "plate 4", "lamp")),
        ("material", ("rough metal", "smooth metal", "matte")),
        ("stiffness", ("α < 0.01", "0.01 ≤ α < 0.1", "α ≥ 0.1")),
    ]
    return {
        "name": name,
        "renderer": "Cycles 3.4.1" if other else "WardMIS",
        "settings": {"samples": 64, "use_denoising": False} if other else {"allocation": name, "weights": "balance", "sampler": "independent"},
        "description": "path tracing, light sampling and MIS" if other else f"allocation {name}, weights balance",
        "kernel": "" if other else "diffuse, specular, textures",
        "left_out": [] if other else ["anisotropy", "environment"],
        "notes": ["scene synchronisation is excluded", "another reflection model: error against its own reference"] if other else [],
        "runs": 16,
        "curve": curve(name),
        "pilot_seconds": pilot,
        "slope": {
            "value": slope + (0.19 if bias else 0), "low": slope + (0.12 if bias else -0.03), "high": slope + (0.25 if bias else 0.03),
            "from_spp": 4, "flag": "shallower" if bias or other else "none",
            "cause": "bias" if bias else "heavy tail" if other else "none",
            "text": "The error falls more slowly than 1/N, and the bias test says why." if bias else
                    "The error falls more slowly than 1/N; a few seeds carry most of it." if other else "As expected of an unbiased estimate.",
        },
        "bias": {"tested": False, "blocks": 0, "block": 8, "failed_blocks": 0, "smallest_p": None, "threshold": None, "image_z": None,
                 "verdict": "not testable", "text": "It has no reference that was made independently."} if other else
                {"tested": True, "blocks": 384, "block": 8, "failed_blocks": 9 if bias else 0, "smallest_p": 2e-9 if bias else 0.0031,
                 "threshold": 1.3e-4, "image_z": 5.2 if bias else -0.41, "verdict": "biased" if bias else "none found",
                 "text": "9 of 384 blocks are off, most of them on plate 1." if bias else ""},
        "tail": {"top_share": 0.62 if other else 0.21, "seed_ratio": 6.4 if other else 1.2, "heavy": other},
        "time_to_target": {"target": TARGET, "seconds": None, "ratio": None, "verdict": "not reached"} if other else
                          {"target": TARGET, "seconds": interval(pilot + second * start / TARGET), "ratio": ratio, "verdict": verdict},
        "equal_time": {"seconds": 1.2, "error": interval(start * second / 1.2), "ratio": ratio},
        "equal_samples": {"spp": 64, "error": interval(start / 64), "ratio": interval(start / 0.13, 0 if first else 0.05)},
        "efficiency": {"variance_x_seconds": interval(start * second), "variance_x_rays": None if other else interval(start * 5.5e5), "ratio": ratio},
        "cost": None if other else {
            "ns_per_sample": 61.3 + len(name), "rays_per_path": 2.3, "evaluations": 28_311_552, "samples": {"lobe": 9437184, "cosine": 4718592, "light": 4718592},
            "rays": {"camera": 1572864, "lobe": 9437184, "cosine": 4718592, "shadow": 4718592}},
        "prediction": None if other else {"edges": edges.tolist(), "counts": counts.tolist(), "median": 1.01, "pooled": interval(1.01),
                                          "text": "The estimates are right in the median." if first else ""},
        "allocation": None if other else {"lobe": 0.5, "cosine": 0.2, "light": 0.3, "clamped": 0.0 if first else 0.021, "starved": 0.0},
        "ways": {"samples_at_hit": 3.7, "light_paths": 1, "connections": 0.16, "later_connections": 0.07, "samples": 64,
                 "width": WAY_WIDTH, "height": WAY_HEIGHT, "list": ways()} if name == "auto" else None,
        "counts": None if other else {"nan": 0, "infinite": 0, "negative": 3 if name == "auto" else 0},
        "wins": None if first or other else {"better": 0.31, "worse": 0.02, "undecided": 0.67, "text": MAP_REMARK if name == "variance" else ""},
        "groups": [] if other else [
            {"kind": kind, "name": part, "pixels": 4096 // (1 + k), "relmse": interval(start / 64 * (1 + k)),
             "ratio": None if first else interval(start / 0.13 * 2.0 ** ((k - 1.2) * 0.5), 0.1)}
            for kind, parts in groups for k, part in enumerate(parts)],
    }  # fmt: skip


def ways():
    """Of paths with up to three surfaces, all that a camera and a light can share them by."""
    return [
        {"surfaces": n, "by_camera": k, "samples": 1, "variance": 1 / 9, "cost": 0.0 if k == 0 else 1 / 6}
        for n in range(1, 4)
        for k in range(n + 1)
    ]


def metric(name, label, formula, epsilon=None, subtracted=False):
    return {"name": name, "label": label, "formula": formula, "epsilon": epsilon, "floor_subtracted": subtracted}


def full():
    """(report.json, the images as base64) with everything."""
    listed = images()
    report = {
        "schema": "wardmis-report-1", "title": "veach", "version": "0.1.0", "created": "2026-11-25T14:00:00Z", "complete": True,
        "verdict": {
            "use": "auto", "text": "Use auto: the noise of equal in 57 % of its time. second-moment is a tie with auto. variance is worse than equal and auto.",
            "ratios": {}, "why": ["variance has less error than equal at equal samples, and is slower by the clock: its render of as many samples takes 1.4 times as long."],
        },
        "finding": [
            "auto reaches a relMSE of 0.001 in 0.57 [0.54, 0.61] of the time of equal, second-moment in 0.60 [0.57, 0.64]; variance and equal are a tie.",
            "auto is biased on plate 1: it will not get below a relMSE of about 0.00015.",
            "Cycles does not reach the target within 64 samples per pixel.",
        ],
        "baseline": "equal", "metric": "relmse", "clock": "wall", "effort_clock": "cpu", "wall_scattered": False, "seeds": [*range(1, 17)], "checkpoints": CHECKPOINTS, "width": WIDTH, "height": HEIGHT,
        "metrics": [
            metric("mse", "MSE", "mean (x − r)²", None, True),
            metric("relmse", "relMSE", "mean (x − r)² / (r² + ε)", 0.01, True),
            metric("relmse_trimmed", "relMSE without the largest 0.1 %", "mean (x − r)² / (r² + ε), the largest 0.1 % of pixels left out", 0.01),
            metric("mape", "MAPE", "mean |x − r| / (r + ε)", 0.01),
            metric("smape", "SMAPE", "mean 2 |x − r| / (x + r + ε)", 0.01),
            metric("flip", "FLIP", "mean of HDR-FLIP"),
        ],
        "reference": {"source": "made", "path": "reference.exr", "spp": 4096, "seconds": 96.2, "chunks": 8, "floor": {"mse": 5e-5, "relmse": 1.3e-4}},
        "configurations": [configuration(name) for name in NAMES],
        "techniques": [
            {"name": "lobe", "ns_per_sample": 83.0, "second_moment": 0.91, "variance": 0.42, "variance_x_cost": 34.9},
            {"name": "cosine", "ns_per_sample": 71.0, "second_moment": 4.1, "variance": 3.6, "variance_x_cost": 256.0},
            {"name": "light", "ns_per_sample": 64.0, "second_moment": 1.3, "variance": 0.84, "variance_x_cost": 53.8},
        ],
        "models": [{"name": "Cycles", "against": "WardMIS", "difference": {"relmse": 0.0213, "mse": 0.0047, "mean": {"r": 0.012, "g": -0.0031, "b": 0.0005}},
                    "agree": False, "text": "Cycles shows the material as a Beckmann lobe, which is wider than Ward’s at grazing angles."}],
        "provenance": {
            "version": "0.1.0", "compiler": "GCC 12.2.0", "flags": "-O3 -fno-math-errno -fno-trapping-math -ffp-contract=off", "cpu": "AMD EPYC 9B14",
            "isa": "x86-64-v4", "cores": 2, "threads": 2, "system": "Linux 6.1, glibc 2.36", "scene": "veach.glb", "scene_hash": "3f0c9a7e51d2b846",
            "load": [0.51, 0.49, 0.23], "timing_spread": dict.fromkeys(NAMES, 1.03), "calibration": {"low": 1.02e6, "high": 1.07e6},
            "started": "2026-11-25T13:51:12Z", "ended": "2026-11-25T14:00:00Z",
            "command": "wardmis converge veach.glb -o out/veach -c equal -c variance -c second-moment -c auto --external cycles.json",
        },
        "images": [entry for entry, _ in listed],
    }  # fmt: skip
    return report, [packed for _, packed in listed]


def minimal():
    """The least: two configurations, one metric, no image, nothing that is optional; names that want escaping."""
    whole, _ = full()
    report = {key: whole[key] for key in OBLIGATORY} | {
        "title": "a <b>bold</b> title </script>",
        "width": 48,
        "height": 32,
    }
    report |= {
        "baseline": "equal",
        "complete": False,
        "seeds": [1, 2],
        "verdict": {"use": "equal", "text": "Use equal: x<y>&z is a tie with equal.", "ratios": {}, "why": []},
        "finding": ["equal and x<y>&z are a tie."],
        "images": [],
    }
    report["metrics"] = [m for m in whole["metrics"] if m["name"] in ("mse", "relmse")]
    report["reference"] = {
        "source": "given",
        "path": "r.exr",
        "spp": None,
        "seconds": None,
        "chunks": None,
        "floor": {"mse": None, "relmse": None},
    }
    unknown = dict.fromkeys(("slope", "bias", "cost", "prediction", "allocation", "counts", "wins"))
    report["configurations"] = [
        {"name": shown, "renderer": "WardMIS", "settings": {}, "description": "", "kernel": "", "left_out": [], "notes": [],
         "runs": 2, "curve": curve(name, least=True), "pilot_seconds": 0.0, "groups": [], **unknown}
        for shown, name in (("equal", "equal"), ("x<y>&z", "variance"))
    ]  # fmt: skip
    report["provenance"] = {"version": "0.1.0", "scene": "teapot.glb"}
    return report, []


def page(report, packed):
    """report.html, as native/report puts it together."""
    data = json.dumps(report, ensure_ascii=False, allow_nan=False).replace("<", "\\u003c")
    parts = [f'<script type="application/json" id="report">{data}</script>']
    parts += [f'<script type="text/plain" id="image-{i}">{text}</script>' for i, text in enumerate(packed)]
    values = {
        "title": html.escape(report["title"], quote=False),
        "style": (WEB / "report.css").read_text(),
        "plotly": (WEB / "plotly-basic.min.js").read_text(),
        "script": (WEB / "report.js").read_text(),
        "data": "\n".join(parts),
    }
    return re.sub(r"\{\{(\w+)\}\}", lambda match: values[match[1]], (WEB / "report.html").read_text())


def odd():
    """Reports at the edges, by name: (report.json, images)."""
    alone, packed = full()
    alone["configurations"] = alone["configurations"][:1]
    once, _ = full()
    once["images"] = []
    for c in once["configurations"]:
        c["curve"] = c["curve"][:1]
    crowd, _ = full()
    crowd["images"] = []
    for k in range(6):
        crowd["configurations"].append(
            configuration("auto") | {"name": f"{'a-very-long-name-' * 3}{k}", "settings": {"nested": {"a": [1, None]}}}
        )
    # five of ours, and a heavy tail: what leaves pixels out stands beside what does not
    heavy, _ = full()
    heavy["images"], heavy["metric"] = [], "relmse_trimmed"
    heavy["configurations"].insert(2, configuration("auto") | {"name": "α=0.1 (twin) 50% <a/b>"})
    for c in heavy["configurations"]:
        c["all_pixels"] = {key: c[key] for key in ("time_to_target", "equal_time", "equal_samples", "efficiency")}
    under, _ = full()
    under["images"] = []
    for c in under["configurations"]:
        for p in c["curve"][-3:]:  # less their floor, errors may be nothing or less
            p["relmse"] = {
                "mean": -1e-6 if p["spp"] == 64 else 0.0 if p["spp"] == 32 else 1e-5,
                "low": -2e-5,
                "high": 2e-5,
            }
    unknown, _ = full()
    unknown["images"] = []
    unknown |= {"techniques": [], "models": [], "provenance": {}}
    for c in unknown["configurations"][1:]:
        c |= dict.fromkeys(
            (
                "slope",
                "bias",
                "time_to_target",
                "equal_time",
                "efficiency",
                "cost",
                "prediction",
                "allocation",
                "counts",
                "wins",
                "groups",
            )
        )
    unknown["configurations"][0]["time_to_target"] |= {"seconds": None, "ratio": None, "verdict": "not reached"}
    nothing = {
        name: (report, [])
        for name, report in (("once", once), ("crowd", crowd), ("heavy", heavy), ("under", under), ("unknown", unknown))
    }
    return {"alone": (alone, packed)} | nothing


def write(folder):
    for name, (report, packed) in ({"full": full(), "minimal": minimal()} | odd()).items():
        (folder / f"{name}.html").write_text(page(report, packed))


if __name__ == "__main__":
    write(Path(sys.argv[1]))
