"""The command line as a user meets it: results, errors of one line, and going on."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from clean_swarm_env import __version__
from selector.documents.find import KINDS, files_of
from tests.paths import ROOT
from tests.train import fake_mission
from tests.train.commands import command, cut, done, faked_missions, refused, rows, run, runs
from train.cli.listing import LINES, LISTED_KINDS

FILES = {"manifest.json", "runs.jsonl", "runs.csv", "summary.json", "table.md", "figure.png", "figure.svg"}
WORDS = ("evaluate", "--scenarios", 4, "--workers", 1)


@pytest.fixture(scope="module")
def four(tmp_path_factory):
    """Results of `WORDS` on fake missions."""
    directory = tmp_path_factory.mktemp("four") / "r"
    with faked_missions():
        done(*WORDS, "--output", directory)
    return directory


@pytest.fixture(autouse=True)
def here(fake_missions, monkeypatch, tmp_path):
    """Be in an empty directory, with fake missions."""
    monkeypatch.chdir(tmp_path)


def _configuration(directory: Path) -> dict:
    return json.loads((directory / "manifest.json").read_text())["identity"]["document"]


def test_the_default_is_table_1_on_its_five_start_configurations_in_a_new_directory(tmp_path):
    out = done("evaluate", "--workers", 1)
    directory = tmp_path / "results" / "table1-seed0"
    assert {path.name for path in directory.iterdir()} == FILES
    assert str(directory.relative_to(tmp_path)) in out
    found = runs(directory)
    assert [(r["scenario"], r["condition"]) for r in found] == [
        (str(k), c) for k in range(1, 6) for c in ("RepulsionFernandez-view2.0", "RepulsionGradient-view1.5")
    ]
    assert {r["experiment"] for r in found} == {"table1"}
    assert "846.7" in out
    assert "| 1484.7 |" in (directory / "table.md").read_text()
    manifest = json.loads((directory / "manifest.json").read_text())
    assert manifest["identity"]["seed"] == 0
    assert manifest["command"] == ["clean-swarm", "evaluate", "--workers", "1"]  # as it was typed
    assert {"python", "numpy", "numba", "pymunk", "clean-swarm"} <= set(manifest["versions"])
    assert len(_configuration(directory)["starts"]) == 5
    assert "knowledge/cleaning.yaml" in manifest["identity"]["files"]
    done("evaluate", "--condition", "RepulsionGradient-view1.5", "--workers", 1)
    assert {path.name for path in (tmp_path / "results").iterdir()} == {"table1-seed0", "table1-seed0-2"}
    alone = tmp_path / "results" / "table1-seed0-2"
    assert {r["condition"] for r in runs(alone)} == {"RepulsionGradient-view1.5"}
    assert json.loads((alone / "summary.json").read_text())["comparisons"] == []


def test_equal_seeds_give_equal_runs_with_one_and_two_workers_and_others_do_not(four, tmp_path):
    done(*WORDS[:3], "--workers", 2, "--output", "b")
    assert rows(tmp_path / "b") == rows(four)
    for name in ("summary.json", "figure.png"):
        assert (tmp_path / "b" / name).read_bytes() == (four / name).read_bytes()
    done(*WORDS, "--seed", 1, "--output", "c")
    durations = [{r["duration_s"] for r in runs(directory)} for directory in (four, tmp_path / "c")]
    assert not durations[0] & durations[1]


def _starts_file(path: Path) -> Path:
    measured = {"duration_s": 300.0, "samples_per_s_at_0.5m": 1.0}
    case = {
        "robots": [[1.0, 1.0, 0.0], [1.0, 1.0, 0.0]],
        "items": [[2.0, 2.0]],
        "measured": {"RepulsionFernandez, view 2.0": measured, "RepulsionGradient, view 1.5": measured},
    }
    file = {
        "torus_m": [12, 11],
        "recycling": [1, 1],
        "dump": [11.5, 2],
        "cases": [{"id": k, **case} for k in (5, 30, 9)],
    }
    path.write_text(json.dumps(file))
    return path


def test_a_file_of_starts_is_run_and_compared_with_what_was_measured(tmp_path):
    starts = _starts_file(tmp_path / "starts.json")
    out = done("evaluate", "table1-reference", "--starts", starts, "--all", "--workers", 1, "--output", "r")
    assert [r["scenario"] for r in runs(tmp_path / "r")] == ["5"] * 3 + ["9"] * 3 + ["30"] * 3
    assert {r["robots"] for r in runs(tmp_path / "r")} == {"2"}
    summary = json.loads((tmp_path / "r" / "summary.json").read_text())
    assert {(m["condition"], m["metric"], m["measured"]) for m in summary["reference"]} == {
        (condition, metric, figure)
        for condition in ("RepulsionFernandez-view2.0", "RepulsionGradient-view1.5")
        for metric, figure in (("duration_s", 300.0), ("samples_per_s_at_0.5m", 1.0))
    }
    assert {(r["a"], r["b"]) for r in summary["reference_ratios"]} == {
        ("RepulsionFernandez-view2.0", "RepulsionGradient-view1.5")
    }
    for text in (out, (tmp_path / "r" / "table.md").read_text()):
        assert "ours beside measured" in text
    assert _configuration(tmp_path / "r")["mission"]["world"]["width"] == 12.0


def _experiment(path: Path, **changes: object) -> Path:
    content = {"name": "mine", "mission": {"base": "table1"}, "conditions": [{"name": "a"}], "scenarios": 2}
    path.write_text(json.dumps(content | changes))
    return path


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["tabel1"], "unknown mission, family, experiment or task 'tabel1' (known: "),
        (["none.yaml"], "none.yaml: no such file"),
        (
            ["--condition", "Gradient"],
            "table1: unknown condition 'Gradient' (known: RepulsionFernandez-view2.0, RepulsionGradient-view1.5",
        ),
        (["--scenarios", "0"], "--scenarios: expected a whole number of at least 1, got 0"),
        (["--workers", "-1"], "--workers: expected"),
        (["--seed", "-1"], "--seed: expected"),
        (["--starts", "none.json"], "none.json: cannot be read (No such file or directory)"),
        (
            ["--starts", "broken.json"],
            "broken.json: line 1: expected JSON, got ",
        ),
        (["--starts", "broken.json", "--scenarios", "3"], "--scenarios and --starts: expected one of them, got both"),
        (["--output", "taken"], "taken: has other files"),
        (["misspelt.yaml"], "misspelt.yaml: mission.world.widht: unknown key 'widht'"),
        (["crowded.yaml"], "crowded.yaml: mission.robots.count: expected at most 277 solid robots"),
        (["scores.yaml"], "unknown option 'Repulsion' (known: RepulsionFernandez-view2.0"),
        (["goals.yaml"], "unknown goal 'Avoid' (known: AvoidCollision"),
        (["planned.yaml"], "planned.yaml: mission.network.planner: "),  # with unified-planning: unknown engine 'ares'
        (["knowledge.yaml"], "unknown expert knowledge 'nothing' (known: avoidance, cleaning"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_2_and_writes_nothing(tmp_path, words, expected):
    (tmp_path / "taken").mkdir()
    (tmp_path / "taken" / "thesis.txt").write_text("mine")
    (tmp_path / "broken.json").write_text("{")
    _experiment(tmp_path / "misspelt.yaml", mission={"base": "table1", "world": {"widht": 3}})
    _experiment(tmp_path / "crowded.yaml", mission={"base": "table1", "robots": {"count": 1000}})
    _experiment(tmp_path / "scores.yaml", conditions=[{"name": "a", "scores": {"AvoidCollision": {"Repulsion": 1}}}])
    _experiment(tmp_path / "goals.yaml", conditions=[{"name": "a", "scores": {"Avoid": {}}}])
    _experiment(tmp_path / "knowledge.yaml", mission={"base": "table1", "knowledge": "nothing"})
    _experiment(tmp_path / "planned.yaml", mission={"base": "table1", "network": {"planner": "ares"}})
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    assert expected in refused("evaluate", *words)
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before


def test_resuming_does_only_what_is_missing(four, tmp_path, monkeypatch):
    cut(four, tmp_path / "r", slice(5))
    monkeypatch.setenv("FAKE_LOG", str(tmp_path / "log"))
    done(*WORDS, "--output", "r", "--resume")
    assert (tmp_path / "log").read_text().split() == ["4", "3", "4"]  # one condition after the other
    assert rows(tmp_path / "r") == rows(four)


def test_an_error_in_a_run_is_not_hidden_and_keeps_the_finished_runs(four, tmp_path):
    words = (*WORDS, "--output", "r")
    with faked_missions(fake_mission.trials_but_not_2), pytest.raises(ZeroDivisionError, match="scenario 2"):
        run(*words)
    assert {r["scenario"] for r in runs(tmp_path / "r")} == {"1"}
    done(*words, "--resume")
    assert rows(tmp_path / "r") == rows(four)


@pytest.mark.long
def test_a_mission_that_kills_three_workers_is_named_and_keeps_the_finished_runs(four, tmp_path):
    words = (*WORDS[:3], "--output", "r", "--workers")
    with faked_missions(fake_mission.trials_but_die_on_2):
        code, _, err = command(*words, 2)
    assert code == 1
    assert "scenario 2, condition Repulsion" in err
    assert ": its worker died 3 times: " in err
    done(*words, 1, "--resume")
    assert rows(tmp_path / "r") == rows(four)


def test_listing_names_everything_of_each_kind():
    assert len(LISTED_KINDS) <= 12
    assert sorted(part for parts in LISTED_KINDS.values() for part in parts) == sorted(LINES)
    assert KINDS.keys() < LINES.keys()
    for kind, parts in LISTED_KINDS.items():
        out = done("list", kind)
        assert all(name in out for part in parts for name in (files_of(part) if part in KINDS else ()))
    assert "RepulsionFernandez-view1.5" in done("list", "experiments")
    for kind, name, line in (
        ("strategies", "UCB1", "strategy-classes  UCB1 (Auer, Cesa-Bianchi & Fischer 2002"),
        ("tasks", "Foraging", "12 robots bring food"),
        ("terms", "encounter", "terms         The nearest robot heard"),
        ("terms", "completed", "reward-terms  Shaping"),
        ("classes", "ORCA", "mechanism-classes  "),
        ("classes", "AvoidAll", "mechanism-classes  "),
    ):
        (told,) = [row for row in done("list", kind).splitlines() if row.startswith(f"{name} ")]
        assert line in told
    assert done("--version") == f"clean-swarm {__version__}\n"


def test_a_shell_completes_commands():
    assert "--install-completion" in done("--help")
    typed = {"_CLEAN_SWARM_COMPLETE": "complete_bash", "COMP_WORDS": "clean-swarm tr", "COMP_CWORD": "1"}
    script = "import sys; sys.argv = ['clean-swarm']; from train.cli import main; main()"
    environment = {**os.environ, "PYTHONPATH": str(ROOT), **typed}
    assert subprocess.check_output([sys.executable, "-c", script], env=environment, text=True).split() == ["train"]
