"""Where compiled kernels are kept: a file for each kernel and each set of types of its arguments.

A hash of all that the kernel is compiled from is the name of the file (`selforg.compiler.contents`). Numba's own cache
checks only the file of a kernel, although functions and constants of other files are compiled into it
(docs/decisions/0050-kernel-cache.md).
"""

from __future__ import annotations

import os
import pickle
import shutil
import stat
import tempfile
import time
import warnings
from collections.abc import Iterator, Mapping
from contextlib import suppress
from functools import cache
from itertools import count
from pathlib import Path
from types import FunctionType
from typing import Any, cast

import numba
from numba.core.bytecode import FunctionIdentity
from numba.core.caching import NullCache
from numba.core.compiler import CompileResult
from numba.core.environment import Environment, lookup_environment
from numba.core.serialize import dumps

from selforg.compiler.contents import UnkeyedError, content_key, hash_of, words_for
from selforg.compiler.intrinsics import Compiler

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
MOST = 500e6
"""Room for compiled code [byte]: what was used longest ago goes."""
MONTH = 30 * 24 * 3600.0
"""Time [s] after which compiled code goes that was not used meanwhile."""
UNCACHED = (
    "compiled code cannot be kept: {}. Every start compiles again, about a minute; "
    "NUMBA_CACHE_DIR names another directory"
)
FunctionIdentity._unique_ids = count(int.from_bytes(os.urandom(6), "big"))
"""Numba numbers functions to tell those of one name apart. One process loads what several have compiled, so each begins
at a number of its own: else a function could be linked in the place of another."""


def environment_of(name: str, constants: list[Any]) -> Environment:
    """Return Numba's environment of a function; a pickle of it would import the module of the function by name.

    The module may have been imported by another name or from another place meanwhile. Compiled code reads no globals.
    """
    found = lookup_environment(name)  # type: ignore[no-untyped-call]
    if found is None:
        found = Environment._memo[name] = Environment({"__name__": __name__})  # one without a name cannot be kept
        found.consts[:], found.env_name = constants, name
    return cast("Environment", found)


class KernelCache(NullCache):
    """The compiled code of one kernel on the disk, for `Dispatcher._cache` of Numba.

    Code that was compiled from the same contents in a module of another name or place is the same.
    """

    def __init__(self, function: FunctionType, options: Mapping[str, Any]) -> None:
        self._function, self._options = function, options

    def load_overload(self, sig: Compiler, target_context: Compiler) -> Compiler:
        """Return the compiled code for types of arguments; None if there is none, or only what was damaged."""
        target_context.refresh()
        for directory in filter(None, (cache_directory(), shared_directory())):
            with suppress(Exception):  # a pickle that is not whole may raise any
                path = directory / self.name_for(sig)
                code, described, environments, *rest = pickle.loads(path.read_bytes())
                with suppress(OSError):  # an administrator's
                    os.utime(path)  # its date is that of its last use
                own, *used = (environment_of(*one) for one in environments)
                described.modname = self._function.__module__
                return cast("Compiler", CompileResult)._rebuild(target_context, code, described, own, *rest, used)
        return None

    def save_overload(self, sig: Compiler, data: Compiler) -> None:
        """Keep compiled code; one line says so where that is not possible."""
        directory = cache_directory()
        if directory is None or data.lifted or data.library.has_dynamic_globals:
            return
        remove_old(directory)
        try:
            path = directory / self.name_for(sig)
            part = path.with_name(f"{path.name}-{os.getpid()}")  # another process may write the same
            code, described, own, *rest, used = data._reduce()
            environments = [(one.env_name, list(one.consts)) for one in (own, *used)]
            part.write_bytes(dumps((code, described, environments, *rest)))  # type: ignore[no-untyped-call]
            part.replace(path)
        except UnkeyedError as error:
            warnings.warn(f"{error}: it is compiled at every start", RuntimeWarning, stacklevel=2)
        except OSError as error:
            warnings.warn(UNCACHED.format(error), RuntimeWarning, stacklevel=2)
            with suppress(OSError):
                part.unlink()

    def name_for(self, sig: Compiler) -> str:
        """Return the name of the file for types of arguments; UnkeyedError if nothing tells of what it would be."""
        return f"{self._stem()}-{hash_of(words_for(sig))}"

    def is_kept(self) -> bool:
        """Return whether there is compiled code for any types."""
        directories = filter(None, (cache_directory(), shared_directory()))
        return any(any(directory.glob(f"{self._stem()}-*")) for directory in directories)

    def _stem(self) -> str:
        made_of = f"{content_key(self._function)} {sorted(self._options.items())}"
        return f"{self._function.__code__.co_name.strip('<>')}-{hash_of(made_of)}"


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


@cache
def remove_old(directory: Path) -> None:
    """Remove what was not used for a month, and beyond 500 MB what was used longest ago; once in a process."""
    room, found = MOST, []
    for path in directory.glob("*-*"):
        with suppress(FileNotFoundError):  # another process has just removed it
            found.append((path.stat().st_mtime, path.stat().st_size, path))
    for used, size, path in sorted(found, reverse=True):
        room -= size
        if room < 0 or time.time() - used > MONTH:
            with suppress(OSError):  # in use, on Windows
                path.unlink()
