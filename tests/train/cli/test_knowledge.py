"""`clean-swarm knowledge` as a user meets it: what it prints, where it looks, and errors of one line."""

import io
from datetime import UTC, datetime
from functools import partial
from pathlib import Path

import pytest

from selector.store import Key, KnowledgeStore, StoredKnowledge
from tests.selector.store.strategies import entry_of, moments_of
from tests.train import commands
from train import memory as stores

NOW = datetime(2026, 11, 21, 10, 40, 49, 499_841, tzinfo=UTC)
GRADIENT = "RepulsionGradient"
EXPERT = """goals:
  AvoidCollision:
    - {configuration: RepulsionFernandez, score: 1}
    - {configuration: RepulsionGradient, score: 0.5, parameters: {view_distance: 2.0}}
"""


@pytest.fixture(autouse=True)
def here(monkeypatch, tmp_path):
    """Be in an empty directory with an empty data directory."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    monkeypatch.delenv(stores.VARIABLE, raising=False)


run, refused = partial(commands.command, "knowledge"), partial(commands.refused, "knowledge")
"""The commands on knowledge: code, output and errors; the line of one that is refused."""


@pytest.fixture
def filled(tmp_path) -> KnowledgeStore:
    """The store `k.sqlite`, which holds what an expert says and rewards of two runs."""
    (tmp_path / "expert.yaml").write_text(EXPERT)
    assert run("import", "expert.yaml", "--store", "k.sqlite")[1] == "k.sqlite: took in 2 expert options, 0 updates\n"
    rewards = {
        (GRADIENT, "", "run-1"): [1.0, 2.0, 6.0],
        (GRADIENT, "crowded", "run-2"): [0.5],
        ("Unrated", "", "run-1"): [0.25],
    }
    keys = {Key("AvoidCollision", *key): moments_of(values) for key, values in rewards.items()}
    store = KnowledgeStore("k.sqlite", create=False)
    store.absorb(StoredKnowledge({key: entry_of(key, moments, NOW) for key, moments in keys.items()}))
    return store


def held(path) -> StoredKnowledge:
    return KnowledgeStore(path, create=False).contents()


def test_the_store_is_in_the_data_directory_unless_named(filled, tmp_path, monkeypatch):
    path = stores.default_path()
    assert path.is_relative_to(tmp_path)
    told = "took in 2 expert options, 0 updates\n"
    assert run("import", "expert.yaml") == (0, f"{path.relative_to(tmp_path)}: {told}", "")
    monkeypatch.setenv(stores.VARIABLE, "mine.sqlite")
    assert run("import", "expert.yaml")[1] == f"mine.sqlite: {told}"
    assert run("import", "expert.yaml", "--store", "named.sqlite")[1] == f"named.sqlite: {told}"
    tables = [held(name).knowledge("").table for name in (path, "mine.sqlite", "named.sqlite", "k.sqlite")]
    assert all(table == tables[0] != {} for table in tables)


def test_show_prints_what_is_known(filled):
    code, out, _ = run("show", "--store", "k.sqlite")
    assert (code, out.splitlines()[0]) == (0, "k.sqlite:")
    (row,) = [line.split(maxsplit=6) for line in out.splitlines() if line.startswith("AvoidCollision")]
    assert row == ["AvoidCollision", "3", "2", "5", "2026-11-21", "10:40:49", "run-1, run-2"]
    code, out, _ = run("show", "AvoidCollision", "--store", "k.sqlite")
    assert (code, out.splitlines()[0]) == (0, "AvoidCollision:")
    rows = [" ".join(line.split()) for line in out.splitlines()]
    assert rows[2] == "RepulsionFernandez RepulsionFernandez 1 - 0 - - - -"
    assert "RepulsionGradient RepulsionGradient 0.5 - 3 3 2.16025 2026-11-21 10:40:49 run-1" in rows
    assert "crowded 1 0.5 0 2026-11-21 10:40:49 run-2" in rows
    assert "Unrated - - - 1 0.25 0 2026-11-21 10:40:49 run-1" in rows


def test_an_exported_store_is_imported_whole_and_counts_once(filled):
    for name in ("k.yaml", "k.json"):
        assert run("export", name, "--store", "k.sqlite")[:2] == (0, f"2 expert options, 5 updates in {name}\n")
        for _ in range(2):
            assert run("import", name, "--store", f"{name}.sqlite")[0] == 0
            assert held(f"{name}.sqlite") == filled.contents()
    assert run("export", "-", "--store", "k.sqlite")[1] == Path("k.yaml").read_text()


def test_reset_asks_and_forgets_a_source(filled, monkeypatch):
    before = filled.contents()
    monkeypatch.setattr("sys.stdin", io.StringIO(""))
    code, _, err = run("reset", "--store", "k.sqlite", "--source", "run-2")
    assert code == 1
    assert "k.sqlite: forget source 'run-2'? [y/N]" in err
    assert filled.contents() == before
    code, out, _ = run("reset", "--store", "k.sqlite", "--source", "run-2", "--yes")
    assert (code, out) == (0, "k.sqlite: forgot 1 entry\n")
    assert {key.source for key in filled.contents().learned} == {"run-1"}
    assert filled.contents().expert == before.expert
    assert "expected the name of a source" in refused("reset", "--store", "k.sqlite", "--source", "", "--yes")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("show",), "data/clean-swarm/knowledge.sqlite: no such knowledge store"),
        (("show", "--store", "sqlite:///k"), "store: expected the path of a file, got 'sqlite:///k'"),
        (("import", "none.yaml"), "none.yaml: cannot be read (No such file or directory)"),
        (("export", "k.txt"), "k.txt: expected a name that ends with .yaml, .yml, .json"),
        (("reset", "--source", "x"), "data/clean-swarm/knowledge.sqlite: no such knowledge store"),
    ],
)
def test_mistakes_are_one_line_and_leave_nothing(tmp_path, words, message):
    assert refused(*words).startswith(f"error: {message}")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("show", "AvoidColision"), "unknown goal 'AvoidColision' (known: AvoidCollision; did you mean"),
        (("export", "expert.yaml"), "expert.yaml: exists already; expected a new file"),
        (("export", "k.json", "--context", "crowded"), "k.json: expected a name that ends in .yaml with --context"),
        (("export", "k.yaml", "--context", "crowd"), "k.sqlite: unknown context 'crowd' (known: , crowded; did you"),
    ],
)
def test_mistakes_about_a_store_are_one_line_and_change_nothing(filled, words, message):
    before = filled.contents()
    assert refused(*words, "--store", "k.sqlite").startswith(f"error: {message}")
    assert filled.contents() == before
