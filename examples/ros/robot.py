"""A robot as a node: poses in, commands out, broadcasts both ways.

| topic | type | | |
|---|---|---|---|
| /robot_N/odom | nav_msgs/Odometry | in | its pose on the ground, whose lower left corner is [0, 0] [m] |
| /robot_N/scan | sensor_msgs/LaserScan | in | what the safety filter keeps clear of [m]; without one it does nothing |
| /robot_N/sensed | std_msgs/String | in | items, cargo and bumps as JSON, with the pose; see `Sensed` |
| /robot_N/cmd_vel | geometry_msgs/Twist or TwistStamped | out | linear.x [m/s], angular.z [rad/s] |
| /robot_N/handles | std_msgs/String | out | what its gripper begins, as JSON |
| /radio | std_msgs/UInt8MultiArray | both | what robots say |
| /diagnostics | diagnostic_msgs/DiagnosticArray | out | its options, why it stands, missed periods, what was refused |
"""

import json
import time
from collections import defaultdict
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from math import atan2, inf
from typing import Final

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String, UInt8MultiArray

from clean_swarm_env.robots.process import RobotProcess
from clean_swarm_env.robots.radio import Radio
from clean_swarm_env.robots.sensed import Broadcast, Sensed, Wheels
from examples.robots.bad_reception import BadReception, Faults
from examples.robots.safety import kept_clear
from examples.ros.wire import AGAIN, RADIO, STEADY, MissionClock, from_text, sensed_in
from selector.documents.errors import DocumentError
from selector.documents.fields import JOINT

NO_FAULTS: Final = Faults()


class RobotNode(Node):
    """One robot of a mission.

    Args:
        robot: the robot.
        clock: the time of the mission.
        stamped: whether commands are TwistStamped.
        radius: of its body on the floor, for the safety filter [m].
        scale: length on the floor of a unit of the mission's lengths [m].
        faults: of its radio, for tests.

    """

    def __init__(
        self,
        robot: RobotProcess,
        clock: MissionClock,
        *,
        stamped: bool = False,
        radius: float = 0.0,
        scale: float = 1.0,
        faults: Faults = NO_FAULTS,
    ) -> None:
        super().__init__(robot.name)
        self.robot, self.clock, self._air = robot, clock, Radio()
        self._reception = BadReception(faults, np.random.default_rng(robot.row))
        self._radius, self._scale, self._ranges, self._stamped = radius, scale, LaserScan(), stamped
        self._last: Sensed | None = None
        self._told_in, self._missed, self.ticks, self.damaged = -1, 0, 0, 0
        kind, own = TwistStamped if stamped else Twist, f"/{robot.name}"
        self._wheels = self.create_publisher(kind, f"{own}/cmd_vel", STEADY)
        self._handles = self.create_publisher(String, f"{own}/handles", STEADY)
        self._radio = self.create_publisher(UInt8MultiArray, RADIO, 10 * STEADY)
        self._health = self.create_publisher(DiagnosticArray, "/diagnostics", STEADY)
        self.create_subscription(Odometry, f"{own}/odom", self.locate, STEADY)
        self.create_subscription(LaserScan, f"{own}/scan", self._scan, STEADY)
        self.create_subscription(String, f"{own}/sensed", self.sense, STEADY)
        self.on_radio: Callable[[bytes], None] = self.listen
        self.create_subscription(UInt8MultiArray, RADIO, lambda heard: self.on_radio(bytes(heard.data)), 10 * STEADY)

    @property
    def link_age(self) -> float:
        """Age of the last pose [s]; infinite before the first."""
        return self.clock.now - self._last.stamp if self._last is not None else inf

    def locate(self, odometry: Odometry) -> None:
        """Take the pose from odometry, which is of now: clocks of drivers differ from that of the mission."""
        place, turn = odometry.pose.pose.position, odometry.pose.pose.orientation
        x, y = place.x / self._scale, place.y / self._scale
        self._believe({"x": x, "y": y, "heading": 2.0 * atan2(turn.z, turn.w)})

    def sense(self, text: String) -> None:
        """Take what else the robot senses, with its pose or without."""
        try:
            self._believe(sensed_in(text.data))
        except (ValueError, TypeError, AttributeError, OverflowError, RecursionError):  # text of others
            self.damaged += 1

    def _believe(self, sensed: dict) -> None:
        """Put what is sensed into what was; it is of now if there is a pose in it. Broken sensors do not count."""
        placed = {"x", "y", "heading"} <= {*sensed}
        if self._last is None and not placed:
            return
        known = self._last or Sensed(0.0, 0.0, 0.0, 0.0)
        try:
            new = replace(known, **{"collisions": 0, **sensed, "stamp": self.clock.now if placed else known.stamp})
            self.robot.sense(new)
            self._last = new
        except DocumentError:
            self.damaged += 1

    def _scan(self, scan: LaserScan) -> None:
        self._ranges = scan

    def listen(self, raw: bytes) -> None:
        """Take what somebody says, by way of its radio."""
        said = self.decoded(raw)
        if said is not None and said.robot != self.robot.name:
            self._reception.send(said, self.clock.now)

    def hear_due(self) -> None:
        """Let the robot hear what has arrived."""
        for said in self._reception.heard(self.clock.now):
            self.robot.hear(said)

    def decoded(self, raw: bytes) -> Broadcast | None:
        """Return what bytes say; None for damaged ones, which are counted."""
        try:
            return self._air.decode(raw)
        except DocumentError:
            self.damaged += 1
            return None

    def run_once(self) -> None:
        """Hear, decide where a control period has begun, say something once in it, and command the wheels."""
        now = self.clock.now
        self.hear_due()
        wheels = self.robot.step(now)
        tick = self.robot.worlds.world.tick
        if tick > self._told_in:
            self._missed += max(tick - self._told_in - 1, 0) if self._told_in >= 0 else 0
            self._told_in, self.ticks = tick, self.ticks + 1
            self.say(self.robot.say(now))
            if self.ticks % 5 == 1:
                self.diagnose(wheels)
        if wheels.handles:
            self._handles.publish(String(data=json.dumps({"tick": tick, "handles": wheels.handles})))
        self.drive(wheels, tick)

    def say(self, said: Broadcast) -> None:
        """Say something to all."""
        self._radio.publish(UInt8MultiArray(data=self._air.encode(said)))

    def grip(self, handles: tuple[str, ...], tick: int) -> None:
        """Tell the gripper, in lock step whatever it does."""
        self._handles.publish(String(data=json.dumps({"tick": tick, "handles": handles})))

    def drive(self, wheels: Wheels, tick: int) -> None:
        """Command the wheels, as fast as the safety filter lets them."""
        x, y = wheels.vector
        true = wheels._replace(speed=self._scale * wheels.speed, vector=(self._scale * x, self._scale * y))
        wheels = kept_clear(true, self._ranges, self._radius)
        command = TwistStamped() if self._stamped else Twist()
        if self._stamped:
            command.header.stamp, command.header.frame_id = self.get_clock().now().to_msg(), str(tick)
        speeds = command.twist if self._stamped else command
        speeds.linear.x, speeds.angular.z = wheels.speed, wheels.turn_rate
        self._wheels.publish(command)

    def stand(self) -> None:
        """Command the wheels to stand."""
        self.drive(Wheels(0.0, 0.0, (0.0, 0.0)), self.robot.worlds.world.tick)

    def diagnose(self, wheels: Wheels) -> None:
        """Say how the robot is."""
        refused = {f"refused: {why}": count for why, count in self.robot.ear.refused.items()}
        holds = JOINT.join(one.model.options[one.held[self.robot.row]] for one in self.robot.worlds.coordinators)
        values = {"holds": holds, "periods": self.ticks, "missed": self._missed, "damaged": self.damaged, **refused}
        level, words = (
            (DiagnosticStatus.WARN, f"stands: no {wheels.stopped}")
            if wheels.stopped
            else (DiagnosticStatus.OK, "drives")
        )
        pairs = [KeyValue(key=key, value=str(value)) for key, value in values.items()]
        status = DiagnosticStatus(
            level=level, name=self.robot.name, message=words, hardware_id=self.robot.name, values=pairs
        )
        self._health.publish(DiagnosticArray(status=[status]))

    @property
    def summary(self) -> dict[str, int]:
        """What a test or a person asks at the end."""
        return {"periods": self.ticks, "missed": self._missed, "damaged": self.damaged, **self.robot.ear.refused}


class LockStep:
    """A robot that waits in each control period for all that is said and sensed, as bodies in lock step need it.

    What it says in a period it says again while it waits, because nodes may find each other later than they speak.

    Args:
        node: the robot's node, with the topics.
        spin: waits for messages for a moment.

    """

    def __init__(self, node: RobotNode, spin: Callable[[], None]) -> None:
        self._node, self._spin = node, spin
        self._phases: dict[tuple[int, str], dict] = {}
        self._said: dict[int, dict[str, Broadcast]] = defaultdict(dict)
        self._spoken: list[Callable[[], None]] = []  # what the robot has said in this period, to say it again
        node.on_radio = self._listen
        self._topic = f"/{node.robot.name}/lockstep"
        node.create_subscription(String, self._topic, self._sense, STEADY)

    def _sense(self, text: String) -> None:
        given = json.loads(text.data)
        self._phases[given["tick"], given["phase"]] = given

    def _listen(self, raw: bytes) -> None:
        said = self._node.decoded(raw)
        if said is not None and said.robot != self._node.robot.name:
            self._said[said.sequence][said.robot] = said

    def _speak(self, speak: Callable[[], None]) -> None:
        self._spoken.append(speak)
        speak()

    def _wait(self, there: Callable[[], bool]) -> None:
        again = time.monotonic() + AGAIN
        while not there():
            self._spin()
            if time.monotonic() > again:
                again = time.monotonic() + AGAIN
                begun = self._phases or self._node.ticks
                if begun and not self._node.count_publishers(self._topic):
                    raise DocumentError(f"{self._topic}: expected the end of the mission, but the world has gone")
                for speak in self._spoken:
                    speak()

    def run(self) -> None:
        """Run all control periods until the bodies end the mission."""
        node, robot, tick = self._node, self._node.robot, 0
        others = len(robot.names) - 1
        while True:
            self._wait(lambda tick=tick: (tick, "sense") in self._phases or (tick, "end") in self._phases)
            if (tick, "end") in self._phases:
                return
            given, self._spoken = self._phases[tick, "sense"], []
            robot.sense(from_text(given["sensed"]))
            for number, say in ((2 * tick, robot.tell), (2 * tick + 1, robot.say)):
                self._speak(partial(node.say, say(given["now"])))
                self._wait(lambda number=number: len(self._said[number]) == others)
                for _, said in sorted(self._said.pop(number).items()):
                    robot.hear(said)
            self._speak(partial(node.grip, robot.decide(given["now"]), tick))
            self._wait(lambda tick=tick: (tick, "handled") in self._phases)
            robot.sense(from_text(self._phases[tick, "handled"]["sensed"]))
            wheels = robot.act(given["now"])
            node.diagnose(wheels)
            self._speak(partial(node.drive, wheels, tick))
            node.ticks = tick = tick + 1
            self._phases = {place: one for place, one in self._phases.items() if place[0] >= tick}
