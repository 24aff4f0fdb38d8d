"""The ablation: what it leaves out, that the plan's weight and the planner are one term, and what it writes."""

from benchmarks import ablation
from clean_swarm_env.config.mission import NetworkConfig
from tests.clean_swarm_env.courses import course_of, forced, mission, snapshot


def test_each_variant_lacks_one_thing():
    whole = NetworkConfig(activation_threshold=5.0)
    found = ablation.variants(whole)
    assert next(iter(found)) == ablation.ALL
    assert found.pop(ablation.ALL) == whole
    assert found.pop("planner off") == whole.model_copy(update={"planner": "off"})
    assert list(found) == [f"without {term}" for term in type(whole.weights).model_fields]
    for name, network in found.items():
        weights = network.weights.model_dump()
        assert weights.pop(name.removeprefix("without ")) == 0.0
        assert set(weights.values()) == {1.0}
        assert network.model_copy(update={"weights": whole.weights}) == whole


def test_a_planner_without_weight_is_no_planner():
    without = [mission(network=network) for network in ({"weights": {"plan": 0.0}}, {"planner": "off"})]
    one, other = (forced(course_of(config, 3, 3), AvoidCollision="RepulsionGradient-view1.5") for config in without)
    for _ in range(500):
        assert not one.over[0]
        assert not other.over[0]
        one.tick()
        other.tick()
        for name, part in snapshot(one.worlds, 0).items():
            assert part.tobytes() == snapshot(other.worlds, 0)[name].tobytes(), name
