"""Puts the records of the code into ARCHITECTURE.md, between marks: `python -m docs.figures.update_architecture`."""

import inspect
import re
from importlib import import_module

from docs.figures.stored import ROOT, put

PAGE = ROOT / "ARCHITECTURE.md"
PACKAGES = ("selforg", "selector", "clean_swarm_env", "train")


def record_modules() -> list[str]:
    """Return the modules that define a record of compiled code."""
    files = (path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py")))
    found = [
        path for path in files if re.search(r"^\w+.* = Recording\(", path.read_text(encoding="utf-8"), re.MULTILINE)
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


def updated(text: str) -> str:
    """Return the text of the page with the records of the code."""
    return put(text, "records", records())


if __name__ == "__main__":
    PAGE.write_text(updated(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
