"""Pages of the API: what the three packages of the library export, by the docstrings.

A package exports what its `__init__` imports under its own name (`from x import A as A`).
"""

import ast
import inspect
from importlib import import_module

from docs.site.stage import ROOT, Stage

PLACES = {
    "clean_swarm_env": "What a program needs: environments by configuration, families, observations and rewards.",
    "clean_swarm_env.tasks": "What a task of your own needs.",
    "selforg.mechanisms": "Mechanisms, and what one of your own is derived from.",
    "selforg.components": "Sensors, actions and sources: the parts of a robot that run mechanisms.",
    "selector.store": "The store of scores.",
}
"""Package that exports names -> what they are for."""
WHOLE = {
    "environments": (
        "Environments",
        "Classes for each library of learning; `stable_baselines3` needs the extra `train`.",
        ("clean_swarm_env.clean_swarm_v0", "clean_swarm_env.registration", "clean_swarm_env.wrappers",
         "clean_swarm_env.sb3", "clean_swarm_env.borders.gymnasium_team", "clean_swarm_env.borders.gymnasium_vector"),
    ),
    "strategies": (
        "Strategies",
        "The base class of strategies, what they get and what they return.",
        ("selector.strategies.strategy", "selector.strategies.problem", "selector.strategies.registry"),
    ),
}  # fmt: skip
"""Page -> its title, what it has, and the modules all of whose public names it shows."""
API = tuple(f"api/{name}" for name in (*WHOLE, *PLACES))


def write_api(stage: Stage) -> None:
    """Write all pages of the API."""
    for page, (title, about, modules) in WHOLE.items():
        parts = [heading(title, "="), about, ""]
        for module in modules:
            parts += [heading(f"``{module}``", "-"), f".. automodule:: {module}\n   :members:\n   :show-inheritance:\n"]
        stage.write(f"api/{page}.rst", "\n".join(parts))
    for package, about in PLACES.items():
        parts = [heading(f"``{package}``", "="), about, "", f"Import these names from ``{package}``.", ""]
        parts += [documented(module, name) for name, module in sorted(exports(package).items())]
        stage.write(f"api/{package}.rst", "\n".join(parts))


def exports(package: str) -> dict[str, str]:
    """Return name -> module that defines it, of what a package exports."""
    tree = ast.parse(ROOT.joinpath(*package.split("."), "__init__.py").read_text(encoding="utf-8"))
    found = (node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and node.module)
    return {alias.name: str(node.module) for node in found for alias in node.names if alias.asname == alias.name}


def documented(module: str, name: str) -> str:
    """Return the directive that shows one name by its docstring."""
    value = getattr(import_module(module), name)
    kind = "class" if inspect.isclass(value) else "function" if inspect.isfunction(value) else "data"
    more = "   :members:\n   :show-inheritance:\n" if kind == "class" else ""
    return f"{heading(name, '-')}\n.. auto{kind}:: {module}.{name}\n{more}"


def heading(text: str, line: str) -> str:
    """Return a heading of reStructuredText."""
    return f"{text}\n{line * len(text)}\n"
