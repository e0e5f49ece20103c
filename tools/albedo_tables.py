# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes native/bsdf/albedo_tables.cpp: albedos of rough GGX surfaces by quadrature over their visible normals.

Run with Python and numpy from the root: python3 tools/albedo_tables.py [--check FILE], about three minutes.
--check compares with tables in the layout of Cycles' src/scene/shader.tables and prints the largest differences.
The grids are those that Cycles reads its own tables on, so that interpolation between them agrees, too: roughness
(alpha is its square) and the cosine of the view evenly over [0, 1], the index of refraction by z = F0^(1/4).
"""

import argparse
import re
from pathlib import Path

import numpy as np

OUT = Path(__file__).parent.parent / "native/bsdf/albedo_tables.cpp"


class Normals:
    """Visible normals of GGX (Dupuy and Benyoub 2023) at nodes of a rule over the unit square, for a column of cosines."""

    def __init__(self, alpha: float, mu: np.ndarray, nodes: int, steps: int) -> None:
        x, w = np.polynomial.legendre.leggauss(nodes)
        v = ((x + 1) / 2)[None, :, None]  # 1 - u = v^3: the tail of GGX, of which the horizon cuts a part, is at u = 1
        past = v**3  # 1 - u
        phi = (np.pi * (np.arange(steps) + 0.5) / steps)[None, None, :]  # the other half mirrors it
        self.weight = np.broadcast_to(3 * v**2 * (w / 2)[None, :, None] / steps, (1, nodes, steps))
        self.mu = mu[:, None, None]
        self.alpha = alpha
        self.wo = (np.sqrt(1 - self.mu**2), self.mu)  # x, z
        stretch = np.sqrt(self.mu**2 + (alpha * self.wo[0]) ** 2)
        cos_o = self.mu / stretch
        z = past * (1 + cos_o)
        r = np.sqrt(np.maximum(0, (1 - past) * (1 + cos_o) * (1 - cos_o + z)))
        m = np.stack(
            np.broadcast_arrays(alpha * (r * np.cos(phi) + alpha * self.wo[0] / stretch), alpha * r * np.sin(phi), z)
        )
        self.m = m / np.sqrt((m**2).sum(axis=0))
        self.cos = np.clip(self.m[0] * self.wo[0] + self.m[2] * self.wo[1], 0, 1)  # wo.m

    def smith(self, x2y2: np.ndarray, z: np.ndarray) -> np.ndarray:
        """G2/G1 towards a direction with these x^2 + y^2 and |z|; 0 at z = 0."""
        z = np.maximum(z, 1e-300)
        lo = np.sqrt(self.mu**2 + (self.alpha * self.wo[0]) ** 2)
        li = np.sqrt(z**2 + self.alpha**2 * x2y2)
        return z * (self.mu + lo) / (li * self.mu + lo * z)

    def reflected(self) -> np.ndarray:
        """G2/G1 of the mirrored direction, 0 below the surface."""
        z = 2 * self.cos * self.m[2] - self.wo[1]
        return np.where(z > 0, self.smith(np.maximum(0, 1 - z**2), z), 0)

    def refracted(self, eta: float) -> np.ndarray:
        """G2/G1 of the refracted direction. Where that leaves above the surface, as it may for eta < 1, it counts, too:
        so do the tables that Cycles divides by."""
        k = eta * eta - 1
        g2 = k + self.cos**2
        g = np.sqrt(np.maximum(g2, 0))
        z = -self.wo[1] / eta - k / (eta * (self.cos + g)) * self.m[2]
        return np.where(g2 > 0, self.smith(np.maximum(0, 1 - z**2), np.abs(z)), 0)

    def mean(self, value: np.ndarray) -> np.ndarray:
        return (value * self.weight).sum(axis=(1, 2))


def fresnel(c: np.ndarray, eta: float) -> np.ndarray:
    g2 = eta * eta - 1 + c * c
    g = np.sqrt(np.maximum(g2, 0))
    rs = (c - g) / (c + g)
    rp = (eta * eta * c - g) / (eta * eta * c + g)
    return np.where(g2 > 0, (rs**2 + rp**2) / 2, 1)


def axis(n: int, high: float = 1) -> np.ndarray:
    return np.clip(np.arange(n) / (n - 1), 1e-4, high)


def indices(n: int) -> list[float]:
    roots = axis(n, 0.99) ** 2  # sqrt(F0)
    roots[0] = 0
    return [float((1 + r) / (1 - r)) for r in roots]


GAUSS, GAUSS_WEIGHTS = (np.polynomial.legendre.leggauss(48)[0] + 1) / 2, np.polynomial.legendre.leggauss(48)[1] / 2


def hemisphere(albedo: np.ndarray) -> float:
    """2 mu albedo(mu), integrated; albedo at the nodes GAUSS."""
    return float((2 * GAUSS * albedo * GAUSS_WEIGHTS).sum())


def reflection(fine: int) -> dict[str, np.ndarray]:
    e, mean = np.ones((32, 32)), np.ones(32)
    for x, rough in enumerate(axis(32)[1:], 1):
        for mu, put in ((axis(32), "e"), (GAUSS, "mean")):
            n = Normals(float(rough) ** 2, mu, 64 * fine, 64 * fine)
            albedo = n.mean(n.reflected())
            if put == "e":
                e[:, x] = albedo
            else:
                mean[x] = hemisphere(albedo)
    return {"ggx_E": e, "ggx_Eavg": mean}


def glass(fine: int, inverse: bool) -> dict[str, np.ndarray]:
    e, mean = np.ones((16, 16, 16)), np.ones((16, 16))  # smooth, or without a change of index: everything passes
    for x, rough in enumerate(axis(16)[1:], 1):
        for mu, put in ((axis(16), "e"), (GAUSS, "mean")):
            n = Normals(float(rough) ** 2, mu, 64 * fine, 64 * fine)
            reflected = n.reflected()
            for z, ior in list(enumerate(indices(16)))[1:]:
                eta = 1 / ior if inverse else ior
                f = fresnel(n.cos, eta)
                albedo = n.mean(f * reflected + (1 - f) * n.refracted(eta))
                if put == "e":
                    e[z, :, x] = albedo
                else:
                    mean[z, x] = hemisphere(albedo)
    name = "ggx_glass_inv_" if inverse else "ggx_glass_"
    return {f"{name}E": e, f"{name}Eavg": mean}


def blend(fine: int) -> dict[str, np.ndarray]:
    """Mean of (F - F0)/(1 - F0) over the visible normals that reflect above the surface."""
    s = np.zeros((16, 16, 16))
    for x, rough in enumerate(axis(16)):
        alpha = float(rough) ** 2 if x else 1e-8
        n = Normals(alpha, axis(16), 128 * fine, 128 * fine)
        above = 2 * n.cos * n.m[2] > n.wo[1]
        for z, ior in enumerate(indices(16)):
            f0 = ((ior - 1) / (ior + 1)) ** 2
            s[z, :, x] = n.mean(np.where(above, np.clip((fresnel(n.cos, ior) - f0) / (1 - f0), 0, 1), 0))
    return {"ggx_gen_schlick_ior_s": s}


def schlick(fine: int) -> dict[str, np.ndarray]:
    """The same of (1 - cos)^exponent. Cycles' grid has 16 steps of 1/(1 + exponent/5); exponent 5 is half way between two."""
    s = np.zeros((16, 16))
    for x, rough in enumerate(axis(16)):
        n = Normals(float(rough) ** 2 if x else 1e-8, axis(16), 128 * fine, 128 * fine)
        above = 2 * n.cos * n.m[2] > n.wo[1]
        for z in (7 / 15, 8 / 15):
            s[:, x] += n.mean(np.where(above, (1 - n.cos) ** (5 / z - 5), 0)) / 2
    return {"ggx_gen_schlick_s": s}


NAMES = {
    "ggx_E": "kReflection", "ggx_Eavg": "kReflectionMean", "ggx_glass_E": "kGlass", "ggx_glass_Eavg": "kGlassMean",
    "ggx_glass_inv_E": "kGlassInside", "ggx_glass_inv_Eavg": "kGlassInsideMean", "ggx_gen_schlick_ior_s": "kBlend",
    "ggx_gen_schlick_s": "kSchlick",
}  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", type=Path, help="a file of tables in the layout of Cycles' shader.tables")
    parser.add_argument("--fine", type=int, default=2, help="nodes of the quadrature, times 64 (default 2)")
    arguments = parser.parse_args()
    tables = {
        **reflection(arguments.fine),
        **glass(arguments.fine, False),
        **glass(arguments.fine, True),
        **blend(arguments.fine),
        **schlick(arguments.fine),
    }
    if arguments.check:
        text = arguments.check.read_text()
        for name, ours in tables.items():
            match = re.search(rf"table_{name}\[\d+\] = \{{(.*?)\}};", text, re.DOTALL)
            theirs = np.array([float(v) for v in re.findall(r"[\d.]+(?=f)", match[1] if match else "")]).reshape(
                ours.shape
            )
            d = np.abs(ours - theirs)
            where = tuple(int(i) for i in np.unravel_index(d.argmax(), d.shape))
            print(
                f"{name}: largest difference {d.max():.2e} at {where} ({ours[where]:.6f}, {theirs[where]:.6f}), mean {d.mean():.1e}"
            )
    lines = [
        "// SPDX-License-Identifier: GPL-3.0-or-later",
        "// Made by tools/albedo_tables.py, which says what they are: numbers in [0, 1] times 65535.",
        '#include "bsdf/albedo_tables.h"',
        "",
        "namespace wardmis::albedo {",
        "",
        "// clang-format off",
    ]
    for name, values in tables.items():
        numbers = [str(round(v * 65535)) for v in np.clip(values, 0, 1).ravel()]
        lines.append(f"const uint16_t {NAMES[name]}[{len(numbers)}] = {{")
        lines += ["  " + ",".join(numbers[i : i + 20]) + "," for i in range(0, len(numbers), 20)]
        lines.append("};")
    lines += ["// clang-format on", "", "}  // namespace wardmis::albedo", ""]
    OUT.write_text("\n".join(lines))


if __name__ == "__main__":
    main()
