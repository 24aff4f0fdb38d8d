"""Families: every scenario can be run, is the same for the same seed, and belongs to one split only."""

import zlib

import numpy as np
import pytest

from clean_swarm_env.config.families import SPLITS, FamilyConfig, place_of, seed_of
from clean_swarm_env.config.frames import check_frame, grouped
from clean_swarm_env.config.load import load_experiment, load_family, load_mission
from clean_swarm_env.config.starts import distances, for_start
from clean_swarm_env.config.task_names import family_ids, task_names
from clean_swarm_env.config.types import ConfigurationError
from selector.documents.errors import DocumentError
from selector.documents.find import files_of
from tests.clean_swarm_env.courses import mission

FAMILIES = list(files_of("families"))


SCOUTS = "mission: {base: scouts}\nitems: [24, 24]\n"
NEWER = {"model", "every"}
"""Keys of events that came after the digests below; what they say is the default in all these families."""


@pytest.mark.parametrize("name", FAMILIES)
def test_scenarios_are_the_same_again_and_all_different(name):
    first, again = load_family(name), load_family(name)
    drawn = [first.scenario(3, index, split) for split in SPLITS for index in range(20)]
    assert drawn == [again.scenario(3, index, split) for split in SPLITS for index in range(20)]
    assert len({scenario.seed for scenario in drawn}) == len({(s.id) for s in drawn}) == 40
    starts = {scenario.start.robots for scenario in drawn}
    assert len(starts) == (25 if name == "table1-starts" else 40)
    for scenario in drawn:
        for_start(scenario.mission, scenario.start)  # robots and items on the torus, solid robots apart


DIGESTS = {
    "bumpers-or-not-1": 2524771815,
    "clustered": 3990978693,
    "continuous": 978469770,
    "continuous-bumpers": 3723175218,
    "crowded": 2563779510,
    "crowded-bumpers": 3569131695,
    "crowded-exploring": 3252743544,
    "hotspots": 132852503,
    "random": 1192068226,
    "random-bumpers": 2958000314,
    "rare": 1013042312,
    "seasons-1": 2938303589,
    "shifting": 297865550,
    "shifting-bumpers": 3735841617,
    "sparse": 357777485,
    "sparse-bumpers": 3013880565,
    "table1-starts": 1602162840,
    "unseen": 3150438572,
    "unseen-bumpers": 4227120394,
    "unseen-exploring": 860417804,
    "yards": 1012170900,
    "rooms-1": 2131696331,
    "zones-1": 1017966448,
    "scouts-1": 3416498685,
    "sizes-1": 543801411,
    "losses-1": 1440313715,
    "packed-1": 3840609750,
    "stopping-or-not-1": 4010054391,
    "spots-1": 1611496177,
    "tides-1": 469883719,
    "flats-1": 1937331805,
    "marsh-1": 2517060984,
    "convoys-1": 1457383724,
    "teams-1": 1654876690,
    "fading-1": 1742898517,
    "disturbed-crowd": 4078497553,
    "robustness": 2798611050,
    "scout-options": 3431050193,
    "swapped-scouts": 3545816099,
}
"""Family, or experiment with disturbances -> digest of 40 of its scenarios as they were first accepted."""


def drawn_later(mission):
    """What families draw, or have in their missions, that those of the first digests did not."""
    walls = [wall.corners for wall in mission.world.walls]
    zones = [(zone.area, zone.loss, zone.speed) for zone in mission.world.zones]
    models = mission.robots.groups
    groups = [(one.model, one.count, one.radius, one.max_speed, one.carries, one.sight) for one in models]
    return walls, zones, groups, mission.delivery.loss, mission.task.consequences.drop


@pytest.mark.parametrize("name", DIGESTS)
def test_accepted_families_are_frozen(name):
    """A changed family gets a new name: docs/families.md."""
    family, found = load_family(name), 0
    for scenario in [family.scenario(3, k, split) for split in ("train", "test") for k in range(20)]:
        mission, start = scenario.mission, scenario.start
        events = [event.model_dump(exclude=NEWER) for event in scenario.mission.events]
        world = mission.world.width, mission.world.height, mission.time_limit, mission.collision_cost
        task = mission.task.garbage.respawn, mission.task.garbage.spots, mission.task.stations.places
        harm = mission.task.consequences.stop, mission.task.consequences.harmless
        drawn = scenario.seed, start.robots, start.items, events, world, task, harm, mission.contact_cost
        if name in FAMILIES and any(later := drawn_later(mission)):
            drawn = (*drawn, later)
        found = zlib.crc32(repr(drawn).encode(), found)
    assert found == DIGESTS[name]


def test_one_name_means_one_thing():
    """No two files of missions have one name; an experiment may have that of the mission on which it compares."""
    assert set(FAMILIES) <= DIGESTS.keys()
    missions, names = {*files_of("missions"), *task_names()}, {*files_of("experiments")}
    assert not set(FAMILIES) & (missions | names)
    assert {name: load_experiment(name).mission.name for name in names & missions} == {"table1": "table1"}


@pytest.mark.parametrize("name", FAMILIES)
def test_splits_cannot_overlap(name):
    train = {seed_of(name, seed, index, "train") for seed in range(20) for index in range(50)}
    test = {seed_of(name, seed, index, "test") for seed in range(20) for index in range(50)}
    assert len(train) == len(test) == 1000
    assert {seed % 2 for seed in train} == {0}
    assert {seed % 2 for seed in test} == {1}


@pytest.mark.parametrize("name", FAMILIES)
def test_scenarios_of_one_torus_share_a_frame(name):
    missions = [load_family(name).scenario(1, index, "test").mission for index in range(30)]
    groups = grouped(missions)
    assert len(groups) == len({(m.world.width, m.world.height) for m in missions}) == len(load_family(name).tori)
    assert sorted(number for group in groups for number in group) == list(range(30))
    with pytest.raises(ValueError, match="world: expected"):
        check_frame(mission(world={"width": 12.0}), missions[0])


def test_families_draw_places_for_as_many_stations_as_the_mission_has():
    base = load_family("random").model_dump()
    base["mission"]["task"]["stations"] |= {"further_recycling": [[1.0, 1.0]], "further_dumps": [[2.0, 2.0]] * 3}
    family = FamilyConfig.model_validate(base | {"stations": "random"})
    size, drawn = family.tori[0], [family.scenario(1, k, "test").mission.task.stations for k in range(20)]
    assert len({stations.places for stations in drawn}) == 20
    for stations in drawn:
        assert stations.kinds == (0, 1, 0, 1, 1, 1)
        places = np.array(stations.places)
        apart = [distances(p, np.delete(places, k, axis=0), np.array(size)).min() for k, p in enumerate(places)]
        assert min(apart) >= 2.0


def test_the_stations_of_a_kind_stand_at_as_many_places_as_are_drawn():
    numbers = []
    for index in range(40):
        stations = load_family("yards").scenario(1, index, "test").mission.task.stations
        recycling = {stations.recycling, *stations.further_recycling}
        dumps = {stations.dump, *stations.further_dumps}
        assert len(recycling) == len(dumps)
        assert not recycling & dumps
        numbers.append(len(dumps))
    assert sorted(set(numbers)) == [1, 2, 3]
    assert min(numbers.count(number) for number in (1, 2, 3)) > 5


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("station_places: [1, 2]", "station_places: expected stations: random, got stations: given"),
        ("station_places: [2, 1]\nstations: random", "station_places: expected the least before the largest"),
        ("spots: [2, 1]", "spots: expected the least before the largest, got [2, 1]"),
        ("robots: [5, 4]", "robots: expected the least before the largest, got [5, 4]"),
        ("changes: {number: [1, 2]}", "changes.kinds: expected at least one kind of event, got none"),
        ("robots: [900, 900]", "at most 277 solid robots"),
        ("mission: nowhere", "unknown mission or task 'nowhere'"),
        ("starts: table1\nrobots: [4, 4]", "robots: expected the numbers of the given starts, [5], got [4, 4]"),
        ("colour: red", "colour: unknown key 'colour'"),
        (
            f"{SCOUTS}groups: {{robot: [1, 2]}}",
            "own.yaml: groups: expected models of the mission's groups (carrier, scout)",
        ),
        (f"{SCOUTS}groups: {{scout: [3, 1]}}", "groups.scout: expected the least before the largest, got [3, 1]"),
        (f"{SCOUTS}groups: {{scout: [0, 1]}}", "groups.scout.0: expected greater than or equal to 1, got 0"),
        (
            f"{SCOUTS}groups: {{scout: [1, 2]}}\nrobots: [7, 7]",
            "own.yaml: robots: expected nothing beside `groups`, got [7, 7]",
        ),
        (
            f"{SCOUTS}robots: [5, 9]",
            "robots: expected 7, as in the groups of the mission, or `groups`; and no joins drawn",
        ),
        ("changes: {phases: 4, number: [1, 2], kinds: [land]}", "phases: expected 0 beside events"),
        ("changes: {phases: -1}", "changes.phases: "),
        (
            "mission: {events: [{at: 5.0, do: land, items: 1}]}\nchanges: {phases: 2}",
            "mission.events: expected none where ",
        ),
        ("alternatives: [{colour: red}]", "alternatives.0: colour: unknown key 'colour'"),
        ("alternatives: [red]", "alternatives.0: expected "),
        (
            "alternatives: [{}, {robots: {count: 7}}]",
            "alternatives.1.robots: expected 5 as in the mission, because the family draws it, got 7",
        ),
        (
            "sizes: [[11.0, 11.0]]\nalternatives: [{world: {width: 20.0}}]",
            "alternatives.0.world: expected the size of the mission beside `sizes`, got [20.0, 11.0]",
        ),
        (
            "alternatives: [{}, {delivery: {loss: 0.5}}]",
            "alternatives.1: mission 'own': delivery: expected",
        ),
    ],
)
def test_impossible_families_are_named_in_one_line(text, message, tmp_path):
    path = tmp_path / "own.yaml"
    path.write_text(f"name: own\ndescription: Own.\n{text}\n")
    with pytest.raises(ConfigurationError) as error:
        load_family(str(path))
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_each_alternative_is_drawn_as_often():
    family = load_family("losses-1")
    losses = [family.scenario(1, k, "test").mission.delivery.loss for k in range(200)]
    counts = {loss: losses.count(loss) for loss in losses}
    assert sorted(counts) == [0.0, 0.3, 0.6, 0.8, 0.95]
    assert min(counts.values()) > 25
    assert len(family.missions) == 5


def test_alternatives_keep_what_the_family_is_given(tmp_path):
    changed = load_family("rooms-1").with_knowledge("exploring")
    assert {mission.knowledge for mission in changed.missions} == {"exploring"}
    assert {mission.terms for mission in changed.missions} == {("finds",)}
    assert {tuple(mission.size) for mission in changed.missions} == set(changed.tori)
    assert changed.largest.world.walls == changed.missions[0].world.walls


def test_families_have_ids():
    """An id serves wherever the name does."""
    assert list(family_ids().values()) == FAMILIES
    assert family_ids()["CleanSwarm-StoppingOrNot-v1"] == "stopping-or-not-1"
    for name, own in {"rooms-1": "CleanSwarm-Rooms-v1", "clustered": "CleanSwarm-Clustered-v1"}.items():
        assert load_family(own) == load_family(name)
        assert load_experiment(own) == load_family(name)


def test_an_own_family_has_an_id(tmp_path):
    (tmp_path / "families").mkdir()
    (tmp_path / "families" / "my-yard-3.yaml").write_text("name: my-yard-3\ndescription: Own.\n")
    assert load_family("CleanSwarm-MyYard-v3", [tmp_path]).name == "my-yard-3"


def test_an_unknown_id_lists_the_known_ones():
    with pytest.raises(ConfigurationError) as error:
        load_family("CleanSwarm-Rooms-v7")
    assert "unknown id of a family 'CleanSwarm-Rooms-v7'" in str(error.value)
    assert "CleanSwarm-Rooms-v1" in str(error.value)
    assert "\n" not in str(error.value)


def test_worlds_of_a_scenario_differ_in_their_seed_only():
    family = load_family("shifting")
    first, second = (family.scenario(3, 4, "test", world) for world in (0, 1))
    assert (first.mission, first.start) == (second.mission, second.start)
    assert first.seed != second.seed
    assert second.seed % 2 == first.seed % 2 == 1
    assert [place_of(scenario.id) for scenario in (first, second)] == [(4, 0), (4, 1)]
    with pytest.raises(DocumentError, match=r"expected a scenario such as test-3 or test-3\.2, got"):
        place_of("test-0")


def test_numbers_are_those_of_the_mission_unless_the_family_draws_them(tmp_path):
    path = tmp_path / "own.yaml"
    path.write_text("name: own\ndescription: D.\nmission: {base: three-rooms}\nitems: [3, 4]\n")
    own, mission = load_family(str(path)), load_mission("three-rooms")
    assert own.robots == (mission.robots.count,) * 2 != (5, 5)
    assert own.items == (3, 4)
    path.write_text("name: own\ndescription: D.\nmission: {task: {garbage: {count: 7, respawn: 2.5}}}\n")
    assert (load_family(str(path)).items, load_family(str(path)).respawn) == ((7, 7), (2.5, 2.5))


@pytest.mark.parametrize("text", ["knowledge: own.yaml", "description: D.\nmission: {knowledge: own.yaml}"])
def test_knowledge_is_found_beside_the_file_that_names_it(tmp_path, text):
    for name, content in {"yard.yaml": f"name: yard\n{text}\n", "own.yaml": ""}.items():
        (tmp_path / name).write_text(content)
    assert load_family(str(tmp_path / "yard.yaml")).mission.knowledge == str(tmp_path / "own.yaml")
