"""Compiled code is never older than the sources it was made of, and every place to keep it may be missing."""

import os
import pickle
import re
import shutil
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from types import SimpleNamespace

import pytest

from selforg.compiler import cache
from selforg.compiler.cache import doubt_about
from tests.paths import ROOT

PART = """
from selforg.compiler.decorators import part
from limit import LIMIT
@part
def inner(x): return x * {} + LIMIT
"""
KERNEL = """
import builtins
from selforg.compiler.decorators import kernel, part
assert not hasattr(builtins, "ran")  # as a registry refuses a class that it has
builtins.ran = True
from part import inner
@part
def own(x): return inner(x)
@kernel
def outer(x): return own(x)
"""


TEMPLATE = """
from selforg.compiler.decorators import part, template
def rest(x): ...
@template(rest)
def whole(x): return rest(x) + 1.0
"""
FILLED = """
from selforg.compiler.decorators import part
from template import whole
@part
def double(x): return 2.0 * x
def times(y):
    @part
    def product(x): return y * x
    return product
outer = whole.of(double)
assert (whole.of(times(5.0))(3.0), whole.of(times(7.0))(3.0)) == (16.0, 22.0)
"""


SOURCES = ("limit.py", "part.py", "kernel.py")


@pytest.fixture
def project(tmp_path):
    (tmp_path / "limit.py").write_text("LIMIT = 100.0\n")
    (tmp_path / "part.py").write_text(PART.format("2.0"))
    (tmp_path / "kernel.py").write_text(KERNEL)
    return tmp_path


BY_NAME = "from kernel import outer"
BY_FILE = "from selforg.plugins import module_of; outer = module_of('kernel.py').outer"


def outer(project, way=BY_NAME, **environment):
    done = subprocess.run(
        [sys.executable, "-c", f"{way}; print(outer(3.0))"],
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


@pytest.mark.parametrize("second", [BY_NAME, BY_FILE], ids=["by name", "by file"])
@pytest.mark.parametrize("first", [BY_NAME, BY_FILE], ids=["by name", "by file"])
def test_the_same_sources_at_another_place_time_and_name_compile_nothing(first, second, project, tmp_path):
    kept = tmp_path / "kept"
    assert outer(project, first, NUMBA_CACHE_DIR=str(kept))[0] == 106.0
    before = {path: path.read_bytes() for path in kept.rglob("*.nb?")}
    assert len(before) == 2
    shutil.copytree(project, tmp_path / "elsewhere", ignore=lambda folder, names: {*names} - {*SOURCES})
    for name in SOURCES:
        os.utime(tmp_path / "elsewhere" / name, (0, 0))
    for name in SOURCES:
        (project / name).unlink()
    assert outer(tmp_path / "elsewhere", second, NUMBA_CACHE_DIR=str(kept))[0] == 106.0
    assert {path: path.read_bytes() for path in kept.rglob("*.nb?")} == before


@pytest.mark.long
def test_a_template_is_kept_for_each_function_that_has_a_name_of_its_own_and_changes_with_both_files(project):
    (project / "template.py").write_text(TEMPLATE)
    (project / "kernel.py").write_text(FILLED)
    kept = {"NUMBA_CACHE_DIR": str(project / "kept")}
    assert outer(project, **kept)[0] == outer(project, **kept)[0] == 7.0
    assert [path.name.partition("-")[0] for path in (project / "kept").rglob("*.nbi")] == ["kernel.whole_double"]
    (project / "template.py").write_text(TEMPLATE.replace("1.0", "2.0"))
    (project / "kernel.py").write_text(FILLED.replace("(16.0, 22.0)", "(17.0, 23.0)"))
    assert outer(project, **kept)[0] == 8.0


def test_where_nothing_can_be_kept_kernels_run_all_the_same_and_say_so_once(project):
    nowhere = project / "a-file"
    nowhere.write_text("")
    result, said = outer(project, NUMBA_CACHE_DIR=str(nowhere))
    assert result == 106.0
    assert said.count("compiled code cannot be kept") == 1


class Planted:
    """Leaves a mark when it is unpickled, as Numba unpickles what it finds in its cache."""

    def __init__(self, mark):
        self.mark = mark

    def __reduce__(self):
        return Path.touch, (self.mark,)


def planted(project):
    """Plant code in a cache of the kernel; return the cache and the mark that the code leaves."""
    kept, mark = project / "above" / "kept", project / "mark"
    outer(project, NUMBA_CACHE_DIR=str(kept))
    for index in kept.rglob("*.nbi"):
        index.write_bytes(pickle.dumps(Planted(mark)))
    return kept, mark


OTHER = 65534
BY_OTHERS = {
    "all may write the cache": lambda kept: kept.chmod(0o777),
    "all may write it, sticky": lambda kept: kept.chmod(0o1777),
    "a group may write it": lambda kept: kept.chmod(0o770),
    "all may write above it": lambda kept: kept.parent.chmod(0o777),
    "all may write a file": lambda kept: [kept.chmod(0o755), next(kept.rglob("*.nbi")).chmod(0o666)],
}
if os.getuid() == 0:  # only root can give files away
    BY_OTHERS |= {
        "another's cache": lambda kept: os.chown(kept, OTHER, OTHER),
        "another's folder": lambda kept: os.chown(next(kept.glob("kernel-*")), OTHER, OTHER),
        "another's file": lambda kept: os.chown(next(kept.rglob("*.nbi")), OTHER, OTHER),
        "another's above": lambda kept: os.chown(kept.parent, OTHER, OTHER),
    }


@pytest.mark.parametrize("way", BY_OTHERS)
def test_what_others_may_have_written_is_doubted(tmp_path, way):
    kept = tmp_path / "above" / "kept"
    (kept / "kernel-1" / "deep").mkdir(parents=True)
    (kept / "kernel-1" / "deep" / "kernel.nbi").write_bytes(b"code")
    kept.chmod(0o700)
    assert doubt_about(kept) == ""
    BY_OTHERS[way](kept)
    words = f"belongs to user {OTHER}$" if way.startswith("another") else "^others may write /"
    assert re.search(words, doubt_about(kept))


@pytest.mark.long
def test_code_that_others_planted_does_not_run(project):
    kept, mark = planted(project)
    BY_OTHERS["another's folder" if os.getuid() == 0 else "all may write the cache"](kept)
    result, said = outer(project, NUMBA_CACHE_DIR=str(kept))
    assert result == 106.0
    assert not mark.exists()
    (line,) = (line for line in said.splitlines() if "compiled code cannot be kept" in line)
    assert str(kept) in line


@pytest.mark.long
def test_a_cache_is_its_owners_alone_and_his_code_runs(project):
    kept, mark = planted(project)
    assert kept.stat().st_mode & 0o777 == 0o700
    with suppress(subprocess.CalledProcessError):  # what was planted is no index
        outer(project, NUMBA_CACHE_DIR=str(kept))
    assert mark.exists()  # so the code of the test above is one that would run


def test_a_cache_that_can_be_read_only_is_copied(tmp_path, monkeypatch):
    shared, own = tmp_path / "shared", tmp_path / "own"
    (shared / "mine-1" / "deep").mkdir(parents=True)
    (shared / "mine-1" / "deep" / "index").write_bytes(b"code")
    own.mkdir()
    monkeypatch.setattr(cache.numba.config, "CACHE_DIR", str(shared))
    monkeypatch.setattr(cache.os, "access", lambda place, mode: False)  # root may write anywhere
    monkeypatch.setattr(cache, "shared_directory", cache.shared_directory.__wrapped__)
    cache.copy_shared(own / "mine-1")
    cache.copy_shared(own / "mine-2")
    assert [path.name for path in own.rglob("*")] == ["mine-1", "deep", "index"]
    monkeypatch.setenv("XDG_CACHE_HOME", str(own))
    monkeypatch.setattr(cache, "OWN_ROOT", tmp_path / "a-file")
    (tmp_path / "a-file").write_text("")
    assert cache.cache_directory.__wrapped__() == own / "clean-swarm"
    shared.chmod(0o777)
    assert cache.shared_directory() is None


def test_a_full_disk_and_no_home_count_as_nowhere(tmp_path, monkeypatch):
    monkeypatch.setattr(cache.numba.config, "CACHE_DIR", str(tmp_path))
    find = cache.cache_directory.__wrapped__
    assert find() == tmp_path
    full = SimpleNamespace(total=1e9, used=1e9, free=cache.ROOM - 1.0)
    monkeypatch.setattr(cache.shutil, "disk_usage", lambda place: full)
    with pytest.warns(RuntimeWarning, match="no room is left"):
        assert find() is None
    monkeypatch.undo()
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr(cache, "OWN_ROOT", tmp_path / "a-file")
    (tmp_path / "a-file").write_text("")
    monkeypatch.setattr(cache.numba.config, "CACHE_DIR", "")
    monkeypatch.setattr(cache.os.path, "expanduser", lambda path: path)  # as where no home is known
    monkeypatch.chdir(tmp_path)
    with pytest.warns(RuntimeWarning, match="nowhere to write, or no room"):
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
