"""Looks at the structure of the code: circles of imports, sizes of folders, names and signatures.

Circles count every import, inside functions and under TYPE_CHECKING too. A name counts as defined twice if two packages
define it at the top of a module; which of those mean the same is for the reader to say (`SAME_MEANING`).
"""

from __future__ import annotations

import ast
from collections import Counter, defaultdict
from collections.abc import Iterator
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

from tests.paths import ROOT

PACKAGES = ("selforg", "selector", "clean_swarm_env", "train")
COMPILED = {"kernel", "lean_kernel", "long_kernel", "part", "inlined", "template"}
MOST_COMPILED, MOST_PLAIN, MOST_MODULES = 8, 6, 15
SAME_MEANING = {"app"}
"""Names that several modules may define: each file of commands has its `app`."""
RETIRED = {
    "begin": "reset, start, open or the verb of what is done",
    "take": "record, apply, read, collect or the verb of what is done",
    "see": "gather, write_row or the verb of what is done",
    "told": "the verb of what is done",
    "lasting": "nothing: classes declare what is kept, see selforg.arrays",
    "restore": "nothing: what follows from the rest is declared as derived, see selforg.arrays",
    "steered": "driven: a learner drives, a mechanism steers",
}
"""Words that had too many meanings in names of functions, methods and fields: what to say instead."""


@cache
def sources(root: Path = ROOT) -> dict[str, ast.Module]:
    """Return the syntax trees of all modules by their dotted names."""
    files = (path for package in PACKAGES for path in sorted((root / package).rglob("*.py")))
    return {name_of(path, root): ast.parse(path.read_text(encoding="utf-8")) for path in files}


def name_of(path: Path, root: Path) -> str:
    """Return the dotted name of a module; a package has the name of its folder."""
    parts = path.relative_to(root).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imports(root: Path = ROOT) -> dict[str, set[str]]:
    """Return which of our modules each module imports, anywhere in it."""
    modules = sources(root)
    graph: dict[str, set[str]] = {name: set() for name in modules}
    for name, tree in modules.items():
        for node in ast.walk(tree):
            if isinstance(node, ast.Import):
                graph[name] |= {alias.name for alias in node.names if alias.name in modules}
            elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module in modules:
                for alias in node.names:
                    inner = f"{node.module}.{alias.name}"
                    graph[name].add(inner if inner in modules else node.module)
        graph[name].discard(name)
    return graph


def circle(root: Path = ROOT) -> list[str]:
    """Return modules that import each other, directly or not; none if there is no circle."""
    try:
        TopologicalSorter(imports(root)).prepare()
    except CycleError as error:
        return sorted(set(error.args[1]))
    return []


def modules_in_folders(root: Path = ROOT, packages: tuple[str, ...] = PACKAGES) -> Counter[str]:
    """Return how many modules lie directly in each folder, `__init__` not counted."""
    files = (path for package in packages for path in (root / package).rglob("*.py") if path.name != "__init__.py")
    return Counter(path.parent.relative_to(root).as_posix() for path in files)


def definitions(tree: ast.Module) -> Iterator[str]:
    """Yield the names that a module defines at its top."""
    for node in tree.body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            yield node.name
        elif isinstance(node, ast.Assign):
            yield from (leaf.id for target in node.targets for leaf in ast.walk(target) if isinstance(leaf, ast.Name))
        elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            yield node.target.id


def names_defined_twice(root: Path = ROOT) -> dict[str, list[str]]:
    """Return the public names that more than one package defines, with the modules that do."""
    where: dict[str, set[str]] = defaultdict(set)
    for module, tree in sources(root).items():
        for name in definitions(tree):
            if not name.startswith("_") and name not in SAME_MEANING:
                where[name].add(module)
    return {
        name: sorted(modules)
        for name, modules in sorted(where.items())
        if len({module.partition(".")[0] for module in modules}) > 1
    }


def retired_names(root: Path = ROOT) -> dict[str, str]:
    """Return the functions, methods and fields with a retired word in their name, and what to say instead."""
    found = []
    for module, tree in sources(root).items():
        found += [(module, owner, function.name) for function, owner in functions(tree)]
        for cls in (node for node in ast.walk(tree) if isinstance(node, ast.ClassDef)):
            fields = (node.target for node in cls.body if isinstance(node, ast.AnnAssign))
            found += [(module, cls.name, field.id) for field in fields if isinstance(field, ast.Name)]
    return {
        ".".join(filter(None, names)): RETIRED[word]
        for names in found
        for word in names[-1].split("_")
        if word in RETIRED
    }


def long_signatures(root: Path = ROOT) -> list[tuple[str, int]]:
    """Return the functions with more arguments than a reader keeps in mind, longest first.

    Arguments that can only be given by name cannot be mixed up: all of them count as one. Commands of the command line
    (`_command`, or with a decorator) are left out, their arguments are the user's options.
    """
    found = []
    for module, tree in sources(root).items():
        for function, owner in functions(tree):
            arguments = [*function.args.posonlyargs, *function.args.args]
            count = len(arguments) + bool(function.args.kwonlyargs)
            count -= owner is not None and arguments[:1] != [] and arguments[0].arg in {"self", "cls"}
            decorators = {
                leaf.id for node in function.decorator_list for leaf in ast.walk(node) if isinstance(leaf, ast.Name)
            }
            most = MOST_COMPILED if decorators & COMPILED else MOST_PLAIN
            chosen_by_users = function.name.endswith("_command") or decorators
            if count > most and not (module.startswith("train.cli.") and chosen_by_users):
                found.append((".".join(filter(None, (module, owner, function.name))), count))
    return sorted(found, key=lambda pair: -pair[1])


def functions(node: ast.AST, owner: str | None = None) -> Iterator[tuple[ast.FunctionDef, str | None]]:
    """Yield all functions inside, with the name of the class around a method."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.FunctionDef):
            yield child, owner
        inside = (
            child.name if isinstance(child, ast.ClassDef) else None if isinstance(child, ast.FunctionDef) else owner
        )
        yield from functions(child, inside)
