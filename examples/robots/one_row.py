"""One robot runs its program without a world: poses that it hears are gradients, its commands are vectors [m/s].

    python examples/robots/one_row.py

Whoever has sensors and hears others can do this. `lab_robot.py` has missions, policies, steering, and a watchdog.
"""

import numpy as np

from selector.configurations.host import Host
from selector.configurations.library import Library
from selector.coordination.model import CoordinatorModel
from selector.coordination.robots import CoordinatedRobots
from selector.knowledge import load_knowledge
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.gradient import Gradient
from selforg.gradients.poses import OwnPoses
from selforg.gradients.settings import BufferSettings
from selforg.space import Euclidean


def main() -> None:
    """Let a robot pass another one that stands in its way."""
    poses = OwnPoses(Euclidean(2), rows=1)
    heard = SoBuffer(BufferSettings(), poses.space, poses)
    model = CoordinatorModel("UniformDistribution", load_knowledge("library"), Library())
    robot = CoordinatedRobots(model, Host(poses, {"gradients": heard}))
    robot.hold(np.array([model.options.index("RepulsionGradient-view1.5")]))
    place = np.array([[0.0, 0.0]])
    for tick in range(50):
        now = 0.2 * tick
        poses.update(place, np.zeros(1), now)
        heard.receive(Gradient("robot", (1.0, 0.5), "other", (), -1, 1.0, 0.5, stamp=now, moving=True), now, row=0)
        place = place + 0.2 * robot.tick(now).vectors
    print(f"The robot went from [0, 0] to {place[0].round(1)}, away from the other at [1, 0.5].")


if __name__ == "__main__":
    main()
