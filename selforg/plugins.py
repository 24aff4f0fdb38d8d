"""Plug-ins: modules of users that register mechanisms, strategies, tasks, ... as soon as they are imported.

`--import` and `imports=` name some; they are imported at once, and by every process that this one starts. Installed
packages name others as entry points of the group `clean_swarm`; these wait until a name is looked up that nobody else
has registered. A package may hold folders of files, such as `families`, beside its modules.
"""

import os
import reprlib
import sys
import textwrap
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import cache, wraps
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from inspect import getattr_static
from pathlib import Path
from threading import RLock
from traceback import extract_tb
from types import FunctionType, ModuleType
from typing import Any, TypeAlias

Promises: TypeAlias = Mapping[str, tuple[Any, ...]]
"""Part of a class -> what is expected in words, in which {0} is the object; a function that tells whether that is so of
the object, the answer and the arguments; the numbers of the arguments that are arrays which stay as they are."""
GROUP = "clean_swarm"
"""Group of the entry points by which installed packages name their plug-ins."""
NAMED = "CLEAN_SWARM_IMPORT"
"""Environment variable with the plug-ins that a user has named, which the processes that this one starts read, too."""
OURS = ("selforg", "selector", "clean_swarm_env", "train", "configs")
OF_FILE = "file "
"""Beginning of the name of a module that is no more than a file."""
MOST_SAID = 400
"""Letters of an error of a plug-in that fit a line."""

_lock = RLock()


class PluginError(ValueError):
    """A plug-in cannot be imported, or does not keep its contract; the message is one line."""


_loaded: list[PluginError | None] = []
"""Once plug-ins were imported: what went wrong then, which goes wrong each time, as part of them is imported by now."""


def named_plugins() -> tuple[str, ...]:
    """Return the plug-ins that the user has named: modules, and absolute paths of files."""
    return tuple(filter(None, os.environ.get(NAMED, "").split(os.pathsep)))


def import_named(names: str | os.PathLike[str] | Iterable[str | os.PathLike[str]]) -> None:
    """Import plug-ins by module or `path/to/file.py`, in this process and in all that it starts from now on.

    Raises:
        PluginError: there is no such module or file, or it cannot be imported.

    """
    given = [names] if isinstance(names, str | os.PathLike) else names
    places = [module_or_file(os.fspath(name)) for name in given]
    for place in places:
        module_of(place)
    if places:
        os.environ[NAMED] = os.pathsep.join(dict.fromkeys((*named_plugins(), *places)))  # none that fails


def module_or_file(name: str) -> str:
    """Return the module that a name stands for, or the absolute path of its file; PluginError for anything else."""
    if name.endswith(".py") and Path(name).is_file():
        path = os.path.abspath(name)
        if os.pathsep in path:  # which separates plug-ins in the environment
            raise PluginError(f"{path}: expected a path without {os.pathsep!r}")
        return path
    if name.endswith(".py") or not all(map(str.isidentifier, name.split("."))):
        raise PluginError(f"{name or '--import'}: expected a module, or a file of Python code that ends with .py")
    return name


def is_named(place: str) -> bool:
    """Return whether a module or a file is a plug-in that the user has named, or a part of one."""
    own = os.path.abspath(place) if place.endswith(".py") else place
    return any(own == one or own.startswith(f"{one}.") for one in named_plugins())


def module_of(place: str) -> ModuleType:
    """Return a module, also one in the working directory, or that of a file; it is executed once in a process."""
    with errors_in_a_line(place):
        if place.endswith(".py"):
            return _module_of_file(place)
        if os.getcwd() not in sys.path:
            sys.path.append(os.getcwd())
        return import_module(place)


def load() -> None:
    """Import the plug-ins that the process which started this one has named, and all that are installed; once."""
    with _lock:
        if not _loaded:
            _loaded.append(None)  # a plug-in may look up names itself
            try:
                for place in named_plugins():
                    module_of(place)
                for entry in installed():
                    with errors_in_a_line(entry.module):
                        entry.load()
            except PluginError as error:
                _loaded[0] = error
            except BaseException:
                _loaded.clear()
                raise
        if _loaded[0] is not None:
            raise _loaded[0]


@cache
def installed() -> tuple[EntryPoint, ...]:
    """Return the entry points of installed plug-ins, in the order of their names."""
    return tuple(sorted(set(entry_points(group=GROUP)), key=lambda entry: (entry.name, entry.value)))


def folders() -> dict[Path, str]:
    """Return the folders of all plug-ins that are packages, each with its origin; none of their code runs."""
    modules = {entry.module: origin_of(entry.module) for entry in installed()}
    modules |= {place: place for place in named_plugins() if not place.endswith(".py")}
    return {folder: origin for module, origin in modules.items() for folder in _own_files(module) if folder.is_dir()}


def origin_of(module: str) -> str:
    """Return where a module comes from: an installed package with its version, a file, or its own name."""
    top = module.partition(".")[0]
    for entry in installed():
        if entry.module.partition(".")[0] == top and entry.dist is not None:
            return f"{entry.dist.name} {entry.dist.version}"
    return module.removeprefix(OF_FILE)


def is_own(cls: Any) -> bool:  # noqa: ANN401
    """Return whether a class or a function is none of ours."""
    return (cls.__module__ or "").partition(".")[0] not in OURS


@contextmanager
def errors_in_a_line(place: str, code: Any = None) -> Iterator[None]:  # noqa: ANN401  (a function)
    """Let whatever goes wrong in a plug-in become one line with its place in the files of the plug-in.

    `code` of ours that works for a plug-in may say itself what is wrong, by an error of ours.
    """
    try:
        yield
    except (PluginError, KeyboardInterrupt):
        raise
    except BaseException as error:  # an exit within a plug-in would end the command as if it had done its work
        if isinstance(error, ValueError) and not (code is None or is_own(code) or is_own(type(error))):
            raise
        frames = [(frame.filename, frame.lineno) for frame in extract_tb(error.__traceback__)]
        if isinstance(error, SyntaxError):
            frames.append((error.filename or "", error.lineno))
        own = tuple(map(str, _own_files(place)))
        where = [f"{file}:{line}" for file, line in frames if own and file.startswith(own)]
        kind, said = "" if isinstance(error, ModuleNotFoundError) else f"{type(error).__name__}: ", ""
        with suppress(BaseException):  # an error of a plug-in's own class may fail to say what went wrong
            said = textwrap.shorten(str(error), MOST_SAID, placeholder=" ...")
        raise PluginError(f"{[place.removeprefix(OF_FILE), *where][-1]}: {kind}{said}") from error


@cache
def guard(cls: type) -> None:
    """Let errors of a plug-in's class become one line in each part that classes of ours have too, and check promises.

    Parts are methods, class methods and properties; `promises` of a class of ours say what is expected of them.
    """
    ours = {"__init__"}.union(*(vars(one) for one in cls.__mro__ if not is_own(one)))
    promises: Promises = getattr(cls, "promises", {})
    for name in ours.intersection(dir(cls)):
        part = getattr_static(cls, name)
        function = getattr(part, "__func__", getattr(part, "fget", part))
        if isinstance(part, staticmethod) or not isinstance(function, FunctionType):
            continue  # formulas are compiled
        if is_own(function) or name in promises:
            called = _guarded(function, name, *promises.get(name, ("", lambda *_: True)))
            setattr(cls, name, called if part is function else type(part)(called))


def _guarded(
    function: Callable[..., Any], part: str, expected: str, kept: Callable[..., bool], *reads: int
) -> Callable[..., Any]:
    """Return a part of a plug-in's class whose errors become one line, and which keeps its promise."""

    @wraps(function)
    def called(one: Any, /, *given: Any, **more: Any) -> Any:  # noqa: ANN401  (whatever the part takes)
        arguments = (*given, *more.values())
        with contract(one, part, *(arguments[number] for number in reads), code=function):
            answer = function(one, *given, **more)
            if not kept(one, answer, *arguments):
                got = "others" if answer is None else _words_for(answer)
                raise broken(one, part, f"expected {expected.format(one)}, got {got}")
        return answer

    return called


@contextmanager
def contract(owner: object, part: str, *inputs: Any, code: Any = None) -> Iterator[None]:  # noqa: ANN401  (arrays)
    """Let an error of a plug-in's object become one line, and a change of its input arrays an error, and undo it."""
    import numpy as np  # finding names and files takes no numbers

    before = [array.copy() for array in inputs]
    changed = []
    try:
        with errors_in_a_line(_named(owner).__module__, code):
            yield
    finally:
        for array, kept in zip(inputs, before, strict=True):
            if not np.array_equal(array, kept):
                changed.append(array)
                array[:] = kept
    if changed:
        raise broken(owner, part, "expected to change no array that it reads, got a change")


def check_answer(owner: object, part: str, answer: Any, shape: tuple[int, ...]) -> None:  # noqa: ANN401
    """Raise PluginError unless the answer of a plug-in's object is finite numbers of a shape."""
    if not are_numbers(answer, *shape):
        raise broken(owner, part, f"expected finite numbers {shape}, got {_words_for(answer)}")


def are_numbers(answer: Any, *shape: int) -> bool:  # noqa: ANN401
    """Return whether the answer of a plug-in's object is finite numbers of a shape."""
    import numpy as np  # finding names and files takes no numbers

    given = np.asarray(answer)
    return given.shape == shape and given.dtype.kind in "biuf" and bool(np.isfinite(given).all())


def broken(owner: Any, part: str, what: str) -> PluginError:  # noqa: ANN401  (a class, a function, or an object)
    """Return the error of a class, a function or an object of a plug-in that does not keep its contract."""
    named = _named(owner)
    return PluginError(f"{origin_of(named.__module__)}: {named.__name__}{part and f'.{part}'}: {what}")


def _words_for(answer: Any) -> str:  # noqa: ANN401
    """Return in a few words what a plug-in's object has answered."""
    if isinstance(answer, Mapping):
        return ", ".join(f"{name}: {_words_for(value)}" for name, value in answer.items()) or "nothing"
    if not getattr(answer, "shape", ()):
        return reprlib.repr(answer)
    not_finite = answer.dtype.kind == "f" and not are_numbers(answer, *answer.shape)
    return f"{answer.dtype} {answer.shape}" + (" with NaN or infinity" if not_finite else "")


def _named(owner: Any) -> Any:  # noqa: ANN401
    """Return a class or a function as it is, and the class of an object."""
    return owner if hasattr(owner, "__name__") else type(owner)


def _own_files(place: str) -> tuple[Path, ...]:
    """Return the folder of the package that a module belongs to, or its file."""
    if place.startswith(OF_FILE) or place.endswith(".py"):
        return (Path(place.removeprefix(OF_FILE)),)
    top = place.partition(".")[0]
    spec = find_spec(top) if top not in sys.modules or sys.modules[top].__spec__ else None
    if spec is None:
        return ()
    return tuple(map(Path, spec.submodule_search_locations or filter(None, [spec.origin])))


def _module_of_file(path: str) -> ModuleType:
    """Return the module of a file; while it is executed it is where Python looks for names in its annotations."""
    name = f"{OF_FILE}{Path(path).resolve()}"
    if name not in sys.modules:
        spec = spec_from_file_location(name, path)
        assert spec is not None
        assert spec.loader is not None
        module = sys.modules[name] = module_from_spec(spec)
        try:
            spec.loader.exec_module(module)
        except BaseException:
            del sys.modules[name]
            raise
    return sys.modules[name]
