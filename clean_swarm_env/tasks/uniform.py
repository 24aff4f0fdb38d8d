"""UniformDistribution: robots that start in one place spread evenly over the ground."""

from clean_swarm_env.config.tasks import TASKS, TaskSettings
from clean_swarm_env.tasks.measures.order import nearest_neighbours, unevenness
from clean_swarm_env.world.parts.measure import Measure
from clean_swarm_env.world.parts.things import TaskState
from clean_swarm_env.world.task import Task
from selforg.arrays import Floats


@TASKS.register
class UniformDistribution(Task[TaskSettings, TaskState]):
    """The measures are distances to the nearest neighbour: equal and large on a lattice, unequal by chance."""

    story = "24 robots from a square of 5 m x 5 m spread over a torus of 196 m2 within 120 s"
    measures = (
        Measure(
            "spread of nearest-neighbour distances / their mean",
            "-",
            "lower",
            0.26,
            "half of 0.52, which places at random give",
        ),
        Measure("mean nearest-neighbour distance", "m", "higher", 2.15, "0.7 of the 3.07 m on a hexagonal lattice"),
    )
    mission = {
        "world": {"width": 14.0, "height": 14.0},
        "robots": {"count": 24, "pose_diffusion": 3.0},
        "time_limit": 120.0,
    }
    fewest = 2
    apart, start_side = 0.6, 5.0

    def result(self) -> dict[str, Floats]:
        """Return how even and how far the robots are apart."""
        positions, ground = self.world.positions, self.world.ground
        return {
            "spread of nearest-neighbour distances / their mean": unevenness(positions, ground),
            "mean nearest-neighbour distance": nearest_neighbours(positions, ground).mean(axis=1),
        }
