"""`python -m tests.clean_swarm_env.soak_states [COUNT]`: damaged states at every border that takes states.

COUNT (10,000) times a bit of a state is flipped, bytes are cut out of it, or parts change places, with a state of
another border too. Each is refused by a ValueError of one line, and what refuses it stays as it was. Every border has
a process of its own, so that a crash is noticed.
"""

import os
import re
import subprocess
import sys
from functools import cache, partial
from importlib.util import find_spec
from typing import Any

import numpy as np

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.borders.gymnasium_team import CleanSwarmTeam
from clean_swarm_env.borders.gymnasium_vector import TeamVectorEnv
from clean_swarm_env.learning.batch import Batch
from tests.clean_swarm_env.copies import MISSIONS
from tests.clean_swarm_env.courses import CROWD, worlds_at_start
from tests.paths import ROOT
from tests.soaking import SECONDS, report, rounds, time_limit

SEED = 2028
STEPS = 8


def worlds() -> Any:
    made = worlds_at_start(CROWD, [5, 6])
    for _ in range(STEPS):
        made.tick()
    return made


def batch(kind: type, *arguments: Any, **settings: Any) -> Any:
    made = kind(*arguments, **settings)
    made.reset(list(range(3, 3 + made.count)))
    for _ in range(STEPS):
        made.step(np.zeros((made.rows, 2)) if made.action.mode == "velocity" else np.zeros((made.rows, 1), np.int64))
    return made


def parallel(**settings: Any) -> Any:
    made = clean_swarm_v0.parallel_env(**settings)
    made.reset(seed=3)
    for _ in range(STEPS):
        made.step(dict.fromkeys(made.agents, 0))
    return made


def gymnasium(made: Any) -> Any:
    made.reset(seed=3)
    for _ in range(STEPS):
        made.step(np.zeros(made.action_space.shape, np.int64))
    return made


def stable_baselines3() -> Any:
    from clean_swarm_env.sb3 import RobotVecEnv  # imports torch

    made = RobotVecEnv(batches=[Batch("table1"), Batch("table1", 2)])
    made.seed(3)
    made.reset()
    for _ in range(STEPS):
        made.step(np.zeros(made.num_envs, np.int64))
    return made


BORDERS = {
    "Worlds": worlds,
    "Batch": partial(batch, Batch, MISSIONS["late and noisy"], 2),
    "Batch of a family": partial(batch, Batch, family="shifting", action={"mode": "velocity"}),
    "Batch of a task": partial(batch, Batch, {"task": "Foraging"}, 2),
    "parallel_env": partial(parallel, mission=MISSIONS["own contents"]),
    "parallel_env of a task": partial(parallel, mission={"task": "MaxValue"}),
    "CleanSwarmTeam": lambda: gymnasium(CleanSwarmTeam(MISSIONS["crowd"])),
    "TeamVectorEnv": lambda: gymnasium(TeamVectorEnv(2, mission=MISSIONS["pass through"])),
}
"""Name -> something that takes states; no two have the same mission and kind."""
if find_spec("stable_baselines3"):
    BORDERS["RobotVecEnv"] = stable_baselines3


@cache
def begun(name: str) -> Any:
    return BORDERS[name]()


def damaged(state: bytes, other: bytes, rng: np.random.Generator) -> bytes:
    """Return a state after one random damage; `other` is one that does not fit where `state` does."""
    size, way = len(state), int(rng.integers(8))
    head = 100 if rng.random() < 0.3 else size  # many at the beginning, where little is
    first, last = sorted(rng.integers(0, head + 1, 2).tolist())
    if way < 3:
        place = first - (first == size)
        return state[:place] + bytes([state[place] ^ 1 << int(rng.integers(8))]) + state[place + 1 :]
    if way == 3:
        return state[:first] + state[last:]
    if way == 4:
        return state[:first]
    if way == 5:  # neighbours change places
        middle = (first + last) // 2
        return state[:first] + state[middle:last] + state[first:middle] + state[last:]
    if way == 6:
        return state[:first] + other[first:last] + state[last:]
    return (other, state + other, state[:first] + other[first:], b"")[int(rng.integers(4))]


def refused(name: str, number: int, own: bytes) -> str:
    """Return what is wrong with the answer to a damaged state, nothing if it is refused as it should be."""
    rng, made = np.random.default_rng([SEED, list(BORDERS).index(name), number]), begun(name)
    others = [other for other in BORDERS if other != name]
    state = damaged(own, saved(others[number % len(others)]), rng)
    if state == own:
        return ""
    try:
        made.set_state(state)
    except ValueError as error:
        text = str(error)
        wrong = "" if text and len(text.splitlines()) == 1 else f"not one line: {text!r}"
        return wrong if made.get_state() == own else f"a refused state changed it: {text}"
    except Exception as error:
        return f"{type(error).__name__}: {error}"
    return "taken without a word"


@cache
def saved(name: str) -> bytes:
    state: bytes = begun(name).get_state()
    return state


def tried(name: str, count: int) -> int:
    """Damage `count` states at one border; return how often the answer was wrong, each in a line."""
    wrong = 0
    for number in rounds(count):
        print(f"{name} {number}", flush=True)
        said = refused(name, number, saved(name))
        if said:
            wrong += 1
            print(f"{name}, {number}: {said[:300]}", file=sys.stderr)
            begun.cache_clear()
    return wrong


def main(arguments: list[str]) -> int:
    """Run the rounds, each border's in a process of its own; return 1 if any went wrong."""
    if len(arguments) > 1:
        return 1 if tried(arguments[0], int(arguments[1])) else 0
    count, total, fell = int(arguments[0]) if arguments else 10_000, 0, 0
    for name in BORDERS:
        command = [sys.executable, "-m", "tests.clean_swarm_env.soak_states", name, str(-(-count // len(BORDERS)))]
        environment = {**os.environ, SECONDS: f"{time_limit() / len(BORDERS):g}"}
        done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
        total += len(re.findall(rf"^{name} \d+$", done.stdout, re.MULTILINE))
        wrong = re.findall(rf"^{name}, \d+: .*$", done.stderr, re.MULTILINE)
        crashed = done.returncode not in (0, 1) or (done.returncode == 1 and not wrong)
        fell += len(wrong) + crashed
        print(*wrong, f"{name}: {done.returncode}\n{done.stderr[-2000:]}" if crashed else f"{name}: done", sep="\n")
    print(f"{total} damaged states at {len(BORDERS)} borders, seed {SEED}")
    report(total, total - fell)
    return 1 if fell else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
