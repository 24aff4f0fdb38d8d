"""Compiled code is never older than the sources it was made of, and every place to keep it may be missing."""

import os
import pickle
import re
import shutil
import subprocess
import sys
import time
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


SUMS = """
from selforg.compiler.decorators import kernel, lean_kernel, part, template
def rest(x): ...
@template(rest)
def whole(x): return rest(x) + 1.0
def times(y):
    @part
    def product(x): return y * x if x > 0.0 else product(x + 1.0)
    return whole.of(product)
def outer(x): return sum(times(y)(x) for y in {})
"""
MISHAPS = {
    "a full disk": "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))",
    "killed": "import os, pathlib; pathlib.Path.replace = lambda *_: os.kill(os.getpid(), 9)",
}
"""What happens to a process while it keeps compiled code -> Python that lets it happen."""


SOURCES = ("limit.py", "part.py", "kernel.py")


@pytest.fixture
def project(tmp_path):
    (tmp_path / "limit.py").write_text("LIMIT = 100.0\n")
    (tmp_path / "part.py").write_text(PART.format("2.0"))
    (tmp_path / "kernel.py").write_text(KERNEL)
    return tmp_path


BY_NAME = "from kernel import outer"
BY_FILE = "from selforg.plugins import module_of; outer = module_of('kernel.py').outer"


def start(project, way=BY_NAME, root=ROOT, **environment):
    return subprocess.Popen(
        [sys.executable, "-c", f"{way}; print(outer(3.0))"],
        cwd=project,
        env={**os.environ, "PYTHONPATH": f"{project}{os.pathsep}{root}", "PYTHONDONTWRITEBYTECODE": "1", **environment},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def outer(project, way=BY_NAME, root=ROOT, **environment):
    process = start(project, way, root, **environment)
    printed, said = process.communicate()
    assert process.returncode == 0, said
    return float(printed), said


def test_a_change_in_a_file_that_a_kernel_calls_is_seen(project):
    kept = {"NUMBA_CACHE_DIR": str(project / "kept")}
    assert outer(project, **kept)[0] == 106.0
    (project / "part.py").write_text(PART.format("5.0"))
    assert outer(project, **kept)[0] == 115.0
    (project / "limit.py").write_text("import os\nLIMIT = float(os.environ['LIMIT'])\n")
    assert [outer(project, LIMIT=limit, **kept)[0] for limit in ("200", "300")] == [215.0, 315.0]
    assert len(list((project / "kept").glob("outer-*"))) == 4


@pytest.mark.parametrize("second", [BY_NAME, BY_FILE], ids=["by name", "by file"])
@pytest.mark.parametrize("first", [BY_NAME, BY_FILE], ids=["by name", "by file"])
def test_the_same_sources_at_another_place_time_and_name_compile_nothing(first, second, project, tmp_path):
    kept = tmp_path / "kept"
    assert outer(project, first, NUMBA_CACHE_DIR=str(kept))[0] == 106.0
    before = {path: path.read_bytes() for path in kept.iterdir()}
    assert len(before) == 1
    elsewhere = tmp_path / "elsewhere"
    shutil.copytree(ROOT / "selforg", elsewhere / "selforg", ignore=shutil.ignore_patterns("__pycache__"))
    for name in SOURCES:
        (project / name).rename(elsewhere / name)
        os.utime(elsewhere / name, (0, 0))
    assert outer(elsewhere, second, elsewhere, NUMBA_CACHE_DIR=str(kept))[0] == 106.0
    assert {path: path.read_bytes() for path in kept.iterdir()} == before


@pytest.mark.long
def test_code_of_several_processes_is_told_apart(project):
    kept = {"NUMBA_CACHE_DIR": str(project / "kept")}
    for factors, expected in (("[5.0]", 16.0), ("[7.0]", 22.0), ("[5.0, 7.0]", 38.0)):
        (project / "kernel.py").write_text(SUMS.format(factors))
        assert outer(project, **kept)[0] == expected
    assert len(list((project / "kept").iterdir())) == 2


@pytest.mark.long
def test_two_processes_compile_side_by_side(project):
    kept = {"NUMBA_CACHE_DIR": str(project / "kept")}
    both = [start(project, **kept) for _ in range(2)]
    assert [one.communicate()[0] for one in both] == ["106.0\n"] * 2
    assert len(list((project / "kept").iterdir())) == 1


@pytest.mark.long
@pytest.mark.parametrize("mishap", MISHAPS)
def test_after_a_mishap_nothing_is_half_kept(mishap, project):
    kept = project / "kept"
    process = start(project, f"{BY_NAME}; {MISHAPS[mishap]}", NUMBA_CACHE_DIR=str(kept))
    printed, said = process.communicate()
    killed = mishap == "killed"
    assert (process.returncode, printed) == ((-9, "") if killed else (0, "106.0\n"))
    assert said.count("compiled code cannot be kept: [Errno 27]") == (not killed)
    assert len(list(kept.iterdir())) == killed
    assert outer(project, NUMBA_CACHE_DIR=str(kept)) == (106.0, "")


def kernel_of(code, **known):
    """Return the kernel `outer` of a source text, which another process may have compiled."""
    known["__name__"] = "elsewhere"
    exec(f"from selforg.compiler.decorators import kernel, part\n{code}", known)
    return known["outer"]


@pytest.fixture
def own(tmp_path, monkeypatch):
    """A directory that is the cache of this process for now."""
    monkeypatch.setattr(cache, "cache_directory", lambda: tmp_path)
    monkeypatch.setattr(cache, "shared_directory", lambda: None)
    return tmp_path


SQUARE = "@kernel\ndef outer(x): return x * x"


def test_what_was_damaged_is_compiled_again(own, monkeypatch):
    assert kernel_of(SQUARE)(3.0) == 9.0
    (path,) = own.iterdir()
    whole = path.read_bytes()
    for damaged in (b"", whole[:1000], pickle.dumps(7)):
        path.write_bytes(damaged)
        assert kernel_of(SQUARE)(3.0) == 9.0
        assert len(path.read_bytes()) > 1000
    os.utime(path, (1.0, 1.0))
    again = kernel_of(SQUARE)
    assert again(3.0) == 9.0
    assert again.stats.cache_hits
    assert path.stat().st_mtime > 1.0  # its last use


def test_a_disk_that_is_full_meanwhile_and_what_has_no_key_are_told(own, monkeypatch):
    with pytest.warns(RuntimeWarning, match=r"outer reads <object object at .*: it is compiled at every start"):
        assert kernel_of("@kernel\ndef outer(x): return x.real", real=object())(3.0) == 3.0
    monkeypatch.setattr(Path, "write_bytes", lambda *_: os.write(-1, b""))
    with pytest.warns(RuntimeWarning, match="compiled code cannot be kept: .*Bad file"):
        assert kernel_of(SQUARE)(3.0) == 9.0
    assert not list(own.iterdir())


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
    for file in kept.iterdir():
        file.write_bytes(pickle.dumps(Planted(mark)))
    return kept, mark


OTHER = 65534
BY_OTHERS = {
    "all may write the cache": lambda kept: kept.chmod(0o777),
    "all may write it, sticky": lambda kept: kept.chmod(0o1777),
    "a group may write it": lambda kept: kept.chmod(0o770),
    "all may write above it": lambda kept: kept.parent.chmod(0o777),
    "all may write a file": lambda kept: [kept.chmod(0o755), next(kept.glob("kernel-*/code")).chmod(0o666)],
}
if os.getuid() == 0:  # only root can give files away
    BY_OTHERS |= {
        "another's cache": lambda kept: os.chown(kept, OTHER, OTHER),
        "another's folder": lambda kept: os.chown(next(kept.iterdir()), OTHER, OTHER),
        "another's file": lambda kept: os.chown(next(kept.glob("kernel-*/code")), OTHER, OTHER),
        "another's above": lambda kept: os.chown(kept.parent, OTHER, OTHER),
    }


@pytest.mark.parametrize("way", BY_OTHERS)
def test_what_others_may_have_written_is_doubted(tmp_path, way):
    kept = tmp_path / "above" / "kept"
    (kept / "kernel-1").mkdir(parents=True)
    (kept / "kernel-1" / "code").write_bytes(b"code")
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
    assert outer(project, NUMBA_CACHE_DIR=str(kept))[0] == 106.0
    assert mark.exists()  # so the code of the test above is one that would run


def test_a_cache_that_can_only_be_read_is_read(tmp_path, own, monkeypatch):
    shared = tmp_path / "shared"
    assert kernel_of(SQUARE)(3.0) == 9.0
    shared.mkdir()
    (path,) = own.glob("outer-*")
    path.rename(shared / path.name)
    monkeypatch.undo()
    monkeypatch.setattr(cache.numba.config, "CACHE_DIR", str(shared))
    monkeypatch.setattr(cache.os, "access", lambda place, mode: False)  # root may write anywhere
    monkeypatch.setattr(cache, "shared_directory", cache.shared_directory.__wrapped__)
    monkeypatch.setattr(cache, "cache_directory", cache.cache_directory.__wrapped__)
    monkeypatch.setenv("XDG_CACHE_HOME", str(own))
    again = kernel_of(SQUARE)
    assert again(3.0) == 9.0
    assert again.stats.cache_hits
    assert again._cache.is_kept()
    assert cache.cache_directory() == own / "clean-swarm"
    assert not list(cache.cache_directory().iterdir())
    shared.chmod(0o777)
    assert cache.shared_directory() is None
    with pytest.warns(RuntimeWarning, match="others may write"):
        assert not again._cache.is_kept()


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


def test_what_was_used_longest_ago_goes(tmp_path, monkeypatch):
    monkeypatch.setattr(cache, "MOST", 25)
    ages = {"a-new": 0.0, "b-of-a-day": 1.0, "c-third": 2.0, "d-of-a-month": 31.0}
    for name, days in ages.items():
        (tmp_path / name).write_bytes(b"0123456789")
        os.utime(tmp_path / name, (time.time() - days * 24 * 3600.0,) * 2)
    (tmp_path / "compiling.lock").write_bytes(b"")
    cache.remove_old.__wrapped__(tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {"a-new", "b-of-a-day", "compiling.lock"}
    os.utime(tmp_path / "a-new", (1.0, 1.0))
    cache.remove_old.__wrapped__(tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {"b-of-a-day", "compiling.lock"}
