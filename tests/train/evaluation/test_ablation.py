"""The ablation: what it leaves out, that the plan's weight and the planner are one term, and what it writes."""

import dataclasses

from benchmarks import ablation
from clean_swarm_env.config.mission import NetworkConfig
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.world.mission import Course, MissionRun
from tests.clean_swarm_env.courses import mission, snapshot


def test_each_variant_lacks_one_thing():
    whole = NetworkConfig(activation_threshold=5.0)
    found = ablation.variants(whole)
    assert next(iter(found)) == ablation.ALL
    assert found.pop(ablation.ALL) == whole
    assert found.pop("planner off") == whole.model_copy(update={"planner": "off"})
    assert list(found) == [f"without {term}" for term in type(whole.weights).model_fields]
    for name, network in found.items():
        weights = network.weights.model_dump()
        assert weights.pop(name.removeprefix("without ")) == 0.0
        assert set(weights.values()) == {1.0}
        assert network.model_copy(update={"weights": whole.weights}) == whole


def test_a_planner_without_weight_is_no_planner():
    without = [mission(network=network) for network in ({"weights": {"plan": 0.0}}, {"planner": "off"})]
    start = random_start(without[0], 3, 0)
    one, other = (
        Course(MissionRun(config, start, 3, {"AvoidCollision": {"RepulsionGradient": 2.0}})) for config in without
    )
    for _ in range(500):
        assert one.in_progress
        assert other.in_progress
        one.tick()
        other.tick()
        for name, part in snapshot(one.worlds, 0).items():
            assert part.tobytes() == snapshot(other.worlds, 0)[name].tobytes(), name


@dataclasses.dataclass
class Outcome:
    duration_s: float
    completed: bool


def test_the_results_are_printed_and_recorded(monkeypatch, capsys):
    seen = []

    def run_mission(config, start, seed, scores):
        seen.append((config.time_limit, start.id, seed, scores["AvoidCollision"]))
        return Outcome(600.0 if config.network.planner == "off" else 100.0 + len(seen) % 3, True)

    monkeypatch.setattr(ablation, "run_mission", run_mission)
    recorded = {}
    monkeypatch.setattr(ablation, "record", recorded.__setitem__)
    ablation.main(["4", "9"])
    text = recorded["ablation/terms"]
    assert text.startswith("4 random start configurations of seed 9")
    rows = [line for line in text.splitlines() if line.startswith("| planner off")]
    assert [row.count("600 [600, 600]") for row in rows] == [2, 2, 1, 1]
    assert text == capsys.readouterr().out.strip()
    # every variant runs on the same starts with the same seeds, under every option
    runs = {tuple(run[1:3] for run in seen[k : k + 4]) for k in range(0, len(seen), 4)}
    assert len(runs) == 1
    assert {limit for limit, *_ in seen} == {ablation.TIME_LIMIT}
