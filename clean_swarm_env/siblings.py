"""The top-level packages beside this one, found by their place and not by the order of `sys.path`.

`selector` and `train` are plain words: a file of that name next to a user's script would otherwise be imported instead
of ours (docs/decisions/0080-own-siblings.md).
"""

import sys
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

HOME = Path(__file__).resolve().parents[1]
"""The directory of all our packages: a checkout, or `site-packages`."""


def own(name: str) -> None:
    """Import a top-level package of ours, unless it is imported already.

    Raises:
        ImportError: another module of this name is imported already.

    """
    place = HOME / name
    if name in sys.modules:
        loaded = sys.modules[name]
        places = list(getattr(loaded, "__path__", ()))
        if place not in [Path(path).resolve() for path in places]:
            found = getattr(loaded, "__file__", None) or places
            raise ImportError(f"{name}: expected the package {place}, got {found}; import clean_swarm_env before it")
        return
    spec = spec_from_file_location(name, place / "__init__.py", submodule_search_locations=[str(place)])
    if spec is None or spec.loader is None:
        raise ImportError(f"{place}: no such package")
    sys.modules[name] = module_from_spec(spec)
    spec.loader.exec_module(sys.modules[name])


def call(module: str, function: str, *arguments: object) -> object:
    """Call a function of a module in a package of ours, and return what it returns."""
    own(module.partition(".")[0])
    return getattr(import_module(module), function)(*arguments)
