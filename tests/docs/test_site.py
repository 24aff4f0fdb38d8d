"""The site: each name of `clean-swarm list` has a page, links lead to their places, and nothing comes from outside."""

import pytest

pytest.importorskip("sphinx", reason="needs the extra 'docs'")

from docs.site.api import API, PLACES, exports, write_api
from docs.site.build import faults, menu, sources
from docs.site.catalogue import write_catalogue
from docs.site.stage import ROOT, Stage, site_path
from train.cli.listing import LINES, names_of

pytestmark = pytest.mark.extra


@pytest.fixture(scope="module")
def stage(tmp_path_factory):
    """The generated pages."""
    stage = Stage(tmp_path_factory.mktemp("source"))
    write_catalogue(stage)
    write_api(stage)
    return stage


@pytest.mark.parametrize("kind", LINES)
def test_each_name_that_list_shows_has_a_page(stage, kind):
    names = names_of(kind, ())
    overview = (stage.folder / "names" / kind / "index.md").read_text(encoding="utf-8")
    for name in names:
        page = stage.folder / "names" / kind / f"{name}.md"
        assert f"# {name}\n" in page.read_text(encoding="utf-8")
        assert f"[{name}]({name}.md)" in overview


def test_the_menu_has_each_page_once():
    listed = [line for line in menu().splitlines() if line and not line.startswith((":", "`"))]
    pages = [site_path(path).removesuffix(".md") for path in sources()]
    assert sorted(set(listed)) == sorted(listed)
    assert {page for page in pages if not page.startswith("decisions/") and page != "index"} <= set(listed)


def test_the_api_shows_every_export(stage):
    for package in PLACES:
        text = (stage.folder / "api" / f"{package}.rst").read_text(encoding="utf-8")
        names = exports(package)
        assert names
        assert all(f".{name}\n" in text for name in names)
    assert {f"{page}.rst" for page in API} <= {
        path.relative_to(stage.folder).as_posix() for path in stage.folder.rglob("*.rst")
    }


def test_links_lead_to_the_same_places(tmp_path):
    stage, page = Stage(tmp_path), ROOT / "docs" / "play.md"
    text = (
        "[a](../ARCHITECTURE.md#layers) [b\nc](decisions/README.md) ![d](pictures/world.png) "
        "[e](../examples/own_task.py)\n"
        "[f](replay.html) [g](https://example.org) [h](#here) [i](../examples/plugin)\n\n"
        "```python\n[x](../ARCHITECTURE.md)\n```\n"
    )
    linked = stage.linked(text, page)
    assert linked == (
        "[a](ARCHITECTURE.md#layers) [b\nc](decisions/README.md) ![d](pictures/world.png) [e](examples/own_task.py)\n"
        '<a href="replay.html">f</a> [g](https://example.org) [h](#here) [i](examples/plugin-files.md)\n\n'
        "```python\n[x](../ARCHITECTURE.md)\n```\n"
    )
    assert {"pictures/world.png", "examples/own_task.py", "replay.html", "examples/plugin-files.md"} <= {
        path.relative_to(tmp_path).as_posix() for path in stage.kept
    }
    assert stage.linked("[h](#here)", page, "names/tasks/A.md") == "[h](../../play.md#here)"


@pytest.mark.parametrize(
    "text",
    [
        '<script src="https://cdn.example.org/x.js"></script>',
        "<img alt='' src='//example.org/x.png'>",
        '<link rel="stylesheet" href="https://fonts.example.org/css">',
        "body { background: url(https://example.org/x.png) }",
        "@import 'https://example.org/x.css';",
    ],
)
def test_what_a_page_loads_from_outside_is_found(tmp_path, text):
    (tmp_path / "x.html").write_text(text)
    assert len(faults(tmp_path)) == 1
