"""Objects of the user's own Python code by their names, `module:name` or `path/to/file.py:name`.

`trust.py` says which of these names may be used, and `selforg.plugins` imports their modules.
"""

from importlib.machinery import PathFinder
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated, Any

from pydantic import AfterValidator, Field

from selector.documents.errors import DocumentError
from selector.documents.fields import as_name
from selector.documents.plain import must_fit, short
from selector.documents.trust import check_trust, is_import
from selforg import plugins
from selforg.registry import Registry

NameOrImport = Annotated[
    str,
    Field(strict=True),
    AfterValidator(lambda text: _check_import(text) if is_import(text) else as_name(text)),
]
"""A registered name, or one of the user's own code."""


def registered(text: str, registry: Registry[Any]) -> str:
    """Return the name under which a class is registered, given that name or `module:Class`.

    Raises:
        DocumentError: nothing has the name, or there is no such class.

    """
    if is_import(text):
        found = imported(text, registry.kind)
        must_fit(found in list(registry), text, f"a registered {registry.kind}", short(found))
        plugins.import_named(text.rpartition(":")[0])  # workers look the class up by its registered name
        return registry.name_of(found)
    if text not in registry:
        raise DocumentError(registry.unknown(text))
    return text


def _check_import(text: str, where: str = "") -> str:
    """Return a name of the user's own code; DocumentError if only a file asks for it."""
    place = text.rpartition(":")[0]
    if not plugins.is_named(place):
        check_trust(text, f"import {text}", where, f"--import {place} (imports= in Python) allows it, ")
    return text


def imported(text: str, where: str) -> Any:  # noqa: ANN401  (whatever the user's code defines)
    """Return the object of a name; modules are also looked for in the working directory.

    Raises:
        DocumentError: there is no such module or object; `where` starts the line.

    """
    must_fit(is_import(text), where, "module:name or path/to/file.py:name", repr(text))
    _check_import(text, f"{where}: ")
    place, _, name = text.rpartition(":")
    try:
        module = plugins.module_of(plugins.module_or_file(place))
    except plugins.PluginError as error:
        raise DocumentError(f"{where}: {error}") from error
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
