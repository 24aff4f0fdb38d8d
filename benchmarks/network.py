"""Speed of the behaviour network and its planner, beside the original's figures from golden/README.md.

Run with `python -m benchmarks.network`. CPU time, best of several repeats. Exit code 1 if a requirement is missed.

A network of B behaviours has B sensors, half of them facts, and three goals; each behaviour has two preconditions and
two effects. Every step reads new values.
"""

import sys
import time
from statistics import median

import numpy as np
from numpy.typing import NDArray

from selforg.network.model.activators import Boolean, Linear, Threshold
from selforg.network.model.behaviours import Behaviour, Effect, Goal, Sensor
from selforg.network.model.conditions import Condition
from selforg.network.model.model import NetworkModel
from selforg.network.network import BehaviourNetwork
from selforg.network.planning.planner import Planner
from tests.selforg.network.cleaning import cleaning_model, wandering

# The original on a 2.1 GHz Xeon core, ROS replaced by in-process calls: one step of one robot [s]
ORIGINAL = {5: 1.3e-3, 10: 3.4e-3, 20: 17e-3}
REPEATS, DIFFERENT = 7, 8

Result = tuple[str, str, bool]


def random_model(behaviours: int, seed: int = 0) -> NetworkModel:
    """Return a network with as many sensors as behaviours."""
    rng = np.random.default_rng(seed)
    facts = behaviours // 2
    sensors = [Sensor(f"s{k}", "fact" if k < facts else "number") for k in range(behaviours)]

    def condition() -> Condition:
        sensor = sensors[rng.integers(behaviours)]
        if sensor.kind == "fact":
            return Condition(sensor.name, Boolean(bool(rng.random() < 0.5)))
        return Condition(sensor.name, Linear(0.0, 5.0) if rng.random() < 0.5 else Threshold(2.0, value_range=4.0))

    def effect() -> Effect:
        return Effect(sensors[rng.integers(behaviours)].name, float(rng.uniform(-1.0, 1.0)))

    made = [
        Behaviour(f"b{k}", (condition(), condition()), (effect(), effect()), ready_threshold=0.3)
        for k in range(behaviours)
    ]
    return NetworkModel(sensors, made, [Goal(f"g{k}", (condition(),)) for k in range(3)])


def changing_readings(model: NetworkModel, rows: int, seed: int = 1) -> NDArray[np.float64]:
    """Return DIFFERENT readings (T, R, S)."""
    rng = np.random.default_rng(seed)
    numbers = rng.uniform(0.0, 6.0, (DIFFERENT, rows, len(model.sensors)))
    facts = np.array([sensor.kind == "fact" for sensor in model.sensors])
    return np.where(facts, (numbers < 3.0).astype(float), numbers)


def seconds_per_step(network: BehaviourNetwork, readings: NDArray[np.float64]) -> float:
    """Return the CPU time of one step of all rows [s]."""
    steps = max(len(readings), min(4000, 40_000 // network.rows))
    best = np.inf
    for _ in range(REPEATS):
        begin = time.process_time()
        for step in range(steps):
            network.readings[:] = readings[step % len(readings)]
            network.step()
        best = min(best, (time.process_time() - begin) / steps)
    return best


def against_the_original() -> list[Result]:
    """Return the figures of networks of 10 and 20 behaviours without a planner."""
    told = []
    for behaviours, rows, factor in ((5, 1, 50), (10, 1, 50), (20, 1, 50), (10, 320, 500), (20, 1000, 500)):
        model = random_model(behaviours)
        taken = seconds_per_step(BehaviourNetwork(model, rows), changing_readings(model, rows))
        ratio = ORIGINAL[behaviours] / (taken / rows)
        told.append(
            (
                f"{behaviours} behaviours, {rows} robots",
                f"{taken * 1e6:8.1f} us a step, {taken / rows * 1e6:5.2f} us a robot, {ratio:6.0f} times (>= {factor})",
                ratio >= factor,
            )
        )
        if rows == 1000:
            told.append(("1,000 robots x 20 behaviours", f"{taken * 1e3:8.2f} ms (< 10, aim 4)", taken < 10e-3))
    return told


def by_rows() -> Result:
    """Return the growth of the cost per robot with the number of robots."""
    model = random_model(10)
    sizes = (10, 100, 1000, 10_000)
    costs = [seconds_per_step(BehaviourNetwork(model, n), changing_readings(model, n)) / n for n in sizes]
    shown = ", ".join(f"{n}: {cost * 1e6:.2f}" for n, cost in zip(sizes, costs, strict=True))
    growth = costs[-1] / costs[0]
    return "us a robot by robots", f"{shown} (grows {growth:.2f} times, < 1.3)", growth < 1.3


def planner() -> list[Result]:
    """Return the cost of planning on the robot model: a search, and a step whose plans are mostly remembered."""
    model, rows = cleaning_model(), 320
    built_in = Planner(model)
    goals, held = np.ones(len(model.goals), np.int64), np.zeros(len(model.behaviours), np.int64)
    searches = []
    for reading in wandering(np.random.default_rng(0), 200, 1)[:, 0]:
        begin = time.process_time()
        built_in.plan(reading, held, goals)
        searches.append(time.process_time() - begin)
    readings = wandering(np.random.default_rng(1), 50, rows)
    plain = seconds_per_step(BehaviourNetwork(model, rows), readings) / rows
    network = BehaviourNetwork(model, rows, Planner(model))
    seconds_per_step(network, readings)
    planned = seconds_per_step(network, readings) / rows
    call = median(searches)
    return [
        ("built-in planner, robot model", f"median {call * 1e3:.3f} ms a call (< 1)", call < 1e-3),
        ("robot model, 320 robots", f"{plain * 1e6:.2f} us a robot, {planned * 1e6:.2f} with plans", True),
    ]


def main() -> int:
    """Print all figures; return 1 if one misses its requirement."""
    results = [*against_the_original(), by_rows(), *planner()]
    for name, figures, fine in results:
        print(f"{name:40} {figures}{'' if fine else '   MISSED'}")
    return 0 if all(fine for *_, fine in results) else 1


if __name__ == "__main__":
    sys.exit(main())
