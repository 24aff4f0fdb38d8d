"""`clean-swarm learn knowledge` as a user meets it: what it prints, where it looks, and errors of one line."""

import io
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from selector.store import KnowledgeStore, RewardSums, StoredKnowledge
from train import cli
from train import memory as stores


@pytest.fixture
def run(monkeypatch, capsys, tmp_path):
    """Run the command line in an empty directory with an empty data directory: code, output, errors."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    monkeypatch.delenv(stores.VARIABLE, raising=False)

    def call(*words: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["clean-swarm", "learn", "knowledge", *map(str, words)])
        with pytest.raises(SystemExit) as ended:
            cli.main()
        out, err = capsys.readouterr()
        return int(ended.value.code or 0), out, err

    return call


def learn(path: str, rewards, source="run-1", option="RepulsionGradient", context=""):
    batch = RewardSums("AvoidCollision", [option])
    batch.record(np.zeros(len(rewards), dtype=int), np.array(rewards), context)
    store = KnowledgeStore(path)
    store.add(batch, source=source, updated=1_795_257_649_499_841)
    store.close()


def held(path) -> StoredKnowledge:
    store = KnowledgeStore(str(path), create=False)
    contents = store.contents()
    store.close()
    return contents


def test_the_store_is_in_the_data_directory_unless_named(run, tmp_path, monkeypatch):
    code, out, err = run("import", "cleaning")
    assert (code, err) == (0, "")
    path = stores.default_path()
    assert path.is_relative_to(tmp_path)
    assert out == f"{path.relative_to(tmp_path)}: took in 3 expert options, 0 updates\n"
    monkeypatch.setenv(stores.VARIABLE, "mine.sqlite")
    assert run("import", "cleaning")[1].startswith("mine.sqlite: ")
    assert run("import", "cleaning", "--store", f"sqlite:///{tmp_path}/named.sqlite")[1].startswith("named.sqlite: ")
    assert held(path).knowledge("").table == held("mine.sqlite").knowledge("").table != {}


def test_list_and_show_print_what_is_known(run):
    run("import", "cleaning", "--store", "k.sqlite")
    learn("k.sqlite", [1.0, 2.0, 6.0])
    learn("k.sqlite", [0.5], source="run-2", context="crowded")
    learn("k.sqlite", [0.25], option="Unrated")
    code, out, _ = run("list", "--store", "k.sqlite")
    assert code == 0
    (row,) = [line.split(maxsplit=6) for line in out.splitlines() if line.startswith("AvoidCollision")]
    assert row == ["AvoidCollision", "4", "2", "5", "2026-11-21", "10:40:49", "run-1, run-2"]
    code, out, _ = run("show", "AvoidCollision", "--store", "k.sqlite")
    assert code == 0
    rows = [" ".join(line.split()) for line in out.splitlines()]
    assert rows[2] == "RepulsionFernandez RepulsionFernandez 1 - 0 - - - -"
    assert "RepulsionGradient RepulsionGradient 0.5 - 3 3 2.16025 2026-11-21 10:40:49 run-1" in rows
    assert "crowded 1 0.5 0 2026-11-21 10:40:49 run-2" in rows
    assert "Unrated - - - 1 0.25 0 2026-11-21 10:40:49 run-1" in rows


def test_an_exported_store_is_imported_whole(run, tmp_path):
    run("import", "cleaning", "--store", "k.sqlite")
    learn("k.sqlite", [0.1, 0.2, 0.3])
    for name in ("k.yaml", "k.json"):
        code, out, _ = run("export", name, "--store", "k.sqlite")
        assert (code, out) == (0, f"3 expert options, 3 updates in {name}\n")
        assert run("import", name, "--store", f"{name}.sqlite")[0] == 0
        assert held(f"{name}.sqlite") == held("k.sqlite")
    assert run("export", "-", "--store", "k.sqlite")[1] == Path("k.yaml").read_text()
    code, _, err = run("export", "k.json", "--store", "k.sqlite")
    assert (code, err) == (2, "error: k.json: cannot be written (File exists)\n")


def test_stores_are_merged_and_the_others_stay(run):
    run("import", "cleaning", "--store", "a.sqlite")
    learn("a.sqlite", [0.1, 0.2])
    learn("b.sqlite", [0.3], source="run-3")
    learn("c.sqlite", [0.4], source="run-2")
    expected = held("a.sqlite").merged(held("b.sqlite")).merged(held("c.sqlite"))
    code, out, _ = run("merge", "b.sqlite", "c.sqlite", "--store", "a.sqlite")
    assert code == 0
    assert out == "".join(f"a.sqlite: took in 0 expert options, 1 update of {name}.sqlite\n" for name in "bc")
    assert held("a.sqlite") == expected
    code, _, err = run("merge", "b.sqlite", "--store", "a.sqlite")
    assert (code, err, held("a.sqlite")) == (0, "", expected)
    code, _, err = run("merge", "b.sqlite", "none.sqlite", "--store", "a.sqlite")
    assert (code, err) == (2, "error: none.sqlite: no such knowledge store\n")
    assert held("a.sqlite") == expected


def test_reset_asks_and_forgets_what_is_chosen(run, monkeypatch):
    run("import", "cleaning", "--store", "k.sqlite")
    learn("k.sqlite", [0.1])
    learn("k.sqlite", [0.2], source="run-2")
    before = held("k.sqlite")
    monkeypatch.setattr("sys.stdin", io.StringIO(""))
    code, _, err = run("reset", "--store", "k.sqlite", "--source", "run-2")
    assert code == 1
    assert "k.sqlite: forget source 'run-2'? [y/N]" in err
    assert held("k.sqlite") == before
    code, out, _ = run("reset", "--store", "k.sqlite", "--source", "run-2", "--yes")
    assert (code, out) == (0, "k.sqlite: forgot 1 entry, 0 expert options\n")
    assert [key.source for key in held("k.sqlite").learned] == ["run-1"]
    assert run("reset", "--store", "k.sqlite", "--expert", "--yes")[1] == "k.sqlite: forgot 1 entry, 3 expert options\n"


def test_a_users_own_knowledge_is_found(run, tmp_path):
    (tmp_path / "own" / "knowledge").mkdir(parents=True)
    text = "goals: {Reach: [{configuration: RepulsionGradient, score: 2.0}]}"
    (tmp_path / "own" / "knowledge" / "mine.yaml").write_text(text)
    assert run("import", "mine", "--configs", "own", "--source", "me", "--store", "k.sqlite")[0] == 0
    (rated,) = held("k.sqlite").expert.values()
    assert (rated.option.score, rated.source) == (2.0, "me")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("list",), "data/clean-swarm/knowledge.sqlite: no such knowledge store"),
        (("list", "--store", "mysql://host/db"), "store: unknown database 'mysql' (known: sqlite, postgresql)"),
        (("import", "clean"), "unknown expert knowledge 'clean' (known: "),
        (("import", "none.yaml"), "none.yaml: no such file"),
        (("export", "k.txt"), "k.txt: expected a name that ends in .yaml or .json"),
        (("merge", "none.sqlite"), "none.sqlite: no such knowledge store"),
        (("reset", "--expert", "--context", "x"), "--expert: expert options have no context; leave out --context"),
    ],
)
def test_mistakes_are_one_line_and_leave_nothing(run, tmp_path, words, message):
    code, out, err = run(*words)
    assert (code, out) == (2, "")
    assert err.startswith(f"error: {message}")
    assert err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_an_unknown_goal_names_the_known_ones(run):
    run("import", "cleaning", "--store", "k.sqlite")
    code, _, err = run("show", "AvoidColision", "--store", "k.sqlite")
    assert code == 2
    assert err == "error: unknown goal 'AvoidColision' (known: AvoidCollision; did you mean 'AvoidCollision'?)\n"


def test_a_missing_package_is_one_line(run, monkeypatch):
    monkeypatch.setitem(sys.modules, "selector.store.knowledge_store", None)
    code, _, err = run("list", "--store", "k.sqlite")
    assert code == 2
    assert err == "error: store: selector.store.knowledge_store is not installed: pip install 'clean-swarm[store]'\n"


def test_help_needs_no_database():
    code = "import train.cli.app, sys; print('sqlalchemy' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "False\n"
