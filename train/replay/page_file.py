"""The replay page: one file with recordings, styles and scripts, which needs no network.

The scripts are plain modules of JavaScript below `page/`. They are joined when a page is written: the lines with
imports are left out, and `export` before a declaration. So no name may be declared in two modules.
"""

import base64
import html
import json
import re
from collections.abc import Sequence
from dataclasses import asdict
from importlib.resources import files
from pathlib import Path

from clean_swarm_env.drawing.look import LOOK, SIGN_OF
from clean_swarm_env.recording.reader import RecordedMission
from selector.documents.writing import write_whole
from train.running.needs import check_file

MODULES = (
    "recording", "words", "course", "look", "floor", "robots", "world", "score", "why", "policy", "mind", "charts",
    "pointer", "foretold", "controls", "layers", "page", "live", "start",
)  # fmt: skip
"""The modules in the order in which they are joined: each imports earlier ones only."""


def write_page(recordings: Sequence[RecordedMission], output: Path) -> None:
    """Write the page of one recording, or of two side by side.

    Raises:
        DocumentError: the file cannot be written.
        ConfigurationError: the page needs more memory or room than there is.

    """
    held = sum(recording.path.stat().st_size for recording in recordings)
    check_file(output, held, f"a page of {held:,} bytes", "`picture` and `video` need less")
    write_whole(output, page_of(recordings).encode())


def page_of(recordings: Sequence[RecordedMission]) -> str:
    """Return the page of recordings as HTML; see `write_page`."""
    held = [base64.b64encode(recording.path.read_bytes()).decode() for recording in recordings]
    title = " beside ".join(str(recording.head["about"].get("condition", "")) for recording in recordings)
    parts = [f'<script type="text/plain">{text}</script>' for text in held]
    return _page(title, "\n".join(parts), "'none'")


def live_page() -> str:
    """Return the page of sessions as HTML; it asks the server that it comes from for the frames."""
    return _page("live", '<div id="live" hidden></div>', "'self'")


def _page(title: str, content: str, asked: str) -> str:
    """Return the page with its content; it may connect to `asked`, a source of a content security policy."""
    folder = files("train.replay") / "page"
    signs = {name: asdict(sign) for name, sign in SIGN_OF.items()}
    colours = {
        "ink": LOOK.ink,
        "paper": LOOK.paper,
        "faint": LOOK.edge,
        "wrong": LOOK.contact,
        "due": LOOK.options[0],
    }
    parts = {
        "title": f"Clean Swarm: {html.escape(title)}",
        "asked": asked,
        "look": json.dumps(asdict(LOOK) | {"signs": signs}),
        "colours": "; ".join(f"--{name}: {colour}" for name, colour in colours.items()),
        "style": (folder / "page.css").read_text(encoding="utf-8"),
        "content": content,
        "script": joined([(folder / f"{name}.js").read_text(encoding="utf-8") for name in MODULES]),
    }
    template = (folder / "page.html").read_text(encoding="utf-8")
    return re.sub(r"\{(title|asked|look|colours|style|content|script)\}", lambda match: parts[match[1]], template)


def joined(modules: Sequence[str]) -> str:
    """Return modules as one script."""
    plain = (re.sub(r"^import [^;]*;\n", "", module, flags=re.MULTILINE) for module in modules)
    return "\n".join(re.sub(r"^export ", "", module, flags=re.MULTILINE) for module in plain)
