"""Objects of the user's own Python code by their names, `module:name` or `path/to/file.py:name`.

`trust.py` says which of these names may be used.
"""

import sys
from importlib import import_module
from importlib.machinery import PathFinder
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Annotated, Any

from pydantic import AfterValidator, Field

from selector.documents.errors import DocumentError
from selector.documents.fields import as_name
from selector.documents.trust import check_trust


def is_import(text: str) -> bool:
    """Return whether a text has the form of a name of the user's own code."""
    module, colon, name = text.rpartition(":")
    return bool(colon) and name.isidentifier() and (module.endswith(".py") or module.replace(".", "_").isidentifier())


NameOrImport = Annotated[
    str,
    Field(strict=True),
    AfterValidator(lambda text: check_trust(text, f"import {text}") if is_import(text) else as_name(text)),
]
"""A registered name, or one of the user's own code."""


def imported(text: str, where: str) -> Any:  # noqa: ANN401  (whatever the user's code defines)
    """Return the object of a name; modules are also looked for in the working directory.

    Raises:
        DocumentError: there is no such module or object; `where` starts the line.

    """
    if not is_import(text):
        raise DocumentError(f"{where}: expected module:name or path/to/file.py:name, got {text!r}")
    check_trust(text, f"import {text}", f"{where}: ")
    place, _, name = text.rpartition(":")
    if not place.endswith(".py") and str(Path.cwd()) not in sys.path:
        sys.path.append(str(Path.cwd()))
    try:
        module = module_of_file(Path(place)) if place.endswith(".py") else import_module(place)
    except (ImportError, FileNotFoundError) as error:
        raise DocumentError(f"{where}: {place}: {error}") from error
    if not hasattr(module, name):
        raise DocumentError(f"{where}: {place} defines no {name!r}")
    return getattr(module, name)


def source_of(text: str, where: str) -> Path:
    """Return the file of the module in a name of the user's own code, without running any of it.

    Raises:
        DocumentError: there is no such file; `where` starts the line.

    """
    place = text.rpartition(":")[0]
    top, *below = place.split(".")
    spec = None if place.endswith(".py") else find_spec(top) or PathFinder.find_spec(top, [str(Path.cwd())])
    for part in below if spec else ():
        spec = PathFinder.find_spec(part, spec.submodule_search_locations or []) if spec else None
    found = Path(spec.origin or "" if spec else place)
    if not (found.is_file() and found.suffix == ".py"):
        raise DocumentError(f"{where}: {place}: no such file of Python code")
    return found


def module_of_file(path: Path) -> Any:  # noqa: ANN401  (a module)
    """Return the module of a file, executed once in a process.

    While it is executed it is among the modules, where Python looks for the names in its annotations.
    """
    name = f"file {path.resolve()}"
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
