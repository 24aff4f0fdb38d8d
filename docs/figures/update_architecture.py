"""Puts layers, steps of a tick and records into ARCHITECTURE.md: `python -m docs.figures.update_architecture`."""

import inspect
import re
import tomllib
from collections import Counter
from importlib import import_module

from docs.figures.stored import ROOT, put
from selforg import program
from selforg.program import Step

PAGE = ROOT / "ARCHITECTURE.md"
PACKAGES = ("selforg", "selector", "clean_swarm_env", "train")
"""From the bottom up."""


def layers() -> str:
    """Return the packages from the top down, each with the layers of its contract in `pyproject.toml`."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = settings["tool"]["importlinter"]["contracts"]
    inside = {name: one["layers"] for one in contracts for name in one.get("containers", ())}
    lines = [
        f"| `{name}` | {' > '.join(inside[name]).replace(' |', ',').replace(' :', ',')} |"
        for name in reversed(PACKAGES)
    ]
    return "\n".join(
        [
            "| package, from the top | its layers, from the top; a comma stands between those beside each other |",
            "|---|---|",
            *lines,
        ]
    )


def record_modules() -> list[str]:
    """Return the modules that define a record of compiled code."""
    files = (path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py")))
    found = [
        path for path in files if re.search(r"^open_\w+.* = opening\(", path.read_text(encoding="utf-8"), re.MULTILINE)
    ]
    return [".".join(path.relative_to(ROOT).with_suffix("").parts) for path in found]


def records() -> str:
    """Return the records of compiled code as a Markdown table."""
    from selforg.compiler.records import Recording

    for name in record_modules():
        import_module(name)
    lines = ["| record | what it holds | fields | file |", "|---|---|---|---|"]
    ours = [kind for kind in Recording.of if kind.__module__.partition(".")[0] in PACKAGES]
    for kind in sorted(ours, key=lambda kind: (PACKAGES.index(kind.__module__.partition(".")[0]), kind.__module__)):
        said = " ".join((inspect.getdoc(kind) or "").partition("\n\n")[0].split())
        file = kind.__module__.replace(".", "/") + ".py"
        lines.append(f"| `{kind.__name__}` | {said} | {len(kind._fields)} | `{file}` |")
    return "\n".join(lines)


def stages() -> dict[int, str]:
    """Return the names of the stages of a tick, in their order."""
    named = {value: name for name, value in vars(program).items() if name.isupper() and isinstance(value, int)}
    return {number: named[number] for number in sorted(named)}


def steps() -> str:
    """Return the steps of a tick of `table1` as a Markdown table, equal ones of a stage once."""
    from clean_swarm_env.learning.batch import Batch

    batch, named = Batch("table1"), stages()
    found = Counter((named[step.stage], *where(step)) for step in batch.program.steps)
    lines = ["| stage | step | file | |", "|---|---|---|---|"]
    for (stage, name, file, kind), times in found.items():
        lines.append(f"| {stage} | `{name}` | `{file}` | {kind}{f', {times} times' if times > 1 else ''} |")
    return "\n".join(lines)


def where(step: Step) -> tuple[str, str, str]:
    """Return the name of a step, its file, and whether it is a kernel."""
    function = getattr(step.kernel, "py_func", step.kernel) or step.python
    code = inspect.unwrap(function).__code__
    name = code.co_name if step.kernel else code.co_qualname.partition(".<locals>")[0].rpartition(".")[2]
    file = code.co_filename.removeprefix(f"{ROOT}/")
    return name, file, "kernel" if step.kernel else "Python"


def updated(text: str) -> str:
    """Return the text of the page with the layers, the steps of a tick and the records of the code."""
    return put(put(put(text, "layers", layers()), "steps", steps()), "records", records())


if __name__ == "__main__":
    PAGE.write_text(updated(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
