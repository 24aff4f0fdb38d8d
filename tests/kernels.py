"""What compiled code writes, found in its source.

A function writes a record if it assigns to an entry of one of its fields, or hands the field or the whole record to a
function that does. Names stand for the same array after `x = record.field[row]`.
"""

from __future__ import annotations

import ast
import importlib
from collections import defaultdict
from functools import cache
from typing import Any, NamedTuple

from selforg.compiler.records import Recording
from selforg.declared import fields_of
from tests.house import COMPILED, sources

WHOLE = ""
"""Stands for the array itself where a parameter is no record."""
LASTING = {"kept", "clocked", "derived"}


class Kernel(NamedTuple):
    """A compiled function."""

    module: Any
    node: ast.FunctionDef

    @property
    def parameters(self) -> list[str]:
        return [argument.arg for argument in self.node.args.args]

    def resolve(self, name: str) -> Any:
        return getattr(self.module, name, None)


@cache
def kernels() -> dict[str, Kernel]:
    """Return all compiled functions by module and name."""
    found = {}
    for name, tree in sources().items():
        classes = [node for node in tree.body if isinstance(node, ast.ClassDef)]
        inside = [(f"{one.name}.", node) for one in classes for node in one.body]
        for prefix, node in [*(("", node) for node in tree.body), *inside]:
            if isinstance(node, ast.FunctionDef):
                used = {leaf.id for one in node.decorator_list for leaf in ast.walk(one) if isinstance(leaf, ast.Name)}
                if used & (COMPILED | {"register_jitable"}):
                    found[f"{name}.{prefix}{node.name}"] = Kernel(importlib.import_module(name), node)
    return found


class Flow:
    """Where the arrays and records of one kernel come from, and what it does with them."""

    def __init__(self, kernel: Kernel) -> None:
        self.kernel = kernel
        self.opened = {id(recording.open) for recording in Recording.of.values()}
        self.names: dict[str, tuple[str, str]] = {name: (name, WHOLE) for name in kernel.parameters}
        for node in ast.walk(kernel.node):
            if isinstance(node, ast.Assign):
                for target in node.targets:
                    self.note(target, node.value)

    def note(self, target: ast.expr, value: ast.expr) -> None:
        if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
            for one, other in zip(target.elts, value.elts, strict=True):
                self.note(one, other)
        elif isinstance(target, ast.Name) and (source := self.source(value)) is not None:
            self.names[target.id] = source

    def source(self, node: ast.expr) -> tuple[str, str] | None:
        """Return parameter and field of which an expression is a part, None for anything else."""
        if isinstance(node, ast.Subscript):
            return self.source(node.value)
        if isinstance(node, ast.Name):
            return self.names.get(node.id)
        if isinstance(node, ast.Attribute):
            inner = self.source(node.value)
            return (inner[0], node.attr) if inner is not None and node.attr != "shape" else None
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.args:
            opened = id(self.kernel.resolve(node.func.id)) in self.opened
            return self.source(node.args[0]) if opened else None
        return None

    def assigned(self) -> set[tuple[str, str]]:
        """Return what assignments write."""
        found = set()
        for node in ast.walk(self.kernel.node):
            changed = [node.target] if isinstance(node, ast.AugAssign) else []
            targets = node.targets if isinstance(node, ast.Assign) else changed
            for target in targets:
                for one in target.elts if isinstance(target, ast.Tuple) else [target]:
                    if isinstance(one, ast.Subscript) and (source := self.source(one)) is not None:
                        found.add(source)
        return found

    def calls(self) -> list[tuple[str, list[tuple[str, str] | None]]]:
        """Return which compiled functions are called, and with what."""
        found = []
        for node in ast.walk(self.kernel.node):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                called = self.kernel.resolve(node.func.id)
                plain = getattr(called, "py_func", called)
                name = f"{getattr(plain, '__module__', '')}.{getattr(plain, '__name__', '')}"
                if name in kernels():
                    found.append((name, [self.source(argument) for argument in node.args]))
        return found


@cache
def written() -> dict[str, set[tuple[str, str]]]:
    """Return, by kernel, which fields of which parameters it writes, itself or through others."""
    flows = {name: Flow(kernel) for name, kernel in kernels().items()}
    found = {name: flow.assigned() for name, flow in flows.items()}
    calls = {name: flow.calls() for name, flow in flows.items()}
    changed = True
    while changed:
        changed = False
        for name, called in calls.items():
            before = len(found[name])
            for other, arguments in called:
                for parameter, given in zip(kernels()[other].parameters, arguments, strict=False):
                    fields = {field for one, field in found[other] if one == parameter}
                    if given is not None and fields:
                        found[name] |= {(given[0], field if given[1] == WHOLE else given[1]) for field in fields}
            changed |= len(found[name]) > before
    return found


def records_of(kernel: Kernel) -> dict[str, tuple[str, type]]:
    """Return the records that a kernel is given: by parameter, the word of the signature and the class."""
    found = {}
    for argument in kernel.node.args.args:
        hint = argument.annotation
        word = ast.unparse(hint.value) if isinstance(hint, ast.Subscript) else ""
        if word in {"Handle", "Written"}:
            found[argument.arg] = (word, kernel.resolve(ast.unparse(hint.slice)))
    return found


def fields_written() -> dict[str, set[str]]:
    """Return, by record and field, the kernels that write it."""
    found = defaultdict(set)
    for name, fields in written().items():
        records = records_of(kernels()[name])
        for parameter, field in fields:
            if parameter in records and field:
                found[f"{records[parameter][1].__name__}.{field}"].add(name)
    return found


def signatures() -> dict[str, tuple[str, str]]:
    """Return, by kernel and parameter, the word of its signature and the right one."""
    found = {}
    for name, kernel in kernels().items():
        for parameter, (word, kind) in records_of(kernel).items():
            fields = {field for one, field in written()[name] if one == parameter}
            writes = any(fields_of(kind)[field].mark.name in LASTING for field in fields if field in fields_of(kind))
            found[f"{name}({parameter})"] = (word, "Written" if writes else "Handle")
    return found
