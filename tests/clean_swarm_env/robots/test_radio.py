"""Broadcasts as bytes: golden ones, a mission over bytes, other versions, and bytes that are damaged."""

import math
import random
import resource
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from clean_swarm_env.robots.process import RobotProcess
from clean_swarm_env.robots.sensed import POSE_BUFFER, Broadcast, Emitted, Sensed
from examples.robots.bodies import tick_together
from selector.documents.errors import DocumentError
from selforg.gradients.gradient import Gradient
from tests.clean_swarm_env.robots.lock_step import Both, poses_of

pytestmark = pytest.mark.extra
radio = pytest.importorskip("clean_swarm_env.robots.radio", reason="needs the extra 'robots'", exc_type=ImportError)

SAID = Broadcast(
    "robot_3",
    sequence=258,
    stamp=1.25,
    emitted=(
        Emitted(POSE_BUFFER, Gradient("robot", (1.5, -2.0), 0, (0.6, 0.8), -1, 1.0, 0.5, stamp=1.25, moving=True)),
        Emitted("facts", Gradient("door", (0.0, 4.0), attraction=0, stamp=1.0, payload={"door": 7.0})),
    ),
)
GOLDEN = Path(__file__).parent / "golden_broadcast.hex"


def same(one, other):
    """Return whether two broadcasts say the same; who spread a gradient is who says it."""

    def plain(said):
        return [
            (e.buffer, {**vars(e.gradient), "source": "", "heading": e.gradient.heading or (0.0, 0.0)}) for e in said
        ]

    head = [(said.robot, said.sequence, said.stamp, plain(said.emitted)) for said in (one, other)]
    return head[0] == head[1]


def test_a_broadcast_has_the_bytes_that_it_always_had_and_is_read_back():
    raw = radio.Radio().encode(SAID)
    assert raw.hex() == GOLDEN.read_text(encoding="utf-8").strip()
    assert same(radio.Radio().decode(raw), SAID)


def test_every_field_of_a_message_says_its_unit_or_what_it_is():
    for name in radio.NAMES:
        text = Path(radio.__file__).parent / "msg" / f"{name.rpartition('/')[2]}.msg"
        fields = [line for line in text.read_text(encoding="utf-8").splitlines() if line and not line.startswith("#")]
        assert all("#" in line for line in fields)
        assert len(fields) >= 5


def test_a_mission_over_bytes_has_the_course_of_one_process():
    both = Both({"base": "exploring", "time_limit": 20.0}, "fsm:recent-finds", 3)
    bodies, robots, air = both.bodies(), both.robots(), radio.Radio()
    for robot in robots:
        robot.hear = lambda said, heard=robot.hear: heard(air.decode(air.encode(said)))
    for course in both.course:
        tick_together(bodies, robots)
        np.testing.assert_array_equal(poses_of(bodies.worlds), course)


@pytest.mark.parametrize(
    ("raw", "says"),
    [
        (b"", r"first, version 1 in CDR, got b''"),
        (b"\0\1\0\0\2" + b"\0" * 80, r"first, version 1 in CDR, got b'\\x00\\x01\\x00\\x00\\x02'"),
        (b"\0\0\0\0\1" + b"\0" * 80, r"first, version 1 in CDR, got b'\\x00\\x00\\x00\\x00\\x01'"),
        (b"\0\1\0\0\1" + b"\0" * 70_000, "at most 65000 bytes"),
        ({}, "at most 65000 bytes, got {}"),
        (b"\0\1\0\0\1\0\0\0", "damaged bytes"),
    ],
)
def test_bytes_of_another_version_or_length_are_one_line(raw, says):
    with pytest.raises(DocumentError, match=f"^radio: expected .*{says}"):
        radio.Radio().decode(raw)


def damaged(raw, draw):
    """Return bytes with some changed, cut, put in or doubled."""
    data = bytearray(raw)
    for _ in range(draw.randint(1, 4)):
        place = draw.randrange(len(data)) if data else 0
        kind = draw.randrange(5)
        if kind == 0 and data:
            data[place] = draw.randrange(256)
        elif kind == 1:
            del data[place : place + draw.randint(1, 40)]
        elif kind == 2:
            data[place:place] = draw.randbytes(draw.randint(1, 40))
        elif kind == 3:
            data[place : place + 4] = draw.choice(
                [b"\xff\xff\xff\xff", b"\xff\xff\xff\x7f", b"\0\0\0\0", b"\0\0\xf0\x7f"]
            )
        else:
            data += data[place : place + 200]
    return bytes(data)


def survive(messages):
    """Let a robot hear damaged messages; return how many it took, and by how much its memory grew at last [MB]."""
    draw, air, robot = random.Random(1), radio.Radio(), RobotProcess("cleaning-patrol", 0)
    others = [RobotProcess("cleaning-patrol", number) for number in (1, 2)]
    taken, heard, grown, early = 0, 0, 0, messages // 2
    for number in range(messages):
        now = 0.02 * number
        if number % 10 == 0:
            said = []
            for k, other in enumerate((robot, *others)):
                other.sense(Sensed(stamp=now, x=2.0 + 0.5 * k + np.sin(now), y=3.0, heading=0.1 * now % math.tau))
                other.step(now)
            said = [air.encode(other.say(now)) for other in others]
            heard += sum(robot.hear(air.decode(raw)) for raw in said)
        with suppress(DocumentError):
            taken += robot.hear(air.decode(damaged(draw.choice(said), draw)))
        if number == early:
            grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    assert np.isfinite(robot.worlds.minds.poses.positions).all()
    assert heard > 0.9 * 2 * messages / 10  # damaged messages silence nobody for long
    return taken, (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - grown) / 1024


def test_damaged_messages_crash_nothing():
    survive(2_000)


@pytest.mark.long
def test_a_hundred_thousand_damaged_messages_crash_nothing_and_fill_no_memory():
    _, grown = survive(100_000)
    assert grown < 5.0
