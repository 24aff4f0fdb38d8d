"""Whatever the pages link to, or name as a file, a module or a command, exists."""

import re
from pathlib import Path

import pytest

from docs.figures import update_architecture
from docs.site import keys
from docs.site.replays import MISSIONS
from docs.site.stage import REPLAYS
from tests.paths import ROOT

PACKAGES = ("selforg", "selector", "clean_swarm_env", "train", "configs", "benchmarks", "tests", "docs", "examples")
PLACES = ("*.md", "docs/**/*.md", "tests/*.md")
PAGES = [path for place in PLACES for path in sorted(ROOT.glob(place)) if path.name != "CHANGELOG.md"]
PATHS = re.compile(rf"(?<![\w./-])(?:{'|'.join(PACKAGES)})(?:/[\w.-]+)*/[\w-]+\.(?:py|yaml|md|json|png)\b")
MODULES = re.compile(rf"(?<![\w./-])(?:{'|'.join(PACKAGES)})(?:\.\w+)+")
SUFFIXES = {"py", "yaml", "md", "json", "png", "safetensors"}


def prose(page: Path) -> str:
    """Return the text of a page without what recipes let the reader write."""
    return re.sub(r"<!-- recipe -->.*?<!-- end -->", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)


def anchors(page: Path) -> set[str]:
    """Return the anchors of the headings of a page, as GitHub makes them."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), flags=re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def exists(module: str) -> bool:
    """Tell whether a dotted name leads to a module, or to a name that a module holds."""
    parts = module.split(".")
    for length in range(len(parts), 0, -1):
        place = ROOT.joinpath(*parts[:length])
        file = place.with_suffix(".py") if place.with_suffix(".py").exists() else place / "__init__.py"
        if file.exists():
            rest = parts[length:]
            return not rest or bool(re.search(rf"\b{rest[0]}\b", file.read_text(encoding="utf-8")))
        if length == len(parts) and place.is_dir():
            return True
    return False


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_lead_somewhere(page):
    wrong = []
    for target in re.findall(r"\]\(([^)\s]+)\)", prose(page)):
        file, _, anchor = target.partition("#")
        if "://" in target:
            continue
        place = (page.parent / file) if file else page
        if place.parent == REPLAYS and place.stem in MISSIONS:  # the site has them
            continue
        if not place.exists() or (anchor and anchor not in anchors(place)):
            wrong.append(target)
    assert wrong == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_named_files_and_modules_exist(page):
    text = prose(page)
    files = set(PATHS.findall(text))
    modules = {name for name in MODULES.findall(text) if name.rpartition(".")[2] not in SUFFIXES}
    assert sorted(file for file in files if not (ROOT / file).exists()) == []
    assert sorted(module for module in modules if not exists(module)) == []


def test_the_glossary_names_files_that_exist():
    text = (ROOT / "docs" / "glossary.md").read_text(encoding="utf-8")
    files = re.findall(r"`([\w/]+\.py)`", text)
    assert len(files) > 50
    assert [file for file in files if not (ROOT / file).exists() and not (ROOT / "selforg" / file).exists()] == []


def sources() -> list[Path]:
    """Return all files of code and configuration, this one left out."""
    places = [ROOT / name for name in PACKAGES]
    files = [path for place in places for path in sorted(place.rglob("*")) if path.suffix in (".py", ".yaml")]
    return [path for path in files if path != Path(__file__)]


def test_pages_that_the_code_cites_exist():
    cited = {
        page for path in sources() for page in re.findall(r"\bdocs/[\w/-]+\.md\b", path.read_text(encoding="utf-8"))
    }
    assert cited
    assert sorted(page for page in cited if not (ROOT / page).exists()) == []


def test_every_decision_is_linked_from_what_it_protects():
    records = sorted((ROOT / "docs" / "decisions").glob("[0-9]*.md"))
    pages = [page for page in PAGES if page.parent != ROOT / "docs" / "decisions"]
    cited = {
        name for path in [*sources(), *pages] for name in re.findall(r"decisions/([\w-]+\.md)", path.read_text("utf-8"))
    }
    assert records
    assert [record.name for record in records if record.name not in cited] == []


def test_every_numbered_quirk_that_the_code_cites_is_explained():
    explained = set(re.findall(r"^\*\*([QMB]\d+)\*\*", (ROOT / "docs" / "quirks.md").read_text("utf-8"), re.MULTILINE))
    assert {f"Q{number}" for number in range(1, 34)} <= explained
    cited = {quirk for path in sources() for quirk in re.findall(r"\b(Q\d+)\b", path.read_text(encoding="utf-8"))}
    assert cited <= explained


def test_the_records_of_the_architecture_are_those_of_the_code():
    text = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
    assert update_architecture.updated(text) == text, "run: python -m docs.figures.update_architecture"


def test_the_page_of_keys_has_those_of_each_part_with_their_bounds():
    page = keys.page()
    assert "| `time_limit` | number above 0 to 1e+07 |" in page
    assert {"## Missions", "## Families", "## Experiments with conditions"} <= set(page.splitlines())
    assert "## Settings of the task ReachGoal" in page
