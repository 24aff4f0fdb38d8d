"""The tick of the full stack at all sizes, beside pymunk alone on the same bodies in the same run.

    python -m benchmarks.tick

One process, CPU time. Tick and floor take turns, and ratios are taken in each round, because a busy machine slows both.
`late` is the tick after 3,000 simulated seconds without garbage, when all robots patrol and many pheromones are stored.
Figures go to `results.json`.
"""

from collections.abc import Callable

from benchmarks.floor import Floor, floor_at_start
from benchmarks.shared.measuring import Figure, by_turns, growth, middle, ratio, seconds_per_call
from benchmarks.shared.parts import parts_of_a_tick
from benchmarks.shared.record import record
from benchmarks.shared.scenes import mission_of, worlds_at_start
from clean_swarm_env.world.worlds import Worlds

SIZES = ((1, 5), (64, 5), (256, 5), (1, 50), (1, 200), (1, 1000), (1, 10_000))
"""(W, N): worlds and robots in each."""
WARM_UP = 20.0  # [s] of the mission before anything is measured
ROBOT_TICKS = 20_000  # a repeat, at most 300 ticks and at least 10
EARLY, LATE, WINDOW = 100.0, 3000.0, 40.0  # [s]
LATE_SIZES = ((1, 5), (64, 5))


def name_of(worlds: int, robots: int) -> str:
    """Return the name of a size in the results."""
    return f"{worlds} x {robots}"


def run_until(worlds: Worlds, seconds: float) -> Worlds:
    """Run the worlds until `seconds` after their reset."""
    while worlds.ticks[0] * worlds.period < seconds:
        worlds.tick()
    return worlds


def ticks_of(worlds: int, robots: int) -> int:
    """Return how many ticks one repeat measures."""
    return min(max(ROBOT_TICKS // (worlds * robots), 10), 300)


def floor_of(worlds: int, robots: int) -> Callable[[], float]:
    """Return a contestant that gives the CPU seconds of a tick of pymunk alone."""
    width = mission_of(robots).world.width
    ticks = ticks_of(worlds, robots)
    floor: Floor = floor_at_start(worlds, robots, width)
    return lambda: seconds_per_call(floor.walk, ticks)


def tick_and_floor(worlds: int, robots: int) -> tuple[Figure, Figure, Figure]:
    """Return CPU microseconds of a tick per world, of the floor per world, and the ratio of both."""
    made = run_until(worlds_at_start(mission_of(robots), worlds), WARM_UP)
    ticks = ticks_of(worlds, robots)
    told = by_turns(
        {"tick": lambda: seconds_per_call(made.tick, ticks), "floor": floor_of(worlds, robots)}
    )  # fmt: skip
    per_world = {name: Figure.of([1e6 * time / worlds for time in times]) for name, times in told.items()}
    return per_world["tick"], per_world["floor"], ratio(told["tick"], told["floor"])


def early_and_late(worlds: int, robots: int) -> dict[str, float]:
    """Return CPU microseconds of a tick per world where all robots patrol, early and late, and pheromones stored."""
    made = worlds_at_start(mission_of(robots, items_per_robot=0.0), worlds)
    floor, figures = floor_of(worlds, robots), {}
    ticks = round(WINDOW / made.period / 8)
    for name, moment in (("early", EARLY), ("late", LATE)):
        run_until(made, moment)
        told = by_turns({"tick": lambda: seconds_per_call(made.tick, ticks), "floor": floor})
        figures[f"{name} tick [us]"] = 1e6 * middle(told["tick"]) / worlds
        figures[f"{name} tick / floor"] = ratio(told["tick"], told["floor"]).value
        figures[f"{name} pheromones per world"] = made.minds.buffers["pheromones"].count(0, "pheromone")
    figures["late / early"] = figures["late tick / floor"] / figures["early tick / floor"]
    return figures


def main() -> None:
    """Print and record the figures."""
    all_sizes()
    all_parts()
    all_ages()


def all_sizes() -> None:
    """Measure tick, floor and their growth."""
    ticks, floors, ratios, spreads = {}, {}, {}, {}
    print("CPU time of a tick (0.2 s) per world [us], median of 7 repeats by turns; ratio round by round")
    print("worlds x robots      tick     floor     ratio   spread   ticks/s")
    for worlds, robots in SIZES:
        tick, floor, times = tick_and_floor(worlds, robots)
        name = name_of(worlds, robots)
        ticks[name], floors[name], ratios[name], spreads[name] = tick.value, floor.value, times.value, times.spread
        print(
            f"{name:>15}{tick.value:10.1f}{floor.value:10.1f}{times.value:10.2f}{times.spread:9.0%}"
            f"{1e6 / tick.value:10.0f}",
            flush=True,
        )
    robots = [n for w, n in SIZES if w == 1 and n >= 50]
    exponent, fit = growth(robots, [ticks[name_of(1, n)] for n in robots])
    below, below_fit = growth(robots, [floors[name_of(1, n)] for n in robots])
    largest, _ = growth(robots[-2:], [ticks[name_of(1, n)] for n in robots[-2:]])
    print(f"growth from {robots[0]} to {robots[-1]} robots: exponent {exponent:.2f} (R2 {fit:.3f}), floor {below:.2f}")
    print(f"growth from {robots[-2]} to {robots[-1]} robots: exponent {largest:.2f}")
    record("tick", {"tick [us]": ticks, "floor [us]": floors, "tick / floor": ratios, "spread of tick / floor": spreads,
                    "growth": {"exponent": exponent, "R2": fit, "exponent of the floor": below,
                               "R2 of the floor": below_fit, "exponent from 1,000 robots": largest}})  # fmt: skip


def all_parts() -> None:
    """Measure the parts of a tick."""
    parts = {}
    for worlds, robots in SIZES:
        made = run_until(worlds_at_start(mission_of(robots), worlds), WARM_UP)
        shares = parts_of_a_tick(made, max(ticks_of(worlds, robots) // 10, 2))
        parts[name_of(worlds, robots)] = {part: time / worlds for part, time in shares.items()}
        told = ", ".join(f"{part} {time:.1f}" for part, time in parts[name_of(worlds, robots)].items())
        print(f"{name_of(worlds, robots):>15} parts [us]: {told}", flush=True)
    record("parts [us]", parts)


def all_ages() -> None:
    """Measure ticks early and late in a mission."""
    ages = {}
    for worlds, robots in LATE_SIZES:
        ages[name_of(worlds, robots)] = early_and_late(worlds, robots)
        told = ", ".join(f"{what} {figure:.4g}" for what, figure in ages[name_of(worlds, robots)].items())
        print(f"{name_of(worlds, robots):>15} patrol alone: {told}", flush=True)
    record("late", ages)


if __name__ == "__main__":
    main()
