"""Random mutants of the core: operators, comparisons, numbers and truth values, each with the tests of its folder.

Texts, annotations, decorators and what is raised stay as they are, as does `strict` of `zip`, which only checks.
"""

import ast
import copy
import random
from collections.abc import Iterator
from functools import cache
from itertools import accumulate
from pathlib import Path

from tests.mutants.mutant import Mutant
from tests.paths import ROOT

CORE = ("selforg", "selector", "clean_swarm_env")
OTHERS: dict[type[ast.AST], type[ast.AST]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.FloorDiv: ast.Mult,
    ast.Mod: ast.Mult,
    ast.BitAnd: ast.BitOr,
    ast.And: ast.Or,
    ast.Or: ast.And,
    ast.Lt: ast.LtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.GtE,
    ast.GtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
}
"""What stands in place of an operator. `|` is left alone: it joins types, too."""
LEFT_OUT = {"annotation", "returns", "decorator_list", "bases", "type_params"}
CHECKS_ONLY = {"strict", "encoding"}
"""Arguments that change no result."""
COMPILED = ("clean_swarm_env", "selector", "selforg/network", "selforg/compiler")
UNCOMPILED = ("clean_swarm_env/physics", "clean_swarm_env/tasks", "selforg/network/planning", "selforg/network/step")
"""Folders whose tests run with compiled code, and those in them whose tests are faster without, as elsewhere."""
ELSEWHERE = {"selector/vocabulary": "tests/selector/configurations"}
"""Folders whose tests lie in another one."""


def draw(count: int, seed: int, root: Path = ROOT) -> list[Mutant]:
    """Return `count` mutants, each as likely as any other, that depend on the seed and the sources."""
    return random.Random(seed).sample(every_mutant(root), count)


@cache
def every_mutant(root: Path) -> list[Mutant]:
    """Return all mutants of the core, by the order of files and lines."""
    files = sorted(path.relative_to(root).as_posix() for package in CORE for path in (root / package).rglob("*.py"))
    return [mutant for file in files for mutant in mutants_of(file, root)]


def mutants_of(file: str, root: Path = ROOT) -> list[Mutant]:
    """Return every mutant of a file of the core."""
    whole = (root / file).read_text(encoding="utf-8")
    lines, tests = whole.splitlines(keepends=True), nearest_tests(file, root)
    compiled = file.startswith(COMPILED) and not tests[0].removeprefix("tests/").startswith(UNCOMPILED)

    begins = [0, *accumulate(map(len, lines))]

    def place(line: int, column: int) -> int:  # the syntax tree counts bytes
        return begins[line - 1] + len(lines[line - 1].encode()[:column].decode())

    found = []
    for node, other in faults(ast.parse(whole)):
        start, end = place(node.lineno, node.col_offset), place(node.end_lineno or 0, node.end_col_offset or 0)
        before, after = whole[start:end], ast.unparse(other)
        if not isinstance(node, ast.Constant | ast.AugAssign):
            after = f"({after})"
        changed = whole[:start].rpartition("\n")[2] + after + whole[end:].partition("\n")[0]
        name = f"line {node.lineno}: `{changed.strip()}`"
        found.append(Mutant(name, file, before, after, tests, start, compiled))
    return found


def faults(node: ast.AST) -> Iterator[tuple[ast.expr | ast.AugAssign, ast.AST]]:
    """Yield what may be another below a node of a syntax tree, and what it becomes."""
    if isinstance(node, ast.JoinedStr | ast.Raise) or (isinstance(node, ast.keyword) and node.arg in CHECKS_ONLY):
        return
    if isinstance(node, ast.Constant) and isinstance(node.value, bool | int | float):
        value = node.value
        yield node, ast.Constant(not value if isinstance(value, bool) else value + 1)
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not | ast.USub):
        yield node, node.operand
    elif isinstance(node, ast.BinOp | ast.BoolOp | ast.AugAssign) and type(node.op) in OTHERS:
        changed = copy.copy(node)
        changed.op = OTHERS[type(node.op)]()
        yield node, changed
    elif isinstance(node, ast.Compare):
        for k, operator in enumerate(node.ops):
            yield node, ast.Compare(node.left, [*node.ops[:k], OTHERS[type(operator)](), *node.ops[k + 1 :]],
                                    node.comparators)  # fmt: skip
    for field, value in ast.iter_fields(node):
        if field not in LEFT_OUT:
            for child in value if isinstance(value, list) else [value]:
                if isinstance(child, ast.AST):
                    yield from faults(child)


def nearest_tests(file: str, root: Path = ROOT) -> tuple[str, ...]:
    """Return the tests in the folder that mirrors that of a file, or the one above, the nearest first."""
    package = Path(file).parent
    folder = root / ELSEWHERE.get(package.as_posix(), f"tests/{package}")
    while not list(folder.glob("test_*.py")):
        folder = folder.parent
    module, parent = ".".join(Path(file).with_suffix("").parts), ".".join(package.parts)

    def distance(path: Path) -> tuple[bool, bool, bool, str]:
        text = path.read_text(encoding="utf-8")
        return path.stem != f"test_{Path(file).stem}", module not in text, parent not in text, path.name

    found = sorted(folder.glob("test_*.py"), key=distance)
    return tuple(path.relative_to(root).as_posix() for path in found)
