"""`python -m tests.releases.build [FOLDER]`: builds sdist and wheel of the last commit, the same bytes on any machine.

What is not committed takes no part. The sdist is built from the commit, the wheel from the sdist, without the network;
both have the time of the commit. FOLDER is `dist` unless given. Equal bytes need the version of hatchling that is
printed, and a Python that compresses with the same zlib.
"""

import hashlib
import os
import re
import subprocess
import sys
import tarfile
import tempfile
import zipfile
import zlib
from importlib.metadata import version
from pathlib import Path

from packaging.metadata import Metadata

from tests.paths import ROOT

PACKAGES = {"clean_swarm_env", "configs", "selector", "selforg", "train"}
BESIDE = {"CHANGELOG.md", "CITATION.cff", "LICENSE", "README.md", "constraints.txt", "pyproject.toml"}
"""What the sdist has beside the packages."""
WRITTEN = {"PKG-INFO", ".gitignore"}
"""What hatchling adds to an sdist; the latter where there is one."""
MOST_BYTES = 2_000_000
VERSION = re.compile(r'^__version__ = "(.+)"$', re.MULTILINE)


def build(source: Path, output: Path, moment: int) -> tuple[Path, Path]:
    """Build the sdist of a folder, and the wheel from the sdist; return both.

    Args:
        source: the project.
        output: where both files are put.
        moment: time of all files in them [s since 1970].

    """
    _hatch(source, output, "sdist", moment)
    (sdist,) = output.glob("*.tar.gz")
    with tempfile.TemporaryDirectory() as folder:
        with tarfile.open(sdist) as archive:
            archive.extractall(folder, filter="data")
        (unpacked,) = Path(folder).iterdir()
        _hatch(unpacked, output, "wheel", moment)
    (wheel,) = output.glob("*.whl")
    return sdist, wheel


def faults(source: Path, sdist: Path, wheel: Path) -> list[str]:
    """Return what is wrong with what was built: names, content, size, metadata."""
    release = VERSION.findall((source / "clean_swarm_env" / "__init__.py").read_text(encoding="utf-8"))[0]
    stem = f"clean_swarm-{release}"
    with tarfile.open(sdist) as archive:
        packed = {name.removeprefix(f"{stem}/") for name in archive.getnames()}
    names = set(zipfile.ZipFile(wheel).namelist())
    files = {path.relative_to(source).as_posix() for name in PACKAGES for path in (source / name).rglob("*.*")}
    files = {name for name in files if (source / name).is_file() and "__pycache__" not in name}
    info = {f"{stem}.dist-info/{name}" for name in ("METADATA", "WHEEL", "RECORD", "entry_points.txt")}
    info.add(f"{stem}.dist-info/licenses/LICENSE")
    expected = {
        "name of the sdist": (sdist.name, f"{stem}.tar.gz"),
        "name of the wheel": (wheel.name, f"{stem}-py3-none-any.whl"),
        "files of the sdist": (packed - WRITTEN, files | BESIDE),
        "files of the wheel": (names, files | info),
    }
    found = [f"{what}: expected {_short(b, a)}, got {_short(a, b)}" for what, (a, b) in expected.items() if a != b]
    found += [
        f"{path.name}: more than {MOST_BYTES} bytes" for path in (sdist, wheel) if path.stat().st_size > MOST_BYTES
    ]
    return found + metadata_faults(zipfile.ZipFile(wheel).read(f"{stem}.dist-info/METADATA"), release)


def metadata_faults(content: bytes, release: str) -> list[str]:
    """Return what an index would refuse of the metadata of a wheel."""
    try:
        held = Metadata.from_email(content, validate=True)
    except ExceptionGroup as errors:
        return [f"METADATA: {error}" for error in errors.exceptions]
    got = (held.metadata_version, str(held.version), held.license_expression, (held.description or "")[:13])
    expected = ("2.4", release, "MIT", "# Clean Swarm")
    return [f"METADATA: expected {expected}, got {got}"] if got != expected else []


def _hatch(source: Path, output: Path, target: str, moment: int) -> None:
    command = [sys.executable, "-m", "hatchling", "build", "-t", target, "-d", str(output)]
    own = {**os.environ, "SOURCE_DATE_EPOCH": str(moment)}
    subprocess.run(command, cwd=source, env=own, check=True, capture_output=True)


def _short(one: object, other: object) -> object:
    """Return a value, of sets what the other has not."""
    return sorted(one - other) if isinstance(one, set) and isinstance(other, set) else one


def _git(*words: str) -> bytes:
    return subprocess.run(["git", *words], cwd=ROOT, check=True, capture_output=True).stdout


def main(arguments: list[str]) -> int:
    """Build both files; return 1 if something is wrong with them."""
    output = Path(arguments[0] if arguments else ROOT / "dist").resolve()
    if output.exists() and any(output.iterdir()):
        print(f"{output}: expected an empty or a new folder", file=sys.stderr)
        return 1
    moment = int(_git("log", "-1", "--format=%ct"))
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "source"
        packed = Path(folder) / "source.tar"
        packed.write_bytes(_git("archive", "HEAD"))
        with tarfile.open(packed) as archive:
            archive.extractall(source, filter="data")
        built = build(source, output, moment)
        wrong = faults(source, *built)
    for path in built:
        print(f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}  {path.stat().st_size:,} bytes")
    print(f"hatchling {version('hatchling')}, zlib {zlib.ZLIB_RUNTIME_VERSION}, SOURCE_DATE_EPOCH={moment}")
    for line in wrong:
        print(line, file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
