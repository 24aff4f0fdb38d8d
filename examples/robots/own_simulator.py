"""A simulator of one's own in which five robots clean: wheels that err by 10 %, poses that err by 2 cm, grippers.

    python examples/robots/own_simulator.py

Bodies go through each other here. All that robots know of items is in `Sensed`, all that they do in `Wheels`.
"""

import numpy as np

from clean_swarm_env.robots.process import RobotProcess
from clean_swarm_env.robots.sensed import SeenItem, Sensed

ROBOTS, ITEMS, SIDE, STEP = 5, 10, 11.0, 0.04  # of the ground, a torus [m]; of the simulator [s]


def main() -> None:
    """Clean until all items are dumped, or 600 s are over."""
    rng = np.random.default_rng(1)
    robots = [RobotProcess("table1", row, "fixed:RepulsionGradient-view1.5") for row in range(ROBOTS)]
    places, headings = rng.uniform(1.0, 10.0, (ROBOTS, 2)), rng.uniform(-3.0, 3.0, ROBOTS)
    lying = {item: SeenItem(*rng.uniform(1.0, 10.0, 2).tolist()) for item in range(ITEMS)}
    cargo, recycled, dumped, call = [()] * ROBOTS, [False] * ROBOTS, 0, 0
    while dumped < ITEMS and call * STEP < 600.0:
        now = call * STEP
        for row, robot in enumerate(robots):
            x, y, heading = rng.normal([*places[row], headings[row]], 0.02)
            load = {"cargo": cargo[row], "recycled": recycled[row]}
            robot.sense(Sensed(stamp=now, x=x, y=y, heading=heading, items=dict(lying), **load))
        for said in [robot.say(now) for robot in robots] if call % 5 == 0 else ():
            for robot in robots:
                robot.hear(said)  # what a robot said itself does not count
        for row, robot in enumerate(robots):
            wheels = robot.step(now)
            if "PickGarbage" in wheels.handles and lying:
                item = min(lying, key=lambda one: apart(lying[one][:2], places[row]))
                cargo[row], recycled[row] = (item,), lying.pop(item).recycled
            if "Recycle" in wheels.handles:
                recycled[row] = True
            if "Dump" in wheels.handles:
                cargo[row], recycled[row], dumped = (), False, dumped + 1
            speed, turn_rate = rng.normal(1.0, 0.1, 2) * (wheels.speed, wheels.turn_rate)
            headings[row] = (headings[row] + STEP * turn_rate) % (2.0 * np.pi)
            places[row] += STEP * speed * np.array([np.cos(headings[row]), np.sin(headings[row])])
            places[row] %= SIDE
        call += 1
    print(f"{dumped} of {ITEMS} items were dumped within {call * STEP:.0f} s.")


def apart(one: object, other: object) -> float:
    """Return the distance of two places on the torus [m]."""
    return float(np.hypot(*((np.subtract(one, other) + SIDE / 2.0) % SIDE - SIDE / 2.0)))


if __name__ == "__main__":
    main()
