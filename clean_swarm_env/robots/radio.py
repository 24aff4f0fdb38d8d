"""Broadcasts as bytes: the messages of `msg/*.msg` in CDR, as ROS 2 has them; needs the extra `robots`."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import numpy as np

try:
    from rosbags.serde import SerdeError
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore
except ImportError as error:
    raise ImportError("the radio needs the extra `robots`: pip install 'clean-swarm[robots]'") from error

from clean_swarm_env.robots.sensed import Broadcast, Emitted
from selector.documents.plain import DocumentError, must_fit, short
from selforg.gradients.gradient import Gradient

RADIO_VERSION: Final = 1
LITTLE_ENDIAN: Final = b"\0\1\0\0"
"""How CDR begins; other orders of bytes are not heard."""
MOST_BYTES: Final = 65_000
"""Length of a message that is heard; a datagram holds no more."""
NAMES: Final = "clean_swarm/msg/Gradient", "clean_swarm/msg/Broadcast"


class Radio:
    """Writes broadcasts as bytes, and reads them.

    >>> radio = Radio()
    >>> radio.decode(radio.encode(Broadcast("robot_1", sequence=0, stamp=0.2))).robot
    'robot_1'

    """

    def __init__(self) -> None:
        self._types: Any = get_typestore(Stores.EMPTY)
        for name in NAMES:
            text = (Path(__file__).parent / "msg" / f"{name.rpartition('/')[2]}.msg").read_text(encoding="utf-8")
            self._types.register(get_types_from_msg(text, name))
        self._gradient, self._broadcast = (self._types.types[name] for name in NAMES)

    def encode(self, said: Broadcast) -> bytes:
        """Return a broadcast as bytes."""
        gradients = [self._message(buffer, one) for buffer, one in said.emitted]
        message = self._broadcast(RADIO_VERSION, said.robot, said.sequence, said.stamp, gradients)
        raw = bytes(self._types.serialize_cdr(message, NAMES[1]))
        must_fit(len(raw) <= MOST_BYTES, "radio", f"a broadcast of at most {MOST_BYTES} bytes", len(raw))
        return raw

    def decode(self, raw: bytes) -> Broadcast:
        """Return the broadcast that bytes say; DocumentError if they are damaged, or of another version."""
        must_fit(isinstance(raw, bytes) and len(raw) <= MOST_BYTES, "radio", f"at most {MOST_BYTES} bytes", raw)
        begin = LITTLE_ENDIAN + bytes([RADIO_VERSION])
        must_fit(raw.startswith(begin), "radio", f"{begin!r} first, version {RADIO_VERSION} in CDR", raw[: len(begin)])
        try:
            message = self._types.deserialize_cdr(raw, NAMES[1])
            emitted = tuple(Emitted(one.buffer, gradient_of(one)) for one in message.gradients)
        except (SerdeError, ValueError) as wrong:
            raise DocumentError(f"radio: expected a broadcast, got damaged bytes ({short(str(wrong))})") from None
        return Broadcast(message.robot, int(message.sequence), float(message.stamp), emitted)

    def _message(self, buffer: str, one: Gradient) -> object:
        """Return a gradient as a message."""
        key, value = next(iter(one.payload.items()), ("", 0.0))
        radii, times = (one.diffusion, one.goal_radius), (one.evaporation_factor, one.evaporation_period, one.stamp)
        place, heading = np.array(one.position), np.array(one.heading or (0.0, 0.0))
        fields = buffer, one.channel, place, heading, one.attraction, *radii, *times, one.moving, key, float(value)
        return self._gradient(*fields)


def gradient_of(message: Any) -> Gradient:  # noqa: ANN401  (a class that rosbags makes)
    """Return the gradient that a message says."""
    return Gradient(
        channel=message.channel,
        position=tuple(message.position.tolist()),
        heading=tuple(message.heading.tolist()),
        attraction=message.attraction,
        diffusion=message.diffusion,
        goal_radius=message.goal_radius,
        evaporation_factor=message.evaporation_factor,
        evaporation_period=message.evaporation_period,
        stamp=message.stamp,
        moving=bool(message.moving),
        payload={message.key: message.value} if message.key else {},
    )
