"""Robots of a laboratory in 40 lines: what each senses goes in, its wheels come out, and they tell each other of it.

    python examples/robots/lab_robot.py

These two are points that drive as they are told; put your drivers, localisation and radio in their place.
"""

from math import cos, sin, tau

from clean_swarm_env.robots.process import RobotProcess
from clean_swarm_env.robots.sensed import Sensed

SIDE, RATE = 3.0, 50.0  # of the ground, a torus [m]; calls a second, while a robot decides five times a second [1/s]
WORLD, TEAM = {"width": SIDE, "height": SIDE}, {"count": 2, "radius": 0.1}


def main() -> None:
    """Let two robots go round each other for a minute."""
    mission = {"task": "AgentCollisionAvoidance", "world": WORLD, "robots": TEAM}
    robots = [RobotProcess(mission, number, "fixed:ORCA", timeout=0.5) for number in range(2)]
    poses, way = [[0.5, 1.5, 0.0], [2.5, 1.5, 3.14]], 0.0
    for call in range(int(60.0 * RATE)):
        now = call / RATE
        for robot, (x, y, heading) in zip(robots, poses, strict=True):
            robot.sense(Sensed(stamp=now, x=x, y=y, heading=heading))
        if call % 10 == 0:  # once in a control period of 0.2 s
            for robot, other in zip(robots, reversed(robots), strict=True):
                other.hear(robot.say(now))
        for robot, pose in zip(robots, poses, strict=True):
            wheels = robot.step(now)
            pose[0] = (pose[0] + wheels.speed * cos(pose[2]) / RATE) % SIDE
            pose[1] = (pose[1] + wheels.speed * sin(pose[2]) / RATE) % SIDE
            pose[2] = (pose[2] + wheels.turn_rate / RATE) % tau
            way += wheels.speed / RATE
    print(f"The robots drove {way:.1f} m within {now:.0f} s.")


if __name__ == "__main__":
    main()
