"""Policies say where they meet what they never saw, and where they decide some goals only."""

import pytest

from clean_swarm_env.config.load import load_mission
from clean_swarm_env.deciders.named import decider_named
from clean_swarm_env.deciders.unseen import unseen
from selector.strategies.policy_file import find_policy, load_policy
from train.live.chosen import AVOIDING, TRAINED, chosen, remarks, usual, with_room


@pytest.mark.parametrize(
    ("mission", "expected"),
    [
        ("exploring", []),
        ("three-rooms", ["walled ground", "walls"]),
        ("silent-zone", ["zones"]),
        ("scouts", ["robots of several models"]),
        ("table1", ["5 robots (6 to 30)"]),
    ],
)
def test_what_the_shipped_policy_never_saw(mission, expected):
    training = load_policy(find_policy("one")).spec.training
    assert unseen(training, [load_mission(mission)]) == expected
    assert unseen({}, [load_mission(mission)]) == []
    assert unseen({"configuration": {"tasks": [{"family": "nowhere"}]}}, [load_mission(mission)]) == []


def test_losses_sizes_and_wrong_poses_are_told():
    training, mission = decider_named(TRAINED).training, load_mission("exploring")
    changed = mission.model_copy(
        update={
            "delivery": mission.delivery.model_copy(update={"loss": 0.5}),
            "robots": mission.robots.model_copy(update={"count": 90, "pose_noise": 0.1}),
            "world": mission.world.model_copy(update={"width": 300.0}),
        }
    )
    assert [one.partition(" (")[0] for one in unseen(training, [mission, changed])] == [
        "lost messages",
        "wrong poses",
        "90 robots",
        f"{300.0 * mission.world.height:g} m2 of ground",
    ]


def test_play_says_it_and_takes_a_policy_by_itself_only_where_it_knows_its_way():
    zones, undecided = remarks(chosen("silent-zone", 1, 0, TRAINED, ()))
    assert zones == "policy:one: was never trained with zones; what it does there was not measured"
    assert undecided.startswith("policy:one: was made to decide ExplorationPatrol, which these robots do not choose")
    assert remarks(chosen("silent-zone", 1, 0, AVOIDING, ())) == []
    (decided,) = remarks(chosen("transport", 1, 0, "policy:exploring-ppo", ()))[-1:]
    assert (
        decided == "policy:exploring-ppo: decides ExplorationPatrol; Transport held Nearest; AvoidCollision held ORCA"
    )
    known = load_mission("exploring")
    lossy = known.model_copy(update={"delivery": known.delivery.model_copy(update={"loss": 0.5})})
    assert [usual(with_room(mission), ())[0] for mission in (known, lossy)] == [TRAINED, AVOIDING]
