"""Where compiled kernels are kept: a folder for each source file, named by a hash of all that the kernels are made of.

Numba's own cache checks only the file of a kernel. Functions that the kernel calls in other files are compiled into it,
and so are the constants of those files: a change there has to lead to a new folder. The hash covers the file, every
file of ours that it imports, directly or not, the switches, and the versions of Numba and of its optimiser
(docs/decisions/0050-kernel-cache.md).
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import stat
import tempfile
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from types import FunctionType
from typing import Any, Self

import numba
from numba.core.caching import CompileResultCacheImpl, FunctionCache, _CacheLocator
from numba.core.environment import Environment, lookup_environment

from selforg.compiler.switches import CHECKED, PLAIN

PACKAGE = Path(__file__).resolve().parents[1]


def doubt_about(place: Path) -> str:
    """Return why compiled code in a folder is not to be used; nothing if only trusted users may have written it.

    Compiled code runs as whoever loads it. Trusted are the user, root, and the owner of the package, whose sources run
    anyway (docs/decisions/0210-owners-of-compiled-code.md). The folder, all that is in it, and the folders above count:
    who may rename a folder may put another one there.
    """
    on_windows = not hasattr(os, "getuid")  # there a user's folders are closed to others
    return "" if on_windows else next(_doubts(place.resolve()), "")


def _doubts(whole: Path) -> Iterator[str]:
    trusted = {os.getuid(), 0, PACKAGE.stat().st_uid}
    above = [(path, stat.S_ISVTX) for path in whole.parents if path not in PACKAGE.parents]  # they hold our sources
    closed = 0 if whole.stat().st_mode & 0o077 else 0o022
    within = [(Path(top, name), closed) for top, folders, files in os.walk(whole) for name in (*folders, *files)]
    for path, excuse in (*above, (whole, 0), *within):
        with suppress(FileNotFoundError):  # another process has just removed it
            found = path.lstat()
            if found.st_uid not in trusted:
                yield f"{path} belongs to user {found.st_uid}"
            elif found.st_mode & 0o022 and not found.st_mode & excuse:
                yield f"others may write {path}"


OWN_ROOT = Path(__file__).parents[2]
"""The directory that holds the package `selforg`."""
ROOM = 100e6
"""Free room below which nothing is kept [byte]; the kernels of all commands take less."""
WEEK = 7 * 24 * 3600.0
"""Age [s] from which a folder for older sources is removed; a younger one may serve another branch or process."""
UNCACHED = (
    "compiled code cannot be kept: {}. Every start compiles again, about a minute; "
    "NUMBA_CACHE_DIR names another directory"
)
IMPORT = re.compile(r"^[ \t]*(?:from[ \t]+([\w.]+)[ \t]+import[ \t]+(?:\(([^)]*)\)|(.*))|import[ \t]+(.*))$", re.M)


class InFolder(_CacheLocator):
    """Keeps a kernel in the folder of `keeping_in`, wherever its sources lie: the name of the folder is their hash."""

    def __init__(self, line: int) -> None:
        self._folder, self._line = numba.config.CACHE_DIR, line  # type: ignore[attr-defined]

    def get_cache_path(self) -> str:
        """Return the folder."""
        return str(self._folder)

    def get_source_stamp(self) -> str:
        """Return nothing: the name of the folder says of which sources its kernels are."""
        return ""

    def get_disambiguator(self) -> str:
        """Return the line, because a file may define two kernels of one name."""
        return str(self._line)

    @classmethod
    def from_function(cls, py_func: FunctionType, py_file: str) -> Self:
        """Return the place of a function; Numba calls this while it decorates."""
        return cls(py_func.__code__.co_firstlineno)


class Constants:
    """A stand-in for Numba's `Environment` in a pickle, which would import the module of its function by name.

    The module may have been imported by another name or from another place meanwhile. Compiled code reads no globals.
    """

    def __init__(self, given: Any) -> None:  # noqa: ANN401  (an Environment)
        self._given = given

    def __reduce__(self) -> tuple[Any, ...]:
        return environment_of, (self._given.env_name, list(self._given.consts))


def environment_of(name: str, constants: list[Any]) -> Any:  # noqa: ANN401  (an Environment)
    """Return the environment of this name, made of these constants if there is none."""
    found = lookup_environment(name)  # type: ignore[no-untyped-call]
    if found is None:
        found = Environment({"__name__": __name__})  # without a name, it could not be kept with other kernels
        found.consts[:], found.env_name = constants, name
        Environment._memo[name] = found
    return found


class AnyPlaceImpl(CompileResultCacheImpl):
    """Pickles compiled code so that it does not depend on the name by which the module of its function was imported."""

    def __init__(self, py_func: FunctionType) -> None:
        super().__init__(py_func)  # type: ignore[no-untyped-call]
        self._module = py_func.__module__

    def reduce(self, cres: Any) -> Any:  # noqa: ANN401  (Numba's)
        """Return the parts of what was compiled, with `Constants` in the place of environments."""
        code, described, own, *rest, used = cres._reduce()
        return code, described, Constants(own), *rest, tuple(map(Constants, used))

    def rebuild(self, target_context: Any, payload: Any) -> Any:  # noqa: ANN401  (Numba's)
        """Return compiled code, as that of the module of today."""
        payload[1].modname = self._module
        return super().rebuild(target_context, payload)  # type: ignore[no-untyped-call]


class AnyPlaceCache(FunctionCache):
    """Numba's cache of one function, for a module of any name."""

    _impl_class = AnyPlaceImpl


@contextmanager
def keeping_in(folder: Path) -> Iterator[None]:
    """Let Numba keep the kernels that are decorated meanwhile in a folder."""
    config: Any = numba.config
    given = config.CACHE_DIR, config.CACHE_LOCATOR_CLASSES
    config.CACHE_DIR, config.CACHE_LOCATOR_CLASSES = str(folder), f"{__name__}.{InFolder.__name__}"
    try:
        yield
    finally:
        config.CACHE_DIR, config.CACHE_LOCATOR_CLASSES = given


@cache
def cache_directory() -> Path | None:
    """Return the directory of all compiled code; None, with a warning, where it cannot be kept.

    This is NUMBA_CACHE_DIR if that is set and not `shared_directory`, else one in the user's cache, which serves all
    copies of the package, else a folder beside the package. One that others may have written is not used.
    """
    given, doubts = numba.config.CACHE_DIR, []  # type: ignore[attr-defined]
    user = Path(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"), "clean-swarm")
    own = [user, OWN_ROOT / "selforg" / "__pycache__" / "kernels"]
    places = [Path(given)] if given and shared_directory() is None else own
    for place in places:
        if place is user and not user.is_absolute():  # no home is known
            continue
        try:
            place.mkdir(mode=0o700, parents=True, exist_ok=True)
            doubts.append(doubt_about(place))
            if not doubts[-1]:
                with tempfile.TemporaryFile(dir=place):
                    if shutil.disk_usage(place).free >= ROOM:
                        return place
        except OSError:
            continue
    warnings.warn(
        UNCACHED.format("; ".join(filter(None, doubts)) or "nowhere to write, or no room is left"),
        RuntimeWarning,
        stacklevel=2,
    )
    return None


@cache
def shared_directory() -> Path | None:
    """Return NUMBA_CACHE_DIR if an administrator shares it: the user can read it only, and so can all others."""
    given = Path(numba.config.CACHE_DIR or os.devnull)  # type: ignore[attr-defined]
    reads = given.is_dir() and not os.access(given, os.W_OK)
    return given if reads and not doubt_about(given) else None


def copy_shared(folder: Path) -> None:
    """Copy what an administrator shares into a folder that does not exist yet."""
    shared = shared_directory()
    if shared is not None:
        with suppress(OSError), tempfile.TemporaryDirectory(dir=folder.parent) as part:  # nothing there, or no room
            shutil.copytree(shared / folder.name, Path(part) / folder.name).rename(folder)


@cache
def folder_for(file: str, *others: str) -> Path | None:
    """Return the folder for the kernels of a source file, or None where nothing can be kept or there is no file.

    others: files that these kernels are made of beside what `file` imports.
    """
    directory, path = cache_directory(), Path(file)
    if directory is None or not path.is_file():
        return None
    name = ".".join(path.with_suffix("").relative_to(root_of(path)).parts)
    folder = directory / f"{name}-{fingerprint(path, *map(Path, others))}"
    if not folder.exists():
        remove_old(directory, name)
        copy_shared(folder)
    return folder


@cache
def fingerprint(*files: Path) -> str:
    """Return the hash of everything that kernels made of `files` are compiled from."""
    config = numba.config
    known = f"{numba.__version__} {config.OPT} {config.ENABLE_AVX} {PLAIN} {CHECKED}"  # type: ignore[attr-defined]
    digest = hashlib.sha256(known.encode())
    for source in sorted(set().union(*map(sources_of, files))):
        digest.update(digest_of(source))
    return digest.hexdigest()[:16]


@cache
def digest_of(file: Path) -> bytes:
    """Return the hash of the bytes of a source file."""
    return hashlib.sha256(contents(file)).digest()


def sources_of(file: Path) -> set[Path]:
    """Return `file` and every file of ours or of its own project that it imports, directly or not."""
    found, waiting = {file}, [file]
    while waiting:
        new = imported_by(waiting.pop()) - found
        found |= new
        waiting += new
    return found


@cache
def imported_by(file: Path) -> frozenset[Path]:
    """Return the files that `file` imports: of its own project, and of the one that holds this package."""
    names: set[str] = set()
    for module, bracketed, listed, plain in IMPORT.findall(contents(file).decode("utf-8", "replace")):
        entries = [part.split()[0] for part in (bracketed or listed or plain).split(",") if part.split()]
        names |= {module, *(f"{module}.{entry}" for entry in entries)} if module else set(entries)
    roots = {root_of(file), OWN_ROOT}
    return frozenset(path for name in names for root in roots for path in module_files(root, name))


@cache
def module_files(root: Path, name: str) -> tuple[Path, ...]:
    """Return the file of a module below `root`, or nothing if there is none."""
    place = root.joinpath(*name.split("."))
    candidates = (place.with_name(place.name + ".py"), place / "__init__.py")
    return tuple(path for path in candidates if name and path.is_file())


@cache
def contents(file: Path) -> bytes:
    """Return the bytes of a source file, nothing if there is no such file."""
    return file.read_bytes() if file.is_file() else b""


@cache
def root_of(file: Path) -> Path:
    """Return the directory from which a file is imported: the first one upwards that is no package."""
    place = file.parent
    while (place / "__init__.py").is_file():
        place = place.parent
    return place


def remove_old(directory: Path, name: str) -> None:
    """Remove folders of kernels of the module `name` that were made for other sources and not used for a week."""
    for folder in directory.glob(f"{name}-*"):
        try:
            if time.time() - folder.stat().st_mtime > WEEK:
                shutil.rmtree(folder, ignore_errors=True)
        except OSError:  # another process has just removed it
            continue
