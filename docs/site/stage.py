"""Puts the pages of the repository where Sphinx reads them: `build/site/source`, with links that lead on there.

A page keeps its text. Only the targets of its links change: `docs/` is the top of the site, a link to a file that is
no page leads to a copy of the file, and one to a folder leads to a page that lists its files.
"""

import os
import re
from pathlib import Path, PurePosixPath

ROOT = Path(__file__).parents[2]

LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s]+)\)")
FENCED = re.compile(r"(?ms)(^ *```.*?^ *```$)")
ORPHAN = "---\norphan: true\n---\n\n"
"""Head of a page that is in no menu; other pages link to it."""
REPLAYS = ROOT / "docs" / "replays"
"""Where pages lead that `docs.site.replays` makes; they are no files of the repository."""


class Stage:
    """The folder that Sphinx reads; files whose text is as before keep their time, so that Sphinx reads them once."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.kept: set[Path] = set()

    def write(self, name: str, content: str | bytes) -> None:
        """Write a file by its path on the site."""
        path = self.folder / name
        data = content.encode() if isinstance(content, str) else content
        self.kept.add(path)
        if not path.exists() or path.read_bytes() != data:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)

    def page(self, path: Path, before: str = "", after: str = "") -> None:
        """Write a Markdown page of the repository, with more before and after its text."""
        self.write(site_path(path), before + self.linked(path.read_text(encoding="utf-8"), path) + after)

    def linked(self, text: str, path: Path, at: str = "") -> str:
        """Return a text from the page at `path` for a page `at` the site, whose links lead to the same places there."""
        here = at or site_path(path)
        parts = FENCED.split(text)  # texts and fenced code in turn
        parts[::2] = [LINK.sub(lambda found: self._link(found, path, here), part) for part in parts[::2]]
        return "".join(parts)

    def clear(self) -> None:
        """Remove what an earlier build has written and this one has not."""
        for path in sorted(self.folder.rglob("*"), reverse=True):
            if path.is_file() and path not in self.kept:
                path.unlink()
            elif path.is_dir() and not any(path.iterdir()):
                path.rmdir()

    def _link(self, found: re.Match[str], page: Path, here: str) -> str:
        picture, text, target = found.groups()
        file, mark, anchor = target.partition("#")
        if "://" in target or (not file and here == site_path(page)):
            return found[0]
        place = Path(os.path.normpath(page.parent / file)) if file else page
        if place.parent == REPLAYS:
            way = os.path.relpath(site_path(place), PurePosixPath(here).parent)
            return f'<a href="{way}">{text}</a>'
        if not place.exists():
            raise SystemExit(f"{page}: expected a link to a file or a folder that exists, got {target}")
        if place.is_dir():
            place = self._list(place)
        elif place.suffix != ".md":
            self.write(site_path(place), place.read_bytes())
        way = os.path.relpath(site_path(place), PurePosixPath(here).parent)
        return f"{picture}[{text}]({way}{mark}{anchor})"

    def _list(self, folder: Path) -> Path:
        """Write a page that lists the files of a folder; return its place, beside the folder."""
        name = folder.relative_to(ROOT).as_posix()
        page = folder.with_name(f"{folder.name}-files.md")
        files = [path for path in sorted(folder.rglob("*")) if path.is_file() and "__pycache__" not in path.parts]
        links = [
            f"- [`{path.relative_to(folder).as_posix()}`]({path.relative_to(page.parent).as_posix()})" for path in files
        ]
        self.write(site_path(page), ORPHAN + self.linked(f"# {name}\n\n" + "\n".join(links) + "\n", page))
        return page


def site_path(path: Path) -> str:
    """Return the path on the site of a file of the repository."""
    return path.relative_to(ROOT).as_posix().removeprefix("docs/")
