import numpy as np
import pytest

from selforg.gradients.delivery import Delivery, PoseDelivery
from selforg.gradients.poses import OwnPoses
from selforg.gradients.store import columns as c
from selforg.space import Euclidean

ROWS = 3


def ages(ticks, history=4, **settings):
    """The ages of the last two poses that row 0 received from row 1, after each tick; settings of each tick."""
    poses = OwnPoses(Euclidean(2), ROWS, history=history, hearing=True)
    generators = [np.random.default_rng(row) for row in range(ROWS)]
    delivery = PoseDelivery(poses, Delivery(np.array([5.0]), np.zeros(1), generators=generators), **settings)
    told = []
    for now, (reach, loss) in enumerate(ticks):
        delivery.rule.reach[0], delivery.rule.loss[0] = reach, loss
        poses.update(np.arange(float(ROWS))[:, None] * [1.0, 0.0], None, float(now))
        delivery.deliver()
        told.append(poses.row_table[0, [c.ROW_HEARD + 1, c.ROW_HEARD + ROWS + 1]].tolist())
    return told


HEARD, FAR, LOST = (1.0, 0.0), (0.5, 0.0), (1.0, 1.0)


@pytest.mark.parametrize(
    ("ticks", "settings", "told"),
    [
        # a pose is new when it is received, then ages, and is forgotten with the history
        ([HEARD, *[FAR] * 4], {}, [[0, -1], [1, -1], [2, -1], [3, -1], [-1, -1]]),
        # the pose received before is known, too, and those that were lost are skipped
        ([HEARD, HEARD, LOST, HEARD], {}, [[0, -1], [0, 1], [1, 2], [0, 2]]),
        # a late pose arrives with the age of its delay
        ([HEARD] * 3, {"delay": 2}, [[-1, -1], [-1, -1], [2, -1]]),
    ],
)
def test_poses_have_the_age_since_they_were_sent(ticks, settings, told):
    assert ages(ticks, **settings) == told


def test_losses_have_the_given_probability_and_differ_among_receivers():
    poses = OwnPoses(Euclidean(2), rows=20, hearing=True)
    generators = [np.random.default_rng(s) for s in range(20)]
    delivery = PoseDelivery(poses, Delivery(np.array([99.0]), np.array([0.3]), generators=generators))
    received = []
    for now in range(100):
        poses.update(np.zeros((20, 2)), None, float(now))
        delivery.deliver()
        received.append(poses.row_table[:, c.ROW_HEARD : c.ROW_HEARD + 20] == 0)
    assert np.mean(received) == pytest.approx(0.7, abs=0.01)
    assert np.any(np.any(received, axis=1) & ~np.all(received, axis=1))  # a pose reaches some receivers, not others


def test_poses_that_nobody_hears_and_a_delay_beyond_the_history_are_refused():
    with pytest.raises(ValueError, match="must be made with hearing=True"):
        PoseDelivery(OwnPoses(Euclidean(2), ROWS), Delivery(np.ones(1), np.zeros(1)))
    with pytest.raises(ValueError, match="delay must lie in the history of 4 poses, got 4"):
        ages([], delay=4)
