"""The site: each name of `clean-swarm list` has a page, links lead to their places, and nothing comes from outside."""

import shutil

import pytest

pytest.importorskip("sphinx", reason="needs the extra 'docs'")

from sphinx.cmd.build import main as sphinx

from docs.site.api import API, PLACES, exports, write_api
from docs.site.build import FOUND, faults, menu, sources
from docs.site.catalogue import write_catalogue
from docs.site.conf import html_js_files
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
        "[a](../ARCHITECTURE.md#layers) [b\nc](decisions/README.md) ![d](pictures/scouts.png) "
        "[e](../examples/own_task.py)\n"
        "[f](replays/scouts.html) [g](https://example.org) [h](#here) [i](../examples/plugin)\n\n"
        "```python\n[x](../ARCHITECTURE.md)\n```\n"
    )
    linked = stage.linked(text, page)
    assert linked == (
        "[a](ARCHITECTURE.md#layers) [b\nc](decisions/README.md) ![d](pictures/scouts.png) [e](examples/own_task.py)\n"
        '<a href="replays/scouts.html">f</a> [g](https://example.org) [h](#here) [i](examples/plugin-files.md)\n\n'
        "```python\n[x](../ARCHITECTURE.md)\n```\n"
    )
    assert {"pictures/scouts.png", "examples/own_task.py", "examples/plugin-files.md"} <= {
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


@pytest.mark.page
def test_search_answers_where_the_site_is_opened_as_a_file(tmp_path):
    """It finds the words that lead to a page first; where the browser forbids pages of files to search, it says so."""
    playwright = pytest.importorskip("playwright.sync_api")
    if (chromium := shutil.which("chromium")) is None:
        pytest.skip("needs Chromium")
    assert {"own task", "own mission"} <= set(FOUND["own_task"])
    static = ROOT / "docs" / "site" / "static"
    (tmp_path / "conf.py").write_text(
        f"extensions, html_theme = ['myst_parser'], 'furo'\nhtml_static_path = [{str(static)!r}]\n"
        f"html_js_files = {html_js_files}\n"
    )
    (tmp_path / "index.md").write_text(
        "# Beyond one machine\n\nYour own mission: own, mission.\n\n```{toctree}\ntask\n```\n"
    )
    (tmp_path / "task.md").write_text("```{index} ! own mission\n```\n\n# A task of your own\n\nOne class.\n")
    assert sphinx(["-q", "-b", "html", str(tmp_path), str(tmp_path / "html")]) == 0
    with playwright.sync_playwright() as running:
        browser = running.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        for forbidden in (False, True):
            page, said = browser.new_page(), []
            page.on("pageerror", lambda error, said=said: said.append(str(error)))
            if forbidden:
                page.add_init_script("Object.defineProperty(window, 'localStorage', {get() { throw new Error(); }})")
            page.goto(f"{(tmp_path / 'html' / 'search.html').as_uri()}?q=own+mission")
            told = "No search in pages" if forbidden else "Search Results"
            page.wait_for_function(f"document.querySelector('#search-results h2').textContent.startsWith('{told}')")
            if not forbidden:
                assert page.text_content("#search-results li >> nth=0").startswith("A task of your own")
                assert said == []
        browser.close()


def test_the_first_page_names_every_tutorial():
    first = (ROOT / "docs" / "index.md").read_text(encoding="utf-8")
    for path in (ROOT / "docs" / "tutorials").glob("*.md"):
        title = path.read_text(encoding="utf-8").partition("\n")[0].removeprefix("# ")
        assert f"[{title}](tutorials/{path.name})" in first
