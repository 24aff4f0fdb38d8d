from clean_swarm_env.scenes.arena import Arena, Body
from clean_swarm_env.scenes.ground import Ground


def test_bodies_are_those_of_the_paper_unless_a_scene_says_otherwise():
    """Radius 0.25 m, 1 m/s; the pose that a robot spreads has a goal radius of 0.5 m and a diffusion of 1.0 m."""
    arena = Arena(Ground("torus", 10.0, 20.0), 3, [1, 2], Body())
    assert arena.poses.radii.tolist() == [[1.0, 0.5]] * 6
    assert (arena.physics.settings.radius, arena.drive.settings.max_speed) == (0.25, 1.0)
    assert (arena.physics.settings.contacts, arena.body.drive) == ("solid", "differential")
