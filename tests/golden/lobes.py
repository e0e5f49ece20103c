# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes lobes.json: f cos(theta_i) and densities of the lobes by their textbook formulas, in 50 digits.

Needs mpmath; about a minute. Angles, normalised half vectors and Snell's law here, none of which the renderer uses.
"""

import json
import random
import struct
from pathlib import Path

from mpmath import acos, asin, erf, exp, log, mp, mpf, pi, power, sin, sqrt, tan

mp.dps = 50
Vec = tuple[mpf, mpf, mpf]


def single(x: float) -> float:
    """The nearest number of single precision: lobes hold those."""
    return struct.unpack("f", struct.pack("f", x))[0]


def dot(a: Vec, b: Vec) -> mpf:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def unit(a: Vec) -> Vec:
    length = sqrt(dot(a, a))
    return (a[0] / length, a[1] / length, a[2] / length)


def fresnel(cos: mpf, eta: mpf) -> mpf:
    inner = asin(sin(acos(cos)) / eta) if sin(acos(cos)) / eta < 1 else None
    if inner is None:
        return mpf(1)
    t = sqrt(1 - sin(inner) ** 2)
    rs, rp = (cos - eta * t) / (cos + eta * t), (eta * cos - t) / (eta * cos + t)
    return (rs**2 + rp**2) / 2


def blend(cos: mpf, eta: mpf) -> mpf:
    f0 = ((eta - 1) / (eta + 1)) ** 2
    return (fresnel(cos, eta) - f0) / (1 - f0)


def facet(lobe: dict, cos: mpf) -> list[mpf]:
    """Reflectance of a facet in the three channels."""
    kind, eta = lobe.get("fresnel", "none"), mpf(lobe.get("eta", 1))
    f0, edge = [mpf(v) for v in lobe.get("f0", [1, 1, 1])], [mpf(v) for v in lobe.get("edge", [0, 0, 0])]
    if kind == "dielectric":
        return [fresnel(cos, eta)] * 3
    if kind == "blended":
        return [f + (1 - f) * max(mpf(0), blend(cos, eta)) for f in f0]
    if kind == "tinted":
        return [fresnel(cos, eta) * (f + (1 - f) * max(mpf(0), blend(cos, eta))) for f in f0]
    if kind == "f82":
        return [
            max(mpf(0), f + (1 - f) * (1 - cos) ** 5 - e * cos * (1 - cos) ** 6) for f, e in zip(f0, edge, strict=True)
        ]
    return [mpf(1)] * 3


def passing(lobe: dict, cos: mpf) -> list[mpf]:
    kind, eta = lobe.get("fresnel", "none"), mpf(lobe.get("eta", 1))
    if fresnel(cos, eta) == 1:
        return [mpf(0)] * 3
    if kind == "none":
        return [mpf(1)] * 3
    return [1 - fresnel(cos, eta)] * 3 if kind in ("tinted", "dielectric") else [1 - f for f in facet(lobe, cos)]


def slope(m: Vec, ax: mpf, ay: mpf) -> mpf:
    """tan^2(theta)/alpha(phi)^2"""
    return ((m[0] / ax) ** 2 + (m[1] / ay) ** 2) / m[2] ** 2


def normals(kind: str, m: Vec, ax: mpf, ay: mpf) -> mpf:
    e = slope(m, ax, ay)
    if kind == "beckmann":
        return exp(-e) / (pi * ax * ay * m[2] ** 4)
    return 1 / (pi * ax * ay * m[2] ** 4 * (1 + e) ** 2)


def wide(w: Vec, ax: mpf, ay: mpf) -> mpf:
    """alpha(phi) tan(theta)"""
    return sqrt((ax * w[0]) ** 2 + (ay * w[1]) ** 2) / abs(w[2])


def smith(kind: str, w: Vec, ax: mpf, ay: mpf, exact: bool = False) -> mpf:
    """Lambda"""
    t = wide(w, ax, ay)
    if kind == "ggx":
        return (sqrt(1 + t**2) - 1) / 2
    a = 1 / t
    if exact:
        return (erf(a) - 1) / 2 + exp(-(a**2)) / (2 * a * sqrt(pi))
    return (
        (1 - mpf("1.259") * a + mpf("0.396") * a**2) / (mpf("3.535") * a + mpf("2.181") * a**2) if a < 1.6 else mpf(0)
    )


def shadowing(lobe: dict, kind: str, wi: Vec, wo: Vec, ax: mpf, ay: mpf) -> mpf:
    li, lo = smith(kind, wi, ax, ay), smith(kind, wo, ax, ay)
    return 1 / ((1 + li) * (1 + lo)) if lobe.get("masking") == "separable" else 1 / (1 + li + lo)


def microfacet(lobe: dict, wi: Vec, wo: Vec) -> tuple[list[mpf], mpf]:
    kind, ax, ay = lobe["kind"], mpf(lobe["ax"]), mpf(lobe["ay"])
    h = unit((wi[0] + wo[0], wi[1] + wo[1], wi[2] + wo[2]))
    d = normals(kind, h, ax, ay)
    value = d * shadowing(lobe, kind, wi, wo, ax, ay) / (4 * wi[2] * wo[2]) * wi[2]
    g1 = 1 / (1 + smith(kind, wo, ax, ay, exact=True))
    visible = g1 * dot(wo, h) * d / wo[2]
    return [value * f for f in facet(lobe, dot(wo, h))], visible / (4 * dot(wo, h))


def refraction(lobe: dict, wi: Vec, wo: Vec) -> tuple[list[mpf], mpf]:
    kind, ax, ay, eta = lobe["kind"].removesuffix("_refraction"), mpf(lobe["ax"]), mpf(lobe["ay"]), mpf(lobe["eta"])
    h = unit((-eta * wi[0] - wo[0], -eta * wi[1] - wo[1], -eta * wi[2] - wo[2]))
    if dot(h, wo) < 0:
        h = (-h[0], -h[1], -h[2])
    if h[2] <= 0 or dot(h, wi) >= 0:
        return [mpf(0)] * 3, mpf(0)
    d, jacobian = normals(kind, h, ax, ay), eta**2 * abs(dot(wi, h)) / (eta * dot(wi, h) + dot(wo, h)) ** 2
    value = abs(dot(wo, h) / (wi[2] * wo[2])) * jacobian * shadowing(lobe, kind, wi, wo, ax, ay) * d * abs(wi[2])
    visible = dot(wo, h) * d / wo[2] / (1 + smith(kind, wo, ax, ay, exact=True))
    return [value * t for t in passing(lobe, dot(wo, h))], visible * jacobian


def oren_nayar(lobe: dict, wi: Vec, wo: Vec) -> mpf:
    a, b = mpf(lobe["a"]), mpf(lobe["b"])
    t = dot(wi, wo) - wi[2] * wo[2]
    return a + b * (t / max(wi[2], wo[2]) if t > 0 else t)


def diffuse_albedo(a: mpf, b: mpf, cos: mpf) -> mpf:
    theta = acos(cos)
    s = sin(theta)
    return a * pi + b * (s * (theta - mpf(2) / 3 - s * cos) + mpf(2) / 3 * tan(theta) * (1 - s**3))


def schlick(cos: mpf) -> mpf:
    return (1 - cos) ** 5


def evaluate(lobe: dict, wi: Vec, wo: Vec) -> tuple[list[mpf], mpf]:
    kind = lobe["kind"]
    if kind in ("ggx", "beckmann"):
        return microfacet(lobe, wi, wo)
    if kind.endswith("_refraction"):
        return refraction(lobe, wi, wo)
    h = unit((wi[0] + wo[0], wi[1] + wo[1], wi[2] + wo[2]))
    cosine = wi[2] / pi
    if kind == "lambert":
        return [cosine] * 3, cosine
    if kind == "oren_nayar":
        rest = 1 - diffuse_albedo(mpf(lobe["a"]), mpf(lobe["b"]), wi[2])
        return [(oren_nayar(lobe, wi, wo) + mpf(m) * rest) * wi[2] for m in lobe["f0"]], cosine
    if kind == "burley":
        r, fi, fo, rough = 2 * mpf(lobe["a"]) * dot(wi, h) ** 2, schlick(wi[2]), schlick(wo[2]), mpf(lobe["a"])
        assert r == 2 * rough * dot(wi, h) ** 2
        f = (1 - fi / 2) * (1 - fo / 2) + r * (fi + fo + fi * fo * (r - 1))
        return [f * cosine] * 3, cosine
    if kind == "velvet":
        theta, sigma = acos(h[2]), mpf(lobe["a"])
        d = exp(-1 / (tan(theta) ** 2 * sigma**2)) / (pi * sigma**2 * sin(theta) ** 4)
        g = min(mpf(1), 2 * h[2] * wo[2] / dot(wo, h), 2 * h[2] * wi[2] / dot(wo, h))
        return [d * g / (4 * wo[2])] * 3, cosine
    if kind == "schlick_sheen":
        return [schlick(dot(wi, h)) * wi[2]] * 3, cosine
    if kind == "fibres":
        a, b = mpf(lobe["a"]), mpf(lobe["b"])
        r = sqrt(wo[0] ** 2 + wo[1] ** 2)
        t, n = ((wo[0] / r, wo[1] / r, mpf(0)), (-wo[1] / r, wo[0] / r, mpf(0)))
        w = unit((a * dot(wi, t) + b * wi[2], a * dot(wi, n), wi[2]))  # back to the cosine lobe
        size = sqrt((a * dot(wi, t) + b * wi[2]) ** 2 + (a * dot(wi, n)) ** 2 + wi[2] ** 2)
        p = w[2] / pi * a**2 / size**3
        return [p] * 3, p
    if kind == "ashikhmin_shirley":
        nx, ny = 2 / mpf(lobe["ax"]) ** 2 - 2, 2 / mpf(lobe["ay"]) ** 2 - 2
        lobe_value = (
            power(h[2], (nx * h[0] ** 2 + ny * h[1] ** 2) / (1 - h[2] ** 2)) * sqrt((nx + 1) * (ny + 1)) / (8 * pi)
        )
        return [lobe_value / (dot(wi, h) * max(wi[2], wo[2])) * wi[2]] * 3, lobe_value / dot(wi, h)
    assert kind == "clearcoat"
    a2, quarter = mpf(lobe["ax"]) ** 2, mpf(1) / 4
    d = (a2 - 1) / (pi * log(a2) * (1 + (a2 - 1) * h[2] ** 2))
    g = 1 / ((1 + smith("ggx", wi, quarter, quarter)) * (1 + smith("ggx", wo, quarter, quarter)))
    drawn = {"kind": "ggx", "ax": lobe["ax"], "ay": lobe["ax"]}  # its samples are those of GGX
    return [d * g / (4 * wo[2]) * f for f in facet(lobe, dot(wo, h))], microfacet(drawn, wi, wo)[1]


def direction(cos: float, phi: float) -> list[float]:
    sine = sqrt(1 - mpf(cos) ** 2)
    return [float(sine * mp.cos(phi)), float(sine * mp.sin(phi)), float(cos)]


def lobes(rng: random.Random) -> list[dict]:
    def alpha() -> float:
        return single(10 ** rng.uniform(-2, 0))

    def color(low: float = 0) -> list[float]:
        return [single(rng.uniform(low, 1)) for _ in range(3)]

    out: list[dict] = [{"kind": "lambert"}, {"kind": "schlick_sheen"}]
    for _ in range(3):
        sigma = rng.random()
        a = single(1 / (3.14159265 + sigma * (1.57079633 - 2 / 3)))
        out.append({"kind": "oren_nayar", "a": a, "b": single(sigma * a), "f0": [0, 0, 0]})
        out.append({"kind": "oren_nayar", "a": a, "b": single(sigma * a), "f0": [single(0.05 * c) for c in color()]})
        out.append({"kind": "burley", "a": single(rng.random())})
        out.append({"kind": "velvet", "a": single(rng.uniform(0.1, 1))})
        out.append({"kind": "fibres", "a": single(rng.uniform(0.05, 0.9)), "b": single(rng.uniform(-0.2, 0.02))})
        out.append({"kind": "ashikhmin_shirley", "ax": alpha(), "ay": alpha()})
        out.append({"kind": "clearcoat", "ax": alpha(), "ay": 1, "fresnel": "blended", "eta": 1.5, "f0": color()})
    for kind in ("ggx", "beckmann"):
        for masking in ("separable", "correlated"):
            for look in ("none", "dielectric", "blended", "tinted", "f82"):
                out.append({"kind": kind, "masking": masking, "ax": alpha(), "ay": alpha(), "fresnel": look, "f0": color(),
                            "eta": single(rng.choice([0.7, 1.01, 1.45, 2.5])), "edge": color()})  # fmt: skip
            for look in ("none", "dielectric", "blended", "tinted"):
                for eta in (0.7, 0.9, 1.0009765625, 1.5, 3.0):
                    out.append({"kind": f"{kind}_refraction", "masking": masking, "ax": alpha(), "ay": alpha(),
                                "fresnel": look, "f0": color(), "eta": single(eta)})  # fmt: skip
    return out


def main() -> None:
    rng = random.Random(17)
    points = []
    for lobe in lobes(rng):
        for _ in range(4):
            wo = direction(rng.choice([rng.random(), 10 ** rng.uniform(-3, 0)]), rng.uniform(0, 6.2831))
            wi = direction(rng.random(), rng.uniform(0, 6.2831))
            if lobe["kind"].endswith("_refraction"):  # near what a facet tilted by some alpha refracts to
                eta, tilt = lobe["eta"], rng.uniform(0, 1.5) * max(lobe["ax"], lobe["ay"])
                n = unit((mpf(tilt * rng.uniform(-1, 1)), mpf(tilt * rng.uniform(-1, 1)), mpf(1)))
                c = dot(tuple(mpf(v) for v in wo), n)
                if c <= 0 or 1 - (1 - c**2) / mpf(eta) ** 2 <= 0:
                    continue
                t = sqrt(1 - (1 - c**2) / mpf(eta) ** 2)
                wi = [float(-mpf(o) / eta + (c / eta - t) * m) for o, m in zip(wo, n, strict=True)]
                if wi[2] >= 0:
                    continue
            elif lobe["kind"] in ("ggx", "beckmann", "ashikhmin_shirley", "clearcoat") and rng.random() < 0.7:
                tilt = 2 * max(lobe["ax"], lobe["ay"] if lobe["kind"] != "clearcoat" else 0)
                n = unit((mpf(tilt * rng.uniform(-1, 1)), mpf(tilt * rng.uniform(-1, 1)), mpf(1)))
                c = dot(tuple(mpf(v) for v in wo), n)
                r = [float(2 * c * m - mpf(o)) for o, m in zip(wo, n, strict=True)]
                wi = r if r[2] > 1e-3 else wi
            f, p = evaluate(lobe, tuple(mpf(v) for v in wi), tuple(mpf(v) for v in wo))
            if max(abs(v) for v in f) < 1e-250:
                continue
            points.append({"lobe": lobe, "wi": wi, "wo": wo, "f_cos": [float(v) for v in f], "pdf": float(p)})
    lines = ",\n".join(json.dumps(point) for point in points)
    Path(__file__).with_suffix(".json").write_text(f"[\n{lines}\n]\n")
    print(len(points), "points")


if __name__ == "__main__":
    main()
