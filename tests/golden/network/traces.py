"""Replays network.json: whole traces, every number of every step.

Where a planner took part, it is played by one that answers with the recorded plan, so that our own monitoring decides
when it is called and how far the plan has come.
"""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from selforg.arrays import Floats, Ints
from selforg.network import state as st
from selforg.network.model.model import NetworkModel
from selforg.network.network import BehaviourNetwork
from selforg.network.planning.memory import PlanMemory
from selforg.network.planning.planner import Planner
from selforg.network.planning.problem import PlanningProblem
from selforg.network.planning.search import Answer, ForwardSearch, State
from tests.golden.case import Case, SetAside, difference
from tests.golden.network import parts
from tests.golden.network.wishes import behaviour_wishes, goal_wishes

ROW = np.array([0])
EVENTS: dict[str, Callable[..., None]] = {
    "finish": BehaviourNetwork.finish,
    "enable": BehaviourNetwork.enable,
    "priority": BehaviourNetwork.set_priority,
    "manual_start": BehaviourNetwork.start_by_hand,
    "remove": BehaviourNetwork.remove,
}
MARKS = {"executing": st.EXECUTING, "executable": st.READY, "enabled": st.ENABLED}


class Forgetful(PlanMemory):
    """Remembers nothing, so that every call of the planner can be counted."""

    def __init__(self, goals: int) -> None:
        super().__init__([], [], [], goals)

    def insert(self, key: Ints, behaviours: Iterable[int] | None) -> None:
        """Forget the plan at once."""


class CountedSearch(ForwardSearch):
    """Counts the sets of goals that are tried, each a call of the planner in the original."""

    def __init__(self, problem: PlanningProblem) -> None:
        super().__init__(problem)
        self.calls = 0

    def plan_from(self, state: State, goals: tuple[int, ...]) -> Answer:
        """Count the call and search."""
        self.calls += 1
        return super().plan_from(state, goals)


class RecordedPlanner(Planner):
    """Answers with the plan that was recorded for this step, and counts how often it is asked.

    `model` is given where the recorded planner was a real one: its goals are then tried set by set, which is what the
    original counts.
    """

    def __init__(self, goals: int, model: NetworkModel | None = None) -> None:
        self.memory = Forgetful(goals)
        self.answer: list[int] | None = None
        self._calls = 0
        self._searches: list[CountedSearch] = []
        self._own = model and Planner(model, self._make_search)

    @property
    def calls(self) -> int:
        """How often the original would have asked its planner."""
        return self._calls + sum(search.calls for search in self._searches)

    def plan(self, readings: Floats, alternatives: Ints, goal_enabled: Ints) -> list[int] | None:
        """Return the recorded plan."""
        if self._own is None:
            self._calls += 1
        else:
            self._own.plan(readings, alternatives, goal_enabled)
        return self.answer

    def _make_search(self, problem: PlanningProblem) -> CountedSearch:
        self._searches.append(CountedSearch(problem))
        return self._searches[-1]


def replay(case: Case) -> str | None:
    """Return how the replay differs from the original, None if it agrees."""
    model = parts.model(case.inputs)
    planner = recorded_planner(model, case.inputs["planner"])
    network = BehaviourNetwork(model, 1, planner)
    network.read(dict(case.inputs["sensors"]))
    disabled = False
    for number, (step, expected) in enumerate(zip(case.inputs["steps"], case.expected["steps"], strict=True)):
        apply(network, step)
        disabled = disabled or any(is_disabling(event) for event in step.get("events") or ())
        calls = prepare(planner, network, expected)
        network.step(guarantee=bool(step.get("guarantee_decision")))
        if "error" in expected:  # Q19: what led there agrees, and ours does not crash; nothing is recorded beyond
            return None
        got = whole_step(network, expected, planner and planner.calls - calls)
        wrong = difference(expected, got, f"step {number}")
        if wrong:
            if disabled:
                raise SetAside("Q16")
            return wrong
    return None


def recorded_planner(model: NetworkModel, given: dict[str, Any] | None) -> RecordedPlanner | None:
    """Return the planner of a case, None if it is off."""
    if given is None:
        return None
    return RecordedPlanner(len(model.goals), model if given["type"] == "metric-ff" else None)


def is_disabling(event: dict[str, Any]) -> bool:
    """Tell whether an event switches a behaviour off."""
    return event["type"] == "enable" and not event["value"]


def apply(network: BehaviourNetwork, step: dict[str, Any]) -> None:
    """Set the sensors of a step and let its events happen."""
    network.read(step["sensors"])
    for event in step.get("events") or ():
        kind, value = event["type"], event.get("value")
        if kind == "goal_enable":
            goal_name = event["goal"] if "goal" in event else event["behaviour"]
            network.enable_goal(ROW, network.model.goal_index[goal_name], value)
            continue
        behaviour = network.model.behaviour_index[event["behaviour"]]
        given = () if value is None else (value,)
        EVENTS[kind](network, ROW, behaviour, *given)


def prepare(planner: RecordedPlanner | None, network: BehaviourNetwork, expected: dict[str, Any]) -> int:
    """Let the planner answer with the plan of this step; return how often it was asked until now."""
    if planner is None:
        return 0
    plan = expected.get("plan")
    planner.answer = None if plan is None else [network.model.behaviour_index[name] for name in plan]
    return planner.calls


def whole_step(network: BehaviourNetwork, expected: dict[str, Any], calls: int | None) -> dict[str, Any]:
    """Return everything that is recorded of a step, as the network sees it."""
    state, model = network.state, network.model
    got = {
        "threshold": float(state.row_values[0, st.THRESHOLD]),
        "total_activation_before": float(state.row_values[0, st.TOTAL]),
        "running": in_order_of(expected["running"], network),
        "behaviours": {name: behaviour(network, name) for name in expected["behaviours"]},
        "goals": {name: goal(network, name) for name in expected["goals"]},
    }
    if calls is not None:
        known, length = network.state.plan_marks[0, st.PLAN_KNOWN], network.state.plan_marks[0, st.PLAN_LENGTH]
        steps = [model.behaviours[b].name for b in network.state.plan[0, :length]]
        got["plan"] = steps if known else None
        got["plan_index"] = int(network.state.plan_marks[0, st.PLAN_INDEX])
        got["planner_calls"] = calls
    return got


def in_order_of(recorded: list[str], network: BehaviourNetwork) -> list[str]:
    """Return the names of what runs, in the recorded order as far as it goes."""
    running = [b.name for b, on in zip(network.model.behaviours, network.executing[0], strict=True) if on]
    return sorted(running, key=lambda name: recorded.index(name) if name in recorded else len(recorded))


def behaviour(network: BehaviourNetwork, name: str) -> dict[str, Any]:
    """Return what is recorded of a behaviour."""
    state, b = network.state, network.model.behaviour_index[name]
    return {
        "components": {key: float(state.values[0, layer, b]) for key, layer in st.COMPONENTS.items()},
        "activation": float(state.values[0, st.ACTIVATION, b]),
        "satisfaction": float(state.values[0, st.SATISFACTION, b]),
        "execution_time": int(state.marks[0, st.EXECUTION_TIME, b]),
        "wishes": sorted(map(list, behaviour_wishes(network, 0, name))),
        **{key: bool(state.marks[0, mark, b]) for key, mark in MARKS.items()},
    }


def goal(network: BehaviourNetwork, name: str) -> dict[str, Any]:
    """Return what is recorded of a goal."""
    state, g = network.state, network.model.goal_index[name]
    return {
        "satisfaction": float(state.goal_satisfaction[0, g]),
        "enabled": bool(state.goal_enabled[0, g]),
        "wishes": sorted(map(list, goal_wishes(network, 0, name))),
    }
