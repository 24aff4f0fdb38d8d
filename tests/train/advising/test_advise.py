"""Advice by the command: what it says, what it leaves, how it ends and goes on."""

import errno
import json
import os
import re
from itertools import chain, repeat
from statistics import NormalDist
from unittest.mock import Mock

import numpy as np
import pytest
import yaml
from rich.console import Console

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.config.load import load_family
from clean_swarm_env.config.mission import MissionConfig
from selector.knowledge import library_options, load_knowledge
from selector.strategies.problem import Problem
from selforg.plugins import PluginError
from tests.train.commands import command, done, refused
from train.advising import advice, opening, perturbed, search
from train.advising.evaluation import AdviceEvaluation
from train.advising.report import RANDOM, Advice, Ratio
from train.advising.rounds import CPU
from train.live.chosen import chosen
from train.request import Request
from train.running.engine import WorkerLost
from train.running.finished_runs import runs_of
from train.running.trial_task import TrialTask

YARD = {
    "name": "yard",
    "world": {"width": 6.0, "height": 6.0, "contacts": "solid"},
    "robots": {"count": 3},
    "task": {"garbage": {"count": 2}, "stations": {"recycling": [1.5, 3.0], "dump": [4.5, 3.0]}},
    "time_limit": 60.0,
}
QUICK = ("--missions", 100, "--workers", 1)


@pytest.fixture(autouse=True)
def here(monkeypatch, tmp_path):
    """Be in a directory with a mission of one's own."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "yard.yaml").write_text(yaml.safe_dump(YARD))


def taken(file):
    """Goal -> the option that MaxScore takes."""
    known = load_knowledge(str(file))
    problems = {goal: Problem.of(known, goal) for goal in known.goals}
    return {goal: one.options[int(one.scores.argmax())] for goal, one in problems.items()}


def few(monkeypatch):
    """Let the library have a few options only, so that a mission is searched in seconds."""
    monkeypatch.setattr(opening, "library_options", lambda *given: library_options(*given)[-2:])
    monkeypatch.setattr(opening, "MOST_VARIANTS", 2)
    for name, starts in {"LOOK_STARTS": 2, "FEWEST_STARTS": 1, "LAST_FEWEST": 5}.items():
        monkeypatch.setattr(search, name, starts)


def test_a_mission_of_ones_own_gets_advice_that_can_be_used(tmp_path, monkeypatch):
    few(monkeypatch)
    written, write = [], advice.write_whole
    monkeypatch.setattr(advice, "write_whole", lambda path, text: (written.append(path.name), write(path, text)))
    code, out, err = command("advise", "yard.yaml", *QUICK)
    assert code == 0, err
    assert sorted(written) == ["numbers.yaml", "options.yaml", "options.yaml"]  # once to see whether all can be built
    said = json.loads((tmp_path / "advice/yard/summary.json").read_text())
    first = " and ".join(said["held"].values())
    assert f"yard: hold {first}: " in out
    assert f"on {said['starts']} fresh starts, the least of 10 pairs" in out
    assert "the experts' scores" in out
    assert "So a selector " in out or "Whether a selector is worth it here is not known at this budget" in out
    assert "Budget: 100 missions, seed 0." in out
    (row,) = [line for line in out.splitlines() if line.lstrip().startswith("Random ")]
    told = re.search(r"(?i)a random choice (?:costs )?(.*?\])", out)[1]
    assert told.replace("times as much ", "") in row
    assert f"times fixed:{'+'.join(said['held'].values())} [95 %]" in " ".join(out.split())
    assert taken(tmp_path / "advice/yard") == said["held"]
    robots = clean_swarm_v0.parallel_env("yard.yaml", knowledge="advice/yard")
    assert set(robots.options) == {"AvoidCollision", "ExplorationPatrol"}
    assert set(clean_swarm_v0.parallel_env("yard.yaml").options) == {"AvoidCollision"}
    assert (tmp_path / "advice/yard/replay.html").stat().st_size > 10_000
    assert chosen("advice/yard", 1, 0, None, ()).strategy == "MaxScore"
    assert "clean_swarm_v0.parallel_env('yard.yaml', knowledge='advice/yard')" in out
    before = (tmp_path / "advice/yard/runs.jsonl").read_bytes()
    assert "give --resume or another --output" in refused("advise", "yard.yaml", *QUICK, "--output", "advice/yard")
    again = done("advise", "yard.yaml", *QUICK, "--resume")
    assert (tmp_path / "advice/yard/runs.jsonl").read_bytes() == before
    assert next(line for line in again.splitlines() if line.startswith("yard: ")) in out
    assert "| strategy |" in (tmp_path / "advice/yard/table.md").read_text().partition("## search, ")[2]
    (tmp_path / "advice").rename(tmp_path / "moved")
    done("evaluate", "moved/yard", "--strategy", "MaxScore", "--scenarios", 2)


def test_what_is_best_for_each_kind_of_start_is_judged_on_the_last_round(tmp_path, monkeypatch):
    few(monkeypatch)
    (tmp_path / "yards.yaml").write_text(
        yaml.safe_dump({"name": "yards", "description": "D.", "mission": YARD, "spots": [0, 1]})
    )
    out = done("advise", "yards.yaml", "--kinds", *QUICK)
    said = json.loads((tmp_path / "advice/yards/summary.json").read_text())
    own, drawn = said["kinds"], [load_family("yards.yaml").scenario(0, k, "test") for k in range(5)]
    kinds = [f"spots {len(one.mission.task.garbage.spots)} stations 2" for one in drawn]
    runs = {one.key: one.result.excess_s for one in runs_of(tmp_path / "advice/yards/runs.jsonl")}
    told = [runs[f"test-{k + 1}", own[kind]] for k, kind in enumerate(kinds)]
    best = [runs[f"test-{k + 1}", "fixed:" + "+".join(said["held"].values())] for k in range(5)]
    assert said["by_kind"]["ratio"] == pytest.approx(np.mean(told) / np.mean(best))
    assert set(own) == set(kinds) == {"spots 0 stations 2", "spots 1 stations 2"}
    assert f" ({kinds.count('spots 1 stations 2')} starts). To tell the kind gains " in out


def test_what_is_held_is_judged_in_perturbed_worlds_on_the_same_starts(tmp_path, monkeypatch):
    few(monkeypatch)
    monkeypatch.setattr(perturbed, "WORLDS", 3)
    monkeypatch.setattr(perturbed, "STARTS", 4)
    out = done("advise", "yard.yaml", "--robust", *QUICK)
    said = json.loads((tmp_path / "advice/yard/summary.json").read_text())
    runs = {one.key: one.result.excess_s for one in runs_of(tmp_path / "advice/yard/runs.jsonl")}
    held = "fixed:" + "+".join(said["held"].values())
    starts = [f"test-{k + 1}" for k in range(4)]
    own = [np.mean([runs[start, f"{held}, world {number}"] for start in starts]) for number in (1, 2, 3)]
    assert said["robust"]["excess_s"][held] == pytest.approx(own, abs=0.001)
    usual = np.mean([runs[start, held] for start in starts])
    assert said["robust"]["ratio"]["ratio"] == pytest.approx(np.mean(own) / usual)
    holds = said["robust"]["holds"]
    least = np.min([*said["robust"]["excess_s"].values()], axis=0)
    assert holds == [bool(cost <= 1.1 * best) for cost, best in zip(own, least, strict=True)]
    assert f"In 3 perturbed worlds it costs {np.mean(own) / usual:.2f} times as much" in out
    assert f" and holds in {sum(holds)}" in out
    assert "In place of" not in out
    assert "| world | delay |" in (tmp_path / "advice/yard/table.md").read_text()
    assert "advice.robust: expected False, got True" in refused("advise", "yard.yaml", *QUICK, "--resume")
    workers = ("--missions", 100, "--workers", 2, "--output", "by-two")
    done("advise", "yard.yaml", "--robust", *workers)
    assert json.loads((tmp_path / "by-two/summary.json").read_text())["robust"] == said["robust"]


def test_robust_advice_goes_on_after_ctrl_c_in_a_perturbed_world(tmp_path, monkeypatch):
    few(monkeypatch)
    monkeypatch.setattr(perturbed, "WORLDS", 3)
    monkeypatch.setattr(perturbed, "STARTS", 4)
    done("advise", "yard.yaml", "--robust", *QUICK, "--output", "whole")
    each = TrialTask.each

    def ends(task):
        if ", world 2" in task.condition:
            raise KeyboardInterrupt
        yield from each(task)

    with monkeypatch.context() as patch:
        patch.setattr(TrialTask, "each", ends)
        code, _, err = command("advise", "yard.yaml", "--robust", *QUICK)
    assert code == 130
    kept = (tmp_path / "advice/yard/runs.jsonl").read_text().splitlines()
    assert any(", world 1" in line for line in kept)
    assert not any(", world 2" in line for line in kept)
    assert f": {len(kept)} of " in err
    line = err.splitlines()[-1].split()
    assert line[:3] == ["clean-swarm", "advise", "yard.yaml"]
    assert {"--robust", "--resume"} <= set(line)
    done(*line[1:])
    assert set(kept) < set((tmp_path / "advice/yard/runs.jsonl").read_text().splitlines())
    one, two = (json.loads((tmp_path / path / "summary.json").read_text()) for path in ("whole", "advice/yard"))
    assert (one["held"], one["robust"]) == (two["held"], two["robust"])


def test_a_perturbed_world_has_errors_beside_those_of_the_mission():
    robots = [{"model": "a", "count": 1, "radius": 0.1, "slip": 0.3}, {"model": "b", "count": 2, "max_speed": 2.0}]
    family = load_family("table1")
    events = [{"at": 5.0, "do": "deliver", "loss": 0.2}]
    own = family.mission.model_dump() | {"robots": robots, "delivery": {"loss": 0.5}, "events": events}
    for number in range(1, 11):
        drawn, mission = (
            perturbed.drawn_world(7, number),
            perturbed.perturbed(MissionConfig.model_validate(own), 7, number),
        )
        first, second = mission.robots.groups
        assert mission.delivery.loss == pytest.approx(1.0 - 0.5 * (1.0 - drawn["loss"]))
        assert mission.events[0].loss == pytest.approx(1.0 - 0.8 * (1.0 - drawn["loss"]))
        assert mission.delivery.delay == pytest.approx(0.2 * drawn["delay"])
        assert first.slip == pytest.approx(np.hypot(0.3, drawn["slip"]))
        assert first.pose_noise == pytest.approx(0.1 * drawn["pose_noise"])
        assert second.pose_noise == pytest.approx(0.25 * drawn["pose_noise"])
        assert (first.max_speed, second.max_speed) == pytest.approx((drawn["speed"], 2.0 * drawn["speed"]))
        assert (first.count, second.count, first.radius) == (1, 2, 0.1)
    worlds = [tuple(perturbed.drawn_world(7, number).values()) for number in range(1, 11)]
    assert len(set(worlds)) == 10
    assert worlds[0] != tuple(perturbed.drawn_world(8, 1).values())


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["late.yaml", "--robust"], "world 2: delivery.delay: expected less than or equal to 60, got 60.4"),
        (["nowhere"], "unknown mission, family, experiment or task 'nowhere'"),
        (["table1", "--minutes", 0], "--minutes: expected a positive number"),
        (["table1", "--minutes", "nan"], "--minutes: expected a positive number"),
        (["table1", "--missions", 5], "--missions: expected a whole number of at least 100"),
        (["table1", "--training", -1], "--training: expected a positive number"),
        (["table1", "--minutes", 0.01], "--minutes: expected at least"),
        (["yard.yaml", "--kinds"], "yard: --kinds: expected scenarios of several kinds, got one: spots 0 stations 2"),
        (["table1", "--knowledge", "nothing"], "unknown expert knowledge 'nothing'"),
    ],
)
def test_what_cannot_be_asked_is_one_line_and_leaves_nothing(words, told, tmp_path):
    (tmp_path / "late.yaml").write_text(yaml.safe_dump({**YARD, "name": "late", "delivery": {"delay": 60.0}}))
    assert told in refused("advise", *words)
    assert not (tmp_path / "advice").exists()


def test_an_option_that_a_plugin_breaks_drops_out_and_is_named(tmp_path, monkeypatch):
    few(monkeypatch)
    each = TrialTask.each

    def breaks(task):
        if "+ORCA" in task.member or task.member == "Random":
            raise PluginError("my_swarm: mechanism ORCA: broke")
        yield from each(task)

    monkeypatch.setattr(TrialTask, "each", breaks)
    out = done("advise", "yard.yaml", *QUICK)
    assert out.count("dropped out: my_swarm: mechanism ORCA: broke.") == 1
    assert "a random choice had 5 of 5 broken off by a plug-in" in out.lower()
    assert "ORCA" not in json.loads((tmp_path / "advice/yard/summary.json").read_text())["held"]["AvoidCollision"]


def test_a_mission_that_nothing_finishes_is_said_to_be_one(tmp_path, monkeypatch):
    few(monkeypatch)
    start = {
        "id": "a",
        "robots": [[1.0, 1.0, 0.0], [3.0, 1.0, 0.0], [5.0, 1.0, 0.0]],
        "items": [[1.0, 5.0], [5.0, 5.0]],
    }
    family = {"name": "yard", "description": "One start.", "mission": YARD | {"time_limit": 2.0}, "starts": [start]}
    (tmp_path / "yard.yaml").write_text(yaml.safe_dump(family))
    out = done("advise", "yard.yaml", *QUICK)
    assert "on 5 fresh missions from its 1 start, " in out
    assert "5 missions of 5 were left unfinished (up to 100% may be)." in out
    assert "So nothing that was tried does this mission, and no selector is judged: the time limit of 2 s may be" in out
    assert "worth it" not in out


def test_a_full_disk_and_a_changed_number_cost_no_kept_mission(tmp_path, monkeypatch):
    few(monkeypatch)
    journal, full = tmp_path / "advice/yard/runs.jsonl", OSError(errno.ENOSPC, "No space left on device")
    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", Mock(side_effect=chain([None] * 40, repeat(full))))
        code, out, err = command("advise", "yard.yaml", *QUICK)
    assert (code, out) == (1, "")
    assert "error: advice/yard/runs.jsonl: cannot be written (No space left on device); earlier results stay" in err
    kept = re.sub('"cost_s": [0-9.]+', '"cost_s": 99.5', journal.read_text(), count=1)
    journal.write_text(kept + kept[:50])  # a crash cut off the last line
    done("advise", "yard.yaml", *QUICK, "--resume")
    assert set(kept.splitlines()) < set(journal.read_text().splitlines())


@pytest.mark.extra
@pytest.mark.parametrize(
    ("end", "code", "said"),
    [(KeyboardInterrupt, 130, "interrupted"), (WorkerLost(Mock(keys=[("1", "a")])), 1, "3 times")],
)
def test_a_training_that_is_ended_says_how_to_go_on(tmp_path, monkeypatch, capsys, end, code, said):
    pytest.importorskip("torch")
    from train.advising import learning
    from train.learning import seeds

    monkeypatch.setattr(seeds, "run_training", Mock(side_effect=end))
    monkeypatch.setattr(learning, "training_of", Mock(return_value=Mock(model_dump=Mock(return_value={}))))
    request = Request("yard", words=("clean-swarm", "advise", "yard", "--learn"), output=tmp_path)
    assert learning.train_selector(Mock(folder=tmp_path, directories=(), request=request), 1.0, Console()) == code
    words = "clean-swarm advise yard --learn --resume"
    assert capsys.readouterr().err.endswith(f"{said}: advice and trainings are kept; to go on:\n  {words}\n")


def test_a_task_of_one_option_has_nothing_to_choose(tmp_path):
    code, out, err = command("advise", "FindBarycenter", "--minutes", 0.1, "--force", "--workers", 1)
    assert code == 0, err
    assert "there is nothing to choose" in out


def test_no_selector_is_worth_it_beside_a_search_without_time_or_one_that_chance_beats():
    noise = np.random.default_rng(0).uniform(0.9, 1.1, 20)
    for left_out, chance, why in (
        ({"a", "b"}, 2.0, "2 options were not tried"),
        (set(), 0.5, "a random choice costs less than what is held"),
        (set(), 2.0, ""),
    ):
        ratio = Mock(return_value=Ratio.of(chance * noise, noise[::-1].copy()))
        report = Mock(search=Mock(left_out=left_out), costs={RANDOM: 0.0}, ratio=ratio)
        assert Advice.unjudged.fget(report) == why


STARTS = np.random.default_rng(5).uniform(90.0, 110.0, 24)


def judged(**ratios):
    """Return an advice whose last round had these ratios."""
    report = Mock(found=Mock(choosers=("policy:a", "fsm:b"), starts=24), hindsight=None, by_kind=None, unjudged="")
    report.costs = [name for name in report.found.choosers if name in ratios]
    report.ratio = ratios.get
    report.configure_mock(**{name: one for name, one in ratios.items() if name not in report.costs})
    for name in ("claims", "better", "gains", "most", "worth_it"):
        own = getattr(Advice, name)
        setattr(report, name, (own.fget if isinstance(own, property) else own.func)(report))
    return report


def costing(share, noise):
    """Return the ratio of costs that are a share of others', with noise."""
    drawn = [NormalDist().inv_cdf((5 * k % 24 + 0.5) / 24) for k in range(24)]
    return Ratio.of(STARTS * share * np.exp(noise * np.array(drawn)), STARTS)


@pytest.mark.parametrize(
    ("ratios", "expected"),
    [
        ({"policy:a": (0.8, 0.1)}, True),
        ({"policy:a": (1.2, 0.05), "hindsight": (0.8, 0.1)}, True),
        ({"policy:a": (1.2, 0.05), "hindsight": (0.98, 0.01)}, False),
        ({"policy:a": (1.2, 0.05), "hindsight": (0.95, 0.4)}, None),
        ({"policy:a": (0.95, 0.4), "hindsight": (1.1, 0.02)}, None),
        ({}, None),
    ],
)
def test_a_selector_is_worth_it_or_not_or_that_is_not_known(ratios, expected):
    assert judged(**{name: costing(*one) for name, one in ratios.items()}).worth_it is expected


@pytest.mark.parametrize(
    ("starts", "ratios", "expected"),
    [
        (24, {"policy:a": (0.95, 0.2)}, "a gain of a tenth would be told on about "),
        (400, {"policy:a": (0.95, 0.2)}, "to tell a gain of a tenth takes more than the 400 starts of a last round"),
        (24, {"policy:a": (0.95, 4.0)}, "to tell a gain of a tenth takes more than the 400 starts of a last round"),
        (24, {}, "there was nothing to compare with what is held"),
    ],
)
def test_more_starts_are_asked_for_where_they_may_be_had_and_would_tell(starts, ratios, expected):
    report = judged(**{name: costing(*one) for name, one in ratios.items()})
    report.found.starts, report.budgeted = starts, []
    assert Advice._more_starts.fget(report).startswith(expected)


def test_that_something_gains_is_told_with_all_that_might_counted():
    one, nothing = costing(0.93, 0.14), costing(1.0, 0.4)
    assert 0.05 / 3 < one.p < 0.05 / 2
    assert judged(hindsight=one, by_kind=nothing).gains
    assert not judged(**{"hindsight": one, "by_kind": nothing, "fsm:b": nothing}).gains
    assert judged(**{"policy:a": one, "hindsight": nothing}).better == ["policy:a"]
    assert judged(**{"policy:a": one, "hindsight": nothing, "fsm:b": nothing}).better == []


def test_the_gain_in_hindsight_is_beside_the_best_of_the_same_arms_not_beside_what_is_held():
    rng = np.random.default_rng(2)
    starts = rng.uniform(50.0, 150.0, 40)
    costs = {"a": 1.3, "b": 1.0}
    done = {
        (f"test-{k + 1}{world}", arm): Mock(result=Mock(excess_s=share * starts[k] * rng.uniform(0.99, 1.01)))
        for arm, share in costs.items()
        for k in range(40)
        for world in ("", ".2")
    }
    report = Mock(found=Mock(finalists=("a", "b"), starts=40), costs=costs, search=Mock(done=done))
    assert Advice.hindsight.func(report).ratio == pytest.approx(1.0, abs=0.01)


def test_how_many_missions_are_to_come_follows_from_the_budget(tmp_path, monkeypatch):
    few(monkeypatch)
    evaluation = AdviceEvaluation(Request("yard.yaml", output=tmp_path / "a"), minutes=1.0)
    done_of_two = {(f"test-{k}", "x"): Mock(counts={CPU: 250}) for k in range(2)}
    assert (evaluation.expected({}), evaluation.expected(done_of_two)) == (0, 240)


@pytest.mark.long
def test_advice_is_the_same_in_any_number_of_processes(tmp_path):
    for workers in (1, 2):
        done("advise", "yard.yaml", "--missions", 400, "--workers", workers, "--output", f"by-{workers}")
    same = ("knowledge.yaml", "options.yaml", "numbers.yaml")
    assert all((tmp_path / f"by-1/{name}").read_text() == (tmp_path / f"by-2/{name}").read_text() for name in same)
    one, two = (json.loads((tmp_path / f"by-{k}/summary.json").read_text()) | {"cpu_s": 0} for k in (1, 2))
    assert one == two
