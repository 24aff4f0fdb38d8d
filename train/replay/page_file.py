"""The replay page: one file with recordings, styles and scripts, which needs no network.

The scripts are plain modules of JavaScript below `page/`. They are joined when a page is written: the lines with
imports are left out, and `export` before a declaration. So no name may be declared in two modules.
"""

import base64
import html
import re
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path

from clean_swarm_env.recording.reader import RecordedMission
from selector.documents.writing import write_whole

MODULES = ("recording", "course", "world", "mind", "charts", "page")
"""The modules in the order in which they are joined: each imports earlier ones only."""


def write_page(recordings: Sequence[RecordedMission], output: Path) -> None:
    """Write the page of one recording, or of two side by side.

    Raises:
        DocumentError: the file cannot be written.

    """
    write_whole(output, page_of(recordings).encode())


def page_of(recordings: Sequence[RecordedMission]) -> str:
    """Return the page as HTML."""
    folder = files("train.replay") / "page"
    held = [base64.b64encode(recording.path.read_bytes()).decode() for recording in recordings]
    abouts = [recording.head["about"] for recording in recordings]
    parts = {
        "title": "Clean Swarm: " + html.escape(" beside ".join(str(about.get("condition", "")) for about in abouts)),
        "style": (folder / "page.css").read_text(encoding="utf-8"),
        "recordings": "\n".join(f'<script type="text/plain">{text}</script>' for text in held),
        "script": joined([(folder / f"{name}.js").read_text(encoding="utf-8") for name in MODULES]),
    }
    template = (folder / "page.html").read_text(encoding="utf-8")
    return re.sub(r"\{(title|style|recordings|script)\}", lambda match: parts[match[1]], template)


def joined(modules: Sequence[str]) -> str:
    """Return modules as one script."""
    plain = (re.sub(r"^import [^;]*;\n", "", module, flags=re.MULTILINE) for module in modules)
    return "\n".join(re.sub(r"^export ", "", module, flags=re.MULTILINE) for module in plain)
