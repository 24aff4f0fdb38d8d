"""Objects of the user's own Python code by their names, `module:name` or `path/to/file.py:name`."""

import sys
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Annotated, Any

from pydantic import AfterValidator, Field

from selector.documents.errors import DocumentError
from selector.documents.fields import as_name


def is_import(text: str) -> bool:
    """Return whether a text has the form of a name of the user's own code."""
    module, colon, name = text.rpartition(":")
    return bool(colon) and name.isidentifier() and (module.endswith(".py") or module.replace(".", "_").isidentifier())


NameOrImport = Annotated[
    str, Field(strict=True), AfterValidator(lambda text: text if is_import(text) else as_name(text))
]
"""Name of what is registered, or of the user's own code."""


def imported(text: str, where: str) -> Any:  # noqa: ANN401  (whatever the user's code defines)
    """Return the object of a name; modules are also looked for in the working directory.

    Raises:
        DocumentError: there is no such module or object; `where` starts the line.

    """
    if not is_import(text):
        raise DocumentError(f"{where}: expected module:name or path/to/file.py:name, got {text!r}")
    place, _, name = text.rpartition(":")
    if not place.endswith(".py") and str(Path.cwd()) not in sys.path:
        sys.path.append(str(Path.cwd()))
    try:
        module = _of_file(Path(place)) if place.endswith(".py") else import_module(place)
    except (ImportError, FileNotFoundError) as error:
        raise DocumentError(f"{where}: {place}: {error}") from error
    if not hasattr(module, name):
        raise DocumentError(f"{where}: {place} defines no {name!r}")
    return getattr(module, name)


def _of_file(path: Path) -> Any:  # noqa: ANN401  (a module)
    """Return the module of a file, executed once in a process."""
    name = f"file {path.resolve()}"
    if name not in sys.modules:
        spec = spec_from_file_location(name, path)
        assert spec is not None
        assert spec.loader is not None
        module = module_from_spec(spec)
        spec.loader.exec_module(module)
        sys.modules[name] = module
    return sys.modules[name]
