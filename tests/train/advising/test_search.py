"""The search for options over invented missions, whose costs are known."""

from dataclasses import replace

import numpy as np

from clean_swarm_env.config.load import load_family
from clean_swarm_env.world.mission import MissionResult
from selector.knowledge import Knowledge, LearnedScore, Option
from train.advising.opening import OpenedMission
from train.advising.rounds import Lacking
from train.advising.search import JAMMED, LAST_FEWEST, AdviceSearch, arm_of
from train.running.runs import RunRecord

GOALS = {"Explore": 8, "Avoid": 11}
SECONDS = 0.1
"""Time of a processor that an invented mission takes [s]."""


def invented(seed, *, learned=None):
    """An opened mission, and the true cost of each option: goal -> option -> cost [s]."""
    rng = np.random.default_rng(seed)
    table, costs = {}, {}
    for goal, count in GOALS.items():
        names = [f"{goal}{k}" for k in range(count)]
        costs[goal] = dict(zip(names, rng.uniform(10.0, 40.0, count).tolist(), strict=True))
        table[goal] = tuple(
            Option(name=name, configuration=name, score=float(score), parameters={})
            for name, score in zip(names, rng.random(count), strict=True)
        )
    known = Knowledge(table, learned=learned(costs) if learned else {})
    experts = {goal: max(own, key=lambda one: one.score).name for goal, own in table.items()}
    return OpenedMission(load_family("table1-starts"), known, experts, {}), costs


def cost_of(arm, costs):
    """The true mean cost of an arm [s]."""
    kind, _, options = arm.partition(":")
    if kind != "fixed":
        return 60.0
    return sum(own[name] for own, name in zip(costs.values(), options.split("+"), strict=True))


def beside_bad_partners(arm, costs):
    """The cost of an arm where, beside one of the worse half of partners, the best explorer is the worst [s]."""
    first, second = arm.partition(":")[2].split("+")
    explore, avoid = costs.values()
    bad = avoid[second] > float(np.median(list(avoid.values())))
    own = sum((min(explore.values()), max(explore.values()))) - explore[first] if bad else explore[first]
    return own + (8.0 if bad else 1.0) * avoid[second]


class Missions:
    """Invented missions: each arm on each start has its true cost with a spread of a fifth; some arms jam."""

    def __init__(self, wide, costs, seed=0, jams=(), order=None, cost=None, kind=lambda name: ""):
        self.kind = kind
        self.wide, self.costs, self.seed, self.jams, self.order = wide, costs, seed, jams, order
        self.cost = cost or cost_of
        self.done = {}

    def search(self, minutes=5.0, choosers=("fsm:rule",)):
        """A search over what is done."""
        return AdviceSearch(
            self.wide,
            choosers,
            lambda held: {},
            self.done,
            60.0 * minutes,
            lambda record: SECONDS,
            lambda record: -record.result.cost_s,
            counts=True,
            entrants=lambda winner, finalists, choosers: 8,
            kind=self.kind,
        )

    def found(self, **more):
        """The search, and what it finds once all its missions are done."""
        while True:
            search = self.search(**more)
            try:
                return search, search.run()
            except Lacking as lacking:
                keys = [(name, arm) for arm, names in lacking.missing.items() for name in names]
                for key in keys if self.order is None else self.order(keys):
                    self.do(*key)

    def do(self, scenario, arm):
        """Do a mission."""
        start = int(scenario.removeprefix("train-"))
        noise = np.random.default_rng([self.seed, start, *arm.encode()]).normal(0.0, 0.2)
        jams = arm in self.jams
        cost = 6000.0 if jams else self.cost(arm, self.costs) * float(np.exp(noise))
        if self.kind(scenario) == "odd" and max(self.costs["Avoid"], key=self.costs["Avoid"].get) in arm.split("+"):
            cost *= 0.25  # the worst elsewhere is the best here
        result = MissionResult(not jams, cost, (0.0,), (0.0,), 10, 5, 100, 1.0, cost, 0.0)
        record = RunRecord("invented", scenario, 0, arm, result, 1.0)
        assert record.key not in self.done, "a mission is asked for twice"
        self.done[record.key] = record


def test_what_is_named_is_near_the_best_of_all_pairs_and_not_above_the_experts_choice():
    near = 0
    for seed in range(20):
        wide, costs = invented(seed)
        search, found = Missions(wide, costs, seed).found()
        best = sum(min(own.values()) for own in costs.values())
        named = cost_of(found.winner, costs)
        near += named <= 1.05 * best
        assert named <= cost_of(arm_of(wide.experts), costs)
        assert found.finalists[0] == found.winner
        assert search._spent + found.starts * 8 * SECONDS <= 1.02 * 300.0
    assert near >= 18


def test_the_experts_choice_is_held_where_nothing_is_shown_to_be_cheaper():
    """Ways to explore make no difference, and each other way to avoid costs a little more than the experts'."""
    above = 0
    for seed in range(20):
        wide, costs = invented(seed)
        expert = wide.experts["Avoid"]
        costs |= {"Explore": dict.fromkeys(costs["Explore"], 20.0), "Avoid": dict.fromkeys(costs["Avoid"], 11.0)}
        costs["Avoid"][expert] = 10.0
        _, found = Missions(wide, costs, seed).found(minutes=0.7)
        above += expert not in found.winner
    assert above <= 2


def test_a_goal_races_again_beside_better_partners():
    near = 0
    for seed in range(10):
        wide, costs = invented(seed)
        worst = max(costs["Avoid"], key=costs["Avoid"].get)
        wide = replace(wide, experts={**wide.experts, "Avoid": worst})
        _, found = Missions(wide, costs, seed, cost=beside_bad_partners).found(choosers=())
        best = sum(min(own.values()) for own in costs.values())
        near += beside_bad_partners(found.winner, costs) <= 1.1 * best
    assert near >= 9


def test_each_round_has_starts_of_its_own_and_the_experts_choice_stays():
    wide, costs = invented(3)
    missions = Missions(wide, costs)
    search, _ = missions.found()
    used = [done.costs.shape[1] for done in search.rounds]
    starts = {int(scenario.removeprefix("train-")) for scenario, _ in missions.done}
    assert starts == set(range(1, sum(used) + 1))
    for done in search.rounds:
        if done.title.partition(",")[0] not in (*GOALS, "choosers"):
            assert arm_of(wide.experts) in done.arms


def test_the_end_is_the_same_in_any_order_and_after_a_kill():
    wide, costs = invented(5)
    _, expected = Missions(wide, costs).found()
    rng = np.random.default_rng(1)
    shuffled = Missions(wide, costs, order=lambda keys: [keys[k] for k in rng.permutation(len(keys))])
    assert shuffled.found()[1] == expected
    killed = Missions(wide, costs, order=lambda keys: keys[: max(len(keys) // 3, 1)])
    assert killed.found()[1] == expected


def test_arms_that_jam_stop_after_ten_starts_unless_all_do():
    wide, costs = invented(2)
    worst = [max(own, key=own.get) for own in costs.values()]
    jams = [f"fixed:{first}+{second}" for first in costs["Explore"] for second in [worst[1]]]
    missions = Missions(wide, costs, jams=jams)
    search, found = missions.found(minutes=60.0)
    assert found.winner not in jams
    assert search.stopped
    assert set(search.stopped) <= set(jams)
    counts = {arm: sum(other == arm for _, other in missions.done) for arm in search.stopped}
    assert set(counts.values()) == {JAMMED}
    everything = [f"fixed:{first}+{second}" for first in costs["Explore"] for second in costs["Avoid"]]
    search, found = Missions(wide, costs, jams=everything).found(minutes=60.0)
    assert not search.stopped
    assert found.starts >= LAST_FEWEST


def test_what_is_best_for_a_kind_of_start_stays_in_the_races_though_it_is_the_worst_elsewhere():
    for seed in range(5):
        wide, costs = invented(seed)
        worst = max(costs["Avoid"], key=costs["Avoid"].get)
        missions = Missions(wide, costs, seed, kind=lambda name: ("even", "odd")[int(name.rpartition("-")[2]) % 2])
        _, found = missions.found(choosers=())
        assert {kind: worst in arm.split("+") for kind, arm in found.kinds.items()} == {"odd": True, "even": False}
        assert worst not in found.winner.split("+")
        assert set(found.kinds.values()) <= set(found.finalists)


def truth(costs):
    """Learned scores by true costs."""
    return {
        goal: {name: LearnedScore(count=20, mean=-cost, variance=1.0) for name, cost in own.items()}
        for goal, own in costs.items()
    }


def upside_down(costs):
    """Learned scores that say the opposite."""
    return {
        goal: {name: LearnedScore(count=20, mean=cost, variance=1.0) for name, cost in own.items()}
        for goal, own in costs.items()
    }


def test_known_scores_save_missions_and_wrong_ones_do_no_harm():
    ratios = []
    for seed in range(8):
        costs = invented(seed)[1]
        wides = [invented(seed, learned=given)[0] for given in (None, truth, upside_down)]
        fresh, told, wrong = (Missions(wide, costs, seed) for wide in wides)
        best = sum(min(own.values()) for own in costs.values())
        ratios.append([cost_of(one.found()[1].winner, costs) / best for one in (fresh, told, wrong)])
        assert _of_goals(told) < 0.75 * _of_goals(fresh)
    assert np.mean(ratios, axis=0).max() <= 1.05


def _of_goals(missions):
    """Missions of the races of single goals."""
    search = missions.search()
    try:
        search.run()
    except Lacking:
        raise AssertionError("the search is not over") from None
    return sum(done.costs.size for done in search.rounds if done.title.partition(",")[0] in GOALS)
