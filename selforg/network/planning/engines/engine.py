"""Any engine of the unified-planning library in place of the built-in search, by name (extra `planning`)."""

from typing import Any

import numpy as np

from selforg.network.planning.engines.unified import environment, to_unified
from selforg.network.planning.engines.whole_numbers import in_whole_numbers
from selforg.network.planning.problem import PlanningProblem
from selforg.network.planning.search import Answer, Search, State, Unknown, Unsolvable


def check_engine(engine: str) -> None:
    """Refuse a name of an engine that is not installed.

    Raises:
        ValueError: an engine that is not installed; lists those that are.
        ModuleNotFoundError: the extra `planning` is not installed.

    """
    known = environment().factory.engines
    if engine not in known:
        raise ValueError(f"unknown planning engine {engine!r} (installed: {', '.join(sorted(known))})")


class EngineSearch(Search):
    """Asks an engine for plans; their cost and order are as good as the engine makes them.

    The engine gets the problem in whole numbers (see `whole_numbers`), because several engines know no others.

    Args:
        problem: facts, numbers, actions and goals.
        engine: name of an engine that is installed, such as "aries".
        timeout: time after which the answer is `Unknown` [s]; None waits.

    Raises:
        ValueError: an engine that is not installed; lists those that are.
        ModuleNotFoundError: the extra `planning` is not installed.

    """

    def __init__(self, problem: PlanningProblem, engine: str, timeout: float | None = 10.0) -> None:
        super().__init__(problem)
        check_engine(engine)
        self.engine = engine
        self.timeout = timeout

    def plan_from(self, state: State, goals: tuple[int, ...]) -> Answer:
        """Return the engine's answer for a state that `read_state` gave."""
        self.goal_condition(goals)
        counted, readings = in_whole_numbers(self.problem, state)
        facts = np.array([state[0] >> fact & 1 for fact in range(len(self.problem.facts))], dtype=np.bool_)
        task = to_unified(counted, facts, np.array(readings, dtype=np.float64), goals)
        with environment().factory.OneshotPlanner(name=self.engine) as planner:
            if not planner.supports(task.kind):
                raise ValueError(f"engine {self.engine!r} cannot read this problem: {task.kind.features}")
            return self._outcome(planner.solve(task, timeout=self.timeout))

    def _outcome(self, result: Any) -> Answer:  # noqa: ANN401  (optional library)
        if result.plan is not None:
            indices = {action.name: index for index, action in enumerate(self.problem.actions)}
            return self.found(tuple(indices[step.action.name] for step in result.plan.actions))
        if result.status.name == "UNSOLVABLE_PROVEN":
            return Unsolvable()
        if result.status.name in ("UNSOLVABLE_INCOMPLETELY", "TIMEOUT", "MEMOUT"):
            return Unknown(0)
        raise RuntimeError(f"engine {self.engine!r} failed with {result.status.name}")
