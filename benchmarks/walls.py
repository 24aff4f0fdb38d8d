"""What walls cost: ticks of 64 worlds of five robots, and steps of a batch whose robots observe rays.

    python -m benchmarks.walls

Ratios to the same worlds without walls, and to the same batch without rays, by turns. The 20 walls are a metre long and
lie anywhere except near stations, so that robots meet some all the time.
"""

from collections.abc import Callable, Iterator

import numpy as np

from benchmarks.shared.measuring import Figure, by_turns, ratio, seconds_per_call
from benchmarks.shared.record import record
from benchmarks.shared.scenes import mission_of, worlds_at_start
from clean_swarm_env.config.load import with_changes
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.observation.config import ObservationConfig

WORLDS, ROBOTS, WALLS = 64, 5, 20
LENGTH = 1.0  # of a wall [m]
RAYS, FARTHEST = 8, 3.0  # m
WARM, TICKS, STEPS, REPEATS = 100, 10, 5, 15
BLOCKED = ("", "sight", "messages", "pheromones")
"""What walls block besides bodies; "": nothing."""


def walled(blocked: str = "") -> MissionConfig:
    """Return the mission with walls that block this."""
    plain = mission_of(ROBOTS).model_dump()
    random, walls = np.random.default_rng(1), list[dict[str, object]]()
    while len(walls) < WALLS:
        along = random.uniform(-np.pi, np.pi)
        begin = random.uniform((LENGTH, LENGTH), (plain["world"]["width"] - LENGTH, plain["world"]["height"] - LENGTH))
        end = begin + LENGTH * np.array([np.cos(along), np.sin(along)])
        tried = [*walls, {"corners": [begin.tolist(), end.tolist()]}]
        changed = with_changes(plain, {"world": {"walls": tried, "walls_block": [blocked] if blocked else []}})
        try:
            mission = MissionConfig.model_validate(changed)
        except ValueError:  # too near to a station, or a room without a door
            continue
        walls = tried
    return mission


def ticking(mission: MissionConfig) -> Callable[[], float]:
    """Return a contestant that gives the CPU seconds of a tick."""
    worlds = worlds_at_start(mission, WORLDS)
    for _ in range(WARM):
        worlds.tick()
    return lambda: seconds_per_call(worlds.tick, TICKS)


def observing(mission: MissionConfig, terms: list[str | dict[str, object]]) -> Callable[[], float]:
    """Return a contestant that gives the CPU seconds of a step of a batch with these observations."""
    batch = Batch(mission, WORLDS, observation=ObservationConfig(terms=terms))
    batch.reset(range(WORLDS))
    held = [0] * batch.rows
    return lambda: seconds_per_call(lambda: batch.step(held), STEPS)


def ratios() -> Iterator[tuple[str, Figure]]:
    """Yield what it is about, and the ratio."""
    empty = mission_of(ROBOTS)
    ticks = by_turns({None: ticking(empty), **{blocked: ticking(walled(blocked)) for blocked in BLOCKED}}, REPEATS)
    for blocked in BLOCKED:
        what = f"{WALLS} walls" + (f" that block {blocked}" if blocked else "")
        yield f"{what}, to none", ratio(ticks[blocked], ticks[None])
    lidar: dict[str, object] = {"name": "lidar", "rays": RAYS, "farthest": FARTHEST}
    for where, mission in {"without walls": empty, f"among {WALLS} walls": walled()}.items():
        steps = by_turns({k: observing(mission, ["cargo", *([lidar] * k)]) for k in (False, True)}, REPEATS)
        yield f"{RAYS} rays {where}, to none", ratio(steps[True], steps[False])


def main() -> None:
    """Print and record the ratios."""
    figures = {}
    for what, figure in ratios():
        print(f"{what:40}{figure.value:6.2f}  middle half within {figure.spread:.0%}")
        figures[what] = {"ratio": figure.value, "spread": figure.spread}
    record("walls", figures)


if __name__ == "__main__":
    main()
