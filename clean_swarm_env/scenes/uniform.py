"""UniformDistribution: robots that start in one place spread evenly over the ground."""

from clean_swarm_env.scenes.arena import Body
from clean_swarm_env.scenes.measures.order import nearest_neighbours, unevenness
from clean_swarm_env.scenes.scene import SCENES, Measure, Scene, Setting
from selforg.arrays import Floats


@SCENES.register
class UniformDistribution(Scene):
    """The measures are distances to the nearest neighbour: equal and large on a lattice, unequal by chance."""

    goal = "UniformDistribution"
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
    setting = Setting(robots=24, seconds=120.0, ground="torus")
    fewest = 2
    side = 14.0
    apart, start_side = 0.6, 5.0
    body = Body(pose_diffusion=3.0)

    def _result(self) -> dict[str, Floats]:
        nearest = nearest_neighbours(self.positions, self.ground).mean(axis=1)
        return {
            "spread of nearest-neighbour distances / their mean": unevenness(self.positions, self.ground),
            "mean nearest-neighbour distance": nearest,
        }
