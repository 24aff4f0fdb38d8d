"""Builds the site: `make docs` runs it behind `docs.site.replays`. Writes build/site/html; needs the extra `docs`.

The pages are the Markdown pages of the repository, and those that `catalogue` and `api` make of what the code knows.
A warning is an error. Nothing is asked of the network.
"""

import os
import re
import shutil
import sys
from pathlib import Path

from docs.site.api import API, write_api
from docs.site.catalogue import CATALOGUE, write_catalogue
from docs.site.keys import page as page_of_keys
from docs.site.stage import REPLAYS, ROOT, Stage, site_path

BUILD = ROOT / "build" / "site"
GROUPS = {
    "Tutorials": tuple(
        f"tutorials/{name}" for name in ("advise", "see", "learn", "selector", "mechanism", "task", "mind")
    ),
    "Do": (
        "README", "commands", "keys", "play", "recordings", "environment", "tasks", "own_task", "own_plugins",
        "learning", "strategies", "knowledge", "clusters", "robots",
    ),
    "Understand": (
        "ARCHITECTURE", "glossary", "selector", "network", "walls", "models", "transport", "families",
        "paper", "quirks", "versions", "compared",
    ),
    "Results": (
        "results", "choosing", "protocol", "benchmarks",
    ),
    "Reference": CATALOGUE,
    "API": API,
    "Project": ("CONTRIBUTING", "CHANGELOG", "decisions/README"),
}  # fmt: skip
"""Part of the menu -> its pages."""
HOW_IT_CAME = "---\nnosearch: true\n---\n\n"
"""Head of pages on the project itself: whoever searches wants what holds, not how it came."""
RECORD = HOW_IT_CAME.replace("---\n", "---\norphan: true\n", 1)
"""Head of the page of a decision."""

FOUND = {
    "environment": ("reward", "action space", "observation", "PettingZoo", "vector environment", "Gymnasium", "cost"),
    "results": ("Table 1", "robustness", "disturbance"),
    "families": ("family", "headroom"),
    "strategies": ("state machine", "bandit", "policy"),
    "walls": ("walls", "lidar", "zones", "collision"),
    "selector": ("sensor", "action", "knowledge", "pheromone", "gradient", "mechanism"),
    "own_plugins": ("plug-in", "plugin"),
    "recordings": ("recording", "replay"),
    "models": ("robot model", "heterogeneous"),
    "own_task": ("own task", "own mission"),
    "robots": ("ROS 2", "real robot"),
}
"""Page -> words whose search leads to it first."""


def sources() -> list[Path]:
    """Return the Markdown pages of the repository."""
    return [*sorted(ROOT.glob("*.md")), *sorted((ROOT / "docs").rglob("*.md"))]


def unnamed() -> tuple[str, ...]:
    """Return the pages that no part of the menu names; records of decisions are linked from their own page."""
    named = {name for names in GROUPS.values() for name in names} | {"index"}
    pages = (site_path(path).removesuffix(".md") for path in sources())
    return tuple(page for page in pages if page not in named and not page.startswith("decisions/"))


def menu() -> str:
    """Return the menu, for the end of the first page."""
    parts = [
        "\n".join((f"```{{toctree}}\n:caption: {name}\n:hidden:\n:maxdepth: 1\n", *pages, "```\n"))
        for name, pages in {**GROUPS, "More": unnamed()}.items()
        if pages
    ]
    return "\n" + "\n".join(parts)


def records() -> str:
    """Return a list of all decisions by their titles, for the end of their page."""
    files = sorted((ROOT / "docs" / "decisions").glob("[0-9]*.md"))
    titles = [path.read_text(encoding="utf-8").partition("\n")[0].removeprefix("# ") for path in files]
    return "\n" + "".join(f"- [{title}]({path.name})\n" for title, path in zip(titles, files, strict=True))


LARGEST = 25_000_000
"""Most bytes of the site."""
OUTSIDE = r"[\"']?(?:https?:)?//[^\"'> )]+"
LOADED = re.compile(
    rf"<(?:script|img|iframe|source|video)\b[^>]*\bsrc={OUTSIDE}|<link\b[^>]*\bhref={OUTSIDE}"
    rf"|url\({OUTSIDE}|@import {OUTSIDE}"
)
"""What makes a browser ask another machine for something; links that a reader follows do not."""


def faults(folder: Path) -> list[str]:
    """Return what is wrong with a site: files that load something from outside, and its size."""
    found = []
    for path in sorted(folder.rglob("*")):
        if path.suffix in (".html", ".css"):
            for load in LOADED.findall(path.read_text(encoding="utf-8")):
                found.append(f"{path.relative_to(folder)}: loads from outside: {load}")
    size = sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())
    if size > LARGEST:
        found.append(f"{folder}: expected at most {LARGEST} bytes, got {size}")
    return found


def main() -> int:
    """Build the site; return 1 if it is wrong, else the code of Sphinx."""
    from sphinx.cmd.build import main as sphinx

    stage, html = Stage(BUILD / "source"), BUILD / "html"
    for path in sources():
        record = path.parent.name == "decisions" and path.name != "README.md"
        own = site_path(path).removesuffix(".md") in GROUPS["Project"]
        words = FOUND.get(site_path(path).removesuffix(".md"), ())
        index = f"```{{index}} {', '.join(f'! {word}' for word in words)}\n```\n\n" if words else ""
        before = RECORD if record else HOW_IT_CAME if own else index
        after = {"index.md": menu, "decisions/README.md": records}.get(site_path(path), str)
        stage.page(path, before, after())
    stage.write("keys.md", page_of_keys())
    write_api(stage)
    write_catalogue(stage)
    stage.clear()
    settings = str(ROOT / "docs" / "site")
    words = ["-q", "-W", "--keep-going", "-j", "2", "-b", "html", "-d", str(BUILD / "doctrees"), "-c", settings]
    code = sphinx([*words, str(stage.folder), str(html)])
    shutil.copytree(BUILD / REPLAYS.name, html / REPLAYS.name, dirs_exist_ok=True)  # Sphinx would offer to save them
    wrong = faults(html) if code == 0 else []
    for line in wrong:
        print(line, file=sys.stderr)
    if code == 0:
        print(f"{html / 'index.html'}: {sum(os.times()[:4]):.0f} s of CPU")
    return 1 if wrong else code


if __name__ == "__main__":
    sys.exit(main())
