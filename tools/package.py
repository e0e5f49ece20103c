# SPDX-License-Identifier: GPL-3.0-or-later
"""Packs the add-on with the renderer inside: one zip that Blender installs as a legacy add-on and, from 4.2, as an
extension. The shared libraries that not every machine has lie beside the command, so that Blender alone is enough. The
module for OpenImageIO stays out: the exporter hands on no image that needs it. README.md and docs/ go in as pages.

package.py --binary BINARY --out FOLDER"""

import argparse
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import pages

ROOT = Path(__file__).resolve().parent.parent
ADDON = ROOT / "addon" / "wardmis"
# glibc belongs to the machine; the kernel's own is in no file.
GLIBC = re.compile(r"^(ld-linux.*|lib(c|m|dl|rt|pthread|resolv|util))\.so\.\d+$")


def fail(message: str) -> None:
    sys.exit(f"package.py: {message}")


def version() -> str:
    """The three places that say it must agree: the renderer, and the add-on's two kinds of description."""
    found = {
        "CMakeLists.txt": re.search(r"project\(\w+ VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text()),
        "blender_manifest.toml": re.search(
            r'^version = "([\d.]+)"', (ADDON / "blender_manifest.toml").read_text(), re.M
        ),
        "__init__.py": re.search(r'"version": \(([\d, ]+)\)', (ADDON / "__init__.py").read_text()),
    }
    versions = {place: match[1].replace(", ", ".") if match else "none" for place, match in found.items()}
    if len(set(versions.values())) != 1:
        fail(f"the versions differ: {versions}")
    return versions["CMakeLists.txt"]


def libraries(binary: Path) -> list[Path]:
    """What the dynamic linker finds for the command, but for glibc."""
    found = []
    for line in subprocess.run(["ldd", str(binary)], check=True, capture_output=True, text=True).stdout.splitlines():
        name, arrow, place = line.strip().partition(" => ")
        if not arrow or GLIBC.match(name):
            continue
        if "not found" in place:
            fail(f"{name} is not found, which {binary} needs")
        found.append(Path(place.split(" (")[0]))
    return found


def licence(library: Path) -> Path | None:
    """Debian and Ubuntu keep each package's licence in one place."""
    for path in {library, library.resolve(), Path(str(library.resolve()).removeprefix("/usr"))}:
        owner = subprocess.run(["dpkg-query", "-S", str(path)], capture_output=True, text=True)
        if owner.returncode == 0:
            file = Path("/usr/share/doc") / owner.stdout.split(":")[0] / "copyright"
            return file if file.exists() else None
    return None


def add_renderer(folder: Path, binary: Path) -> None:
    (folder / "lib").mkdir(parents=True)
    shutil.copy(binary, folder / "wardmis")
    own = [folder / "wardmis"]
    for library in libraries(binary):
        shutil.copy(library, folder / "lib" / library.name)
        own.append(folder / "lib" / library.name)
        terms = licence(library) if shutil.which("dpkg-query") else None
        if terms:
            (folder / "licences").mkdir(exist_ok=True)
            shutil.copy(terms, folder / "licences" / f"{terms.parent.name}.txt")
    for file in own:
        origin = "$ORIGIN/lib" if file.parent == folder else "$ORIGIN"
        subprocess.run(["strip", "--strip-unneeded", str(file)], check=True)
        subprocess.run(["patchelf", "--set-rpath", origin, str(file)], check=True)


def add_on_files() -> list[Path]:
    return [path for path in sorted(ADDON.rglob("*")) if path.is_file() and "__pycache__" not in path.parts]


def documents() -> list[Path]:
    return [ROOT / "README.md", *(path for path in sorted((ROOT / "docs").rglob("*")) if path.is_file())]


def write_zip(folder: Path, target: Path) -> None:
    """The same input gives the same bytes: sorted names, no time stamps."""
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED, compresslevel=6) as out:
        for path in sorted(folder.rglob("*")):
            if path.is_file():
                entry = zipfile.ZipInfo(str(path.relative_to(folder.parent)))
                entry.compress_type = zipfile.ZIP_DEFLATED
                entry.external_attr = path.stat().st_mode << 16
                out.writestr(entry, path.read_bytes())


def package(binary: Path, out: Path) -> Path:
    target = out / f"wardmis-{version()}.zip"
    inputs = [binary, ROOT / "LICENSE", Path(__file__), Path(pages.__file__), *add_on_files(), *documents()]
    if target.exists() and target.stat().st_mtime >= max(path.stat().st_mtime for path in inputs):
        return target
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=out) as temporary:
        folder = Path(temporary) / "wardmis"
        for path in add_on_files():
            to = folder / path.relative_to(ADDON)
            to.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, to)
        shutil.copy(ROOT / "LICENSE", folder / "LICENSE")
        pages.write(ROOT, folder / "documentation")
        add_renderer(folder / "bin", binary)
        unfinished = Path(temporary) / target.name
        write_zip(folder, unfinished)
        unfinished.replace(target)
    return target


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--binary", type=Path, required=True)
    parser.add_argument("--out", type=Path, required=True)
    arguments = parser.parse_args()
    if not arguments.binary.exists():
        fail(f"{arguments.binary} does not exist; ./dev build makes it")
    target = package(arguments.binary, arguments.out)
    print(f"{target}  {target.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
