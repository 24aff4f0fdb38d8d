import numpy as np
import pytest

from selforg.gradients import buffer as buffers
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.delivery import Delivery
from selforg.gradients.poses import OwnPoses
from selforg.gradients.queries import Filter, Queries
from selforg.gradients.settings import BufferSettings
from selforg.gradients.store import columns as c
from selforg.mechanisms import Carried, Patrol, SpreadGradient
from selforg.space import Euclidean

EVERYTHING = Filter(view_distance=np.inf)


def line(rows=4, teams=None, **delivery):
    """Robots 1 m apart on a line, each with a content of its own."""
    space = Euclidean(2)
    poses = OwnPoses(space, rows, teams)
    poses.update(np.arange(float(rows))[:, None] * [1.0, 0.0], None, 0.0)
    return SoBuffer(BufferSettings(aggregation_distance=0.0), space, poses, Delivery(**delivery))


def heard(buffer, now):
    return [len(Queries(buffer).gradients(row, now, EVERYTHING)) for row in range(buffer.poses.rows)]


@pytest.mark.parametrize(
    ("delivery", "courses"),
    [
        ({"reach": 1.0}, {0.0: [1, 2, 2, 1]}),
        ({"reach": 0.0, "delay": 0.0}, {0.0: [0, 0, 0, 0]}),
        ({"loss": 1.0}, {0.0: [0, 0, 0, 0]}),
        ({"delay": 0.5}, {0.4: [0, 0, 0, 0], 0.5: [3, 3, 3, 3]}),
    ],
)
def test_messages_are_heard_where_and_when_they_arrive(delivery, courses):
    buffer = line(**delivery)
    SpreadGradient(buffer, carried=Carried("beacon")).spread(0.0)
    for now, counts in courses.items():
        buffer.deliver(now)
        assert heard(buffer, now) == counts


def test_a_deposit_stays_with_the_one_who_left_it_too():
    buffer = line(reach=1.0)
    Patrol(buffer).deposit(0.0, np.array([0]))
    assert heard(buffer, 0.0) == [1, 1, 0, 0]


def test_messages_are_stored_in_short_calls_between_which_ctrl_c_is_heard_with_the_same_bits(monkeypatch):
    stored, sizes, store_rows = [], [], buffers.store_rows
    monkeypatch.setattr(buffers, "store_rows", lambda *given: sizes.append(len(given[0])) or store_rows(*given))
    for most in (buffers.MOST_IN_A_CALL, 7):
        monkeypatch.setattr(buffers, "MOST_IN_A_CALL", most)
        buffer = line(rows=20, loss=0.3, generators=[np.random.default_rng(1)])
        for now in (0.0, 0.2, 0.4):
            Patrol(buffer).deposit(now, np.arange(20))
        pairs = Queries(buffer).gather(0.4, look=EVERYTHING).pairs[:, : c.PAIR_SLOT]  # slots are free to differ
        stored.append((pairs.tobytes(), len(pairs), max(sizes)))
        sizes.clear()
    assert stored[0][:2] == stored[1][:2]
    assert stored[0][1] > 300
    assert stored[0][2] > 200
    assert stored[1][2] == 7


def test_losses_have_the_given_probability_and_differ_among_receivers():
    buffer = line(rows=20, loss=0.3, generators=[np.random.default_rng(1)])
    for tick in range(40):
        SpreadGradient(buffer, carried=Carried(f"beacon{tick}")).spread(0.0)
    counts = heard(buffer, 0.0)
    assert np.mean(counts) == pytest.approx(0.7 * 19 * 40, rel=0.03)
    assert len(set(counts)) > 1


def test_one_teams_losses_do_not_depend_on_another_team():
    counts = []
    for teams in ([0] * 6, [1, 0] * 6):
        rows = len(teams)
        buffer = line(rows=rows, teams=teams, loss=0.5,
                      generators=[np.random.default_rng(s) for s in ((3,) if rows == 6 else (99, 3))])  # fmt: skip
        buffer.poses.forget(np.arange(rows))
        places = np.repeat(np.arange(6.0), rows // 6)[:, None] * [1.0, 0.0]
        buffer.poses.update(places, None, 1.0)
        SpreadGradient(buffer, carried=Carried("beacon")).spread(1.0)
        everybody = heard(buffer, 1.0)
        counts.append([c for c, team in zip(everybody, teams, strict=True) if rows == 6 or team == 1])
    assert counts[0] == counts[1]


def test_clearing_a_team_also_drops_what_is_under_way():
    buffer = line(teams=[0, 0, 1, 1], delay=1.0)
    SpreadGradient(buffer, carried=Carried("beacon")).spread(0.0)
    buffer.clear(0)
    buffer.deliver(2.0)
    assert heard(buffer, 2.0) == [0, 0, 1, 1]


@pytest.mark.parametrize(
    ("field", "value"), [("reach", -1.0), ("loss", 1.5), ("loss", 0.5), ("delay", -1.0), ("delay", np.inf)]
)
def test_impossible_deliveries_are_refused(field, value):
    with pytest.raises(ValueError, match="Delivery"):
        Delivery(**{field: value})
