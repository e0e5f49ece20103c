# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes native/bsdf/fibre_table.cpp from the measured lobes of Zeltner, Burley and Chiang 2022.

usage: python3 tools/fibre_table.py FILE
FILE holds the authors' table ("table_sheen_ltc", Apache-2.0) in the layout of Cycles' src/scene/shader.tables: the two
numbers of the transformation and the albedo over roughness and cosine. It is data of a simulation, fitted by the authors:
no formula gives it.
"""

import re
import sys
from pathlib import Path

OUT = Path(__file__).parent.parent / "native/bsdf/fibre_table.cpp"
N = 32
NAMES = [("kScale", 65535), ("kSkew", 32767), ("kAlbedo", 65535)]


def main() -> None:
    match = re.search(r"table_sheen_ltc\[\d+\] = \{(.*?)\};", Path(sys.argv[1]).read_text(), re.DOTALL)
    values = [float(v) for v in re.findall(r"-?[\d.]+(?=f)", match[1] if match else "")]
    if len(values) != 3 * N * N:
        sys.exit(f"{sys.argv[1]}: {len(values)} numbers in table_sheen_ltc, expected {3 * N * N}")
    lines = [
        "// SPDX-License-Identifier: GPL-3.0-or-later",
        "// Made by tools/fibre_table.py: data of Zeltner, Burley and Chiang 2022, published under Apache-2.0.",
        '#include "bsdf/fibre_table.h"',
        "",
        "namespace wardmis::fibre {",
        "",
        "// clang-format off",
    ]
    for k, (name, unit) in enumerate(NAMES):
        numbers = [str(round(v * unit)) for v in values[k * N * N : (k + 1) * N * N]]
        lines.append(f"const {'u' if unit == 65535 else ''}int16_t {name}[{N * N}] = {{")
        lines += ["  " + ",".join(numbers[i : i + 20]) + "," for i in range(0, N * N, 20)]
        lines.append("};")
    lines += ["// clang-format on", "", "}  // namespace wardmis::fibre", ""]
    OUT.write_text("\n".join(lines))


if __name__ == "__main__":
    main()
