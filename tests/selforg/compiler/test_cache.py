"""Compiled code is never older than the sources it was made of, and every place to keep it may be missing."""

import os
import subprocess
import sys
from types import SimpleNamespace

import pytest

from selforg.compiler import cache
from tests.paths import ROOT

PART = """
from selforg.compiler.decorators import part
from limit import LIMIT
@part
def inner(x): return x * {} + LIMIT
"""
KERNEL = """
from selforg.compiler.decorators import kernel
from part import inner
@kernel
def outer(x): return inner(x)
"""


@pytest.fixture
def project(tmp_path):
    (tmp_path / "limit.py").write_text("LIMIT = 100.0\n")
    (tmp_path / "part.py").write_text(PART.format("2.0"))
    (tmp_path / "kernel.py").write_text(KERNEL)
    return tmp_path


def outer(project, **environment):
    done = subprocess.run(
        [sys.executable, "-c", "from kernel import outer; print(outer(3.0))"],
        cwd=project,
        env={**os.environ, "PYTHONPATH": f"{project}{os.pathsep}{ROOT}", "PYTHONDONTWRITEBYTECODE": "1", **environment},
        capture_output=True,
        text=True,
        check=True,
    )
    return float(done.stdout), done.stderr


def test_a_change_in_a_file_that_a_kernel_calls_is_seen(project):
    kept = {"NUMBA_CACHE_DIR": str(project / "kept")}
    assert outer(project, **kept)[0] == 106.0
    (project / "part.py").write_text(PART.format("5.0"))
    assert outer(project, **kept)[0] == 115.0
    (project / "limit.py").write_text("LIMIT = 200.0\n")
    assert outer(project, **kept)[0] == 215.0
    assert len(list((project / "kept").glob("kernel-*"))) == 3


def test_where_nothing_can_be_kept_kernels_run_all_the_same_and_say_so_once(project):
    nowhere = project / "a-file"
    nowhere.write_text("")
    result, said = outer(project, NUMBA_CACHE_DIR=str(nowhere))
    assert result == 106.0
    assert said.count("compiled code cannot be kept") == 1


def test_a_full_disk_and_no_home_count_as_nowhere(tmp_path, monkeypatch):
    monkeypatch.setattr(cache.numba.config, "CACHE_DIR", str(tmp_path))
    find = cache.cache_directory.__wrapped__
    assert find() == tmp_path
    full = SimpleNamespace(total=1e9, used=1e9, free=cache.ROOM - 1.0)
    monkeypatch.setattr(cache.shutil, "disk_usage", lambda place: full)
    assert find() is None
    monkeypatch.undo()
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(cache, "OWN_ROOT", tmp_path / "a-file")
    (tmp_path / "a-file").write_text("")
    monkeypatch.setattr(cache.numba.config, "CACHE_DIR", "")
    monkeypatch.setattr(cache.os.path, "expanduser", lambda path: path)  # as where no home is known
    monkeypatch.chdir(tmp_path)
    assert find() is None
    assert [path.name for path in tmp_path.iterdir()] == ["a-file"]


def test_folders_of_older_sources_go_after_a_week(tmp_path):
    old, young, other = (tmp_path / name for name in ("mine-1", "mine-2", "other-1"))
    for folder in (old, young, other):
        folder.mkdir()
    for folder in (old, other):
        os.utime(folder, (1.0, 1.0))
    cache.remove_old(tmp_path, "mine")
    assert not old.exists()
    assert young.exists()
    assert other.exists()


def test_the_hash_covers_what_is_imported_directly_or_not():
    sources = {path.relative_to(ROOT).as_posix() for path in cache.sources_of(ROOT / "selforg/gradients/poses.py")}
    assert {"selforg/space.py", "selforg/gradients/store/columns.py", "selforg/arrays.py"} <= sources
    assert not any(source.startswith(("clean_swarm_env/", "train/")) for source in sources)
