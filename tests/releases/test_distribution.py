"""What is published: built twice with the same bytes, complete, with valid metadata, working without the checkout."""

import os
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest
import yaml

from clean_swarm_env import __version__
from tests.paths import ROOT
from tests.releases.build import BESIDE, PACKAGES, build, faults, metadata_faults

MOMENT = 1_795_000_000
"""Any time after 1980, as that of a commit [s]."""


def copied(folder: Path, umask: int, moment: int) -> Path:
    """Copy what is built from, with the rights that a umask leaves and a time for all files."""
    for name in PACKAGES:
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in BESIDE:
        shutil.copyfile(ROOT / name, folder / name)
    for path in folder.rglob("*"):
        path.chmod((0o777 if path.is_dir() else 0o666) & ~umask)
        os.utime(path, (moment, moment))
    return folder


@pytest.fixture(scope="module")
def built(tmp_path_factory) -> tuple[Path, Path, Path]:
    """A copy of the project, and the sdist and the wheel that were built from it."""
    pytest.importorskip("hatchling")
    source = copied(tmp_path_factory.mktemp("source"), 0o022, 1_700_000_000)
    return source, *build(source, tmp_path_factory.mktemp("dist"), MOMENT)


@pytest.mark.extra
def test_what_is_published_is_complete_small_and_valid(built):
    assert faults(*built) == []
    names = {name.partition("/")[0] for name in zipfile.ZipFile(built[2]).namelist()}
    assert names == PACKAGES | {f"clean_swarm-{__version__}.dist-info"}


@pytest.mark.extra
def test_the_same_bytes_come_from_another_place_with_other_rights_times_and_files_beside(built, tmp_path):
    (tmp_path / "elsewhere").mkdir()
    other = copied(tmp_path / "elsewhere", 0o077, 1_000_000_000)
    for name in ("results/run/manifest.json", "my/missions/hall.yaml", "tests/test_x.py", "train/__pycache__/x.pyc"):
        path = other / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("x")
    again = build(other, tmp_path / "dist", MOMENT)
    assert [path.read_bytes() for path in again] == [path.read_bytes() for path in built[1:]]


@pytest.mark.extra
def test_faults_are_found(built, tmp_path):
    source, sdist, wheel = built
    short = tmp_path / wheel.name
    with zipfile.ZipFile(wheel) as old, zipfile.ZipFile(short, "w", zipfile.ZIP_DEFLATED) as new:
        for name in old.namelist():
            if name != "configs/missions/table1.yaml":
                new.writestr(name, old.read(name))
    assert faults(source, sdist, short) == ["files of the wheel: expected ['configs/missions/table1.yaml'], got []"]
    content = zipfile.ZipFile(wheel).read(f"clean_swarm-{__version__}.dist-info/METADATA")
    assert metadata_faults(content, __version__) == []
    for change, message in (
        ((b"Version: 1", b"Version: one"), "invalid"),
        ((b"License-Expression: MIT", b"License-Expression: Ours"), "invalid"),
        ((b"# Clean Swarm\n", b"# Other\n"), "expected ('2.4'"),
    ):
        assert message in " ".join(metadata_faults(content.replace(*change, 1), __version__))


@pytest.mark.extra
def test_the_installed_wheel_works_from_any_directory(built, tmp_path):
    target = tmp_path / "site"
    zipfile.ZipFile(built[2]).extractall(target)
    code = (
        f"import sys; sys.path.insert(0, {str(target)!r}); sys.argv = ['clean-swarm', 'list', 'experiments'];"
        "import train.cli, selector.documents.find as find; print(train.cli.__file__, find.SHIPPED); train.cli.main()"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    first, *others = done.stdout.splitlines()
    assert all(place.startswith(str(target)) for place in first.split())
    assert any(line.startswith("table1-reference ") for line in others)


def test_the_release_has_one_version():
    held = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    number, date = re.findall(r"^## (\S+) \((.+)\)$", changes, re.MULTILINE)[0]
    assert (held["version"], held["date-released"].isoformat()) == (number, date)
    assert number == __version__
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["dynamic"] == ["version"]
    assert "version" not in project
