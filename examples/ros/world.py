"""Our world behind topics: bodies of a mission, for robots that are nodes; the fake robots of a first trial.

For each robot /robot_N/odom and /robot_N/sensed out, /robot_N/cmd_vel and /robot_N/handles in; see `robot`. In lock
step it waits for all robots in each control period, and the mission has the bits of one process. Else it keeps the time
of the clock, counts commands that came too late, and a body whose commands stop stands after the timeout of its drive.
"""

import json
import time
from collections.abc import Callable
from math import cos, isfinite, sin

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
from rclpy.node import Node
from std_msgs.msg import String

from clean_swarm_env.robots.sensed import Sensed, Wheels
from examples.robots.bodies import ServedBodies
from examples.ros.wire import AGAIN, STEADY, MissionClock, as_text
from selector.documents.errors import DocumentError
from selector.documents.fields import JOINT
from selector.documents.plain import short
from selforg.arrays import Floats

FAREWELL = 10.0
"""Time for which robots that do not go are told of the end [s]."""
STANDING = Wheels(0.0, 0.0, (0.0, 0.0))


class WorldNode(Node):
    """The bodies of a mission.

    Attributes:
        course: poses (N, 3) [m, m, rad] after each control period.
        late: control periods of single robots for which no new command had come, from the first one on.
        ticks: control periods so far.

    """

    def __init__(self, bodies: ServedBodies, clock: MissionClock, scale: float = 1.0) -> None:
        super().__init__("world")
        self.bodies, self.clock, self._scale = bodies, clock, scale
        self.names = [f"robot_{row}" for row in range(bodies.worlds.rows)]
        self._timeouts = bodies.worlds.mission.of_each("command_timeout")
        self.late = self.ticks = 0
        self.course: list[Floats] = []
        self._wheels = dict.fromkeys(self.names, STANDING)
        self._came = dict.fromkeys(self.names, -1.0)  # when the last command of each came [s]
        self._commanded, self._handled = {}, {}  # tick of the last command, and of what grippers begin
        self._begun = dict.fromkeys(self.names, ())
        self._odom, self._sensed, self._step = (
            {name: self.create_publisher(kind, f"/{name}/{topic}", STEADY) for name in self.names}
            for kind, topic in ((Odometry, "odom"), (String, "sensed"), (String, "lockstep"))
        )
        for name in self.names:
            self.create_subscription(
                TwistStamped, f"/{name}/cmd_vel", lambda m, name=name: self._drive(name, m), STEADY
            )
            self.create_subscription(String, f"/{name}/handles", lambda m, name=name: self._grip(name, m), STEADY)
        self._held = [[one.held[row] for one in bodies.worlds.coordinators] for row in range(len(self.names))]
        self.create_subscription(DiagnosticArray, "/diagnostics", self._note_options, 10 * STEADY)

    def all_there(self) -> bool:
        """Return whether all robots listen."""
        return all(self._odom[name].get_subscription_count() for name in self.names) and all(
            self.count_publishers(f"/{name}/cmd_vel") for name in self.names
        )

    def someone_there(self) -> int:
        """Return how many robots send commands."""
        return sum(self.count_publishers(f"/{name}/cmd_vel") for name in self.names)

    def _drive(self, name: str, command: TwistStamped) -> None:
        speed, turn_rate, frame = command.twist.linear.x / self._scale, command.twist.angular.z, command.header.frame_id
        if not (isfinite(speed) and isfinite(turn_rate)):
            return  # as if it were lost
        self._wheels[name] = Wheels(speed, turn_rate, (0.0, 0.0))
        self._came[name], self._commanded[name] = self.clock.now, int(frame) if frame.isdecimal() else -1

    def _grip(self, name: str, text: String) -> None:
        try:
            given = json.loads(text.data)
            self._handled[name], self._begun[name] = given["tick"], tuple(given["handles"])
        except (ValueError, TypeError, KeyError):  # text of others
            self.get_logger().warning(f"/{name}/handles: expected JSON of tick and handles, got {short(text.data)}")

    def _note_options(self, told: DiagnosticArray) -> None:
        """Note the options that robots say they hold, for the recording."""
        models = [one.model for one in self.bodies.worlds.coordinators]
        for status in told.status:
            holds = next((pair.value.split(JOINT) for pair in status.values if pair.key == "holds"), [])
            fits = len(holds) == len(models) and all(one in own.options for own, one in zip(models, holds, strict=True))
            if fits and status.name in self.names:
                numbers = [list(own.options).index(one) for own, one in zip(models, holds, strict=True)]
                self._held[self.names.index(status.name)] = numbers

    def run_period(self) -> None:
        """Run one control period by the commands that have come, and say what robots sense then."""
        now, bodies = self.clock.now, self.bodies
        bodies.sense()
        bodies.handle([self._begun[name] for name in self.names])
        self._begun = dict.fromkeys(self.names, ())
        lost = [now - self._came[name] > timeout for name, timeout in zip(self.names, self._timeouts, strict=True)]
        self.late += sum(self._came[name] < now - bodies.worlds.period for name in self.names)
        bodies.show_options(self._held)
        bodies.move([STANDING if gone else self._wheels[name] for name, gone in zip(self.names, lost, strict=True)])
        self.ticks += 1
        self.watch()
        self.show(bodies.sense())

    def show(self, sensed: list[Sensed]) -> None:
        """Publish what robots sense."""
        for name, one in zip(self.names, sensed, strict=True):
            self._sensed[name].publish(String(data=as_text(one)))
            self._odom[name].publish(odometry_of(one, name, self._scale))

    def run_in_step(self, spin: Callable[[], None]) -> None:
        """Run the whole mission in lock step, tick by tick."""
        bodies = self.bodies
        while bodies.running:
            self._ask("sense", bodies.sense(), self._handled, spin)
            self._ask("handled", bodies.handle([self._begun[name] for name in self.names]), self._commanded, spin)
            bodies.show_options(self._held)
            bodies.move([self._wheels[name] for name in self.names])
            self.ticks += 1
            self.watch()
        self._end(bodies.sense(), spin)

    def _end(self, sensed: list[Sensed], spin: Callable[[], None]) -> None:
        """Tell all robots of the end until they have gone: what is told once, and then left, may be lost."""
        again, until = 0.0, time.monotonic() + FAREWELL
        while self.someone_there() and time.monotonic() < until:
            if time.monotonic() > again:
                again = time.monotonic() + AGAIN
                self._tell("end", sensed)
            spin()

    def _ask(self, phase: str, sensed: list[Sensed], answers: dict[str, int], spin: Callable[[], None]) -> None:
        """Tell all robots what they sense, again and again until all have answered."""
        again = 0.0
        while not all(answers.get(name) == self.ticks for name in self.names):
            if time.monotonic() > again:
                again = time.monotonic() + AGAIN
                if gone := [name for name in self.names if not self.count_publishers(f"/{name}/cmd_vel")]:
                    raise DocumentError(f"world: expected all robots until the end, but {', '.join(gone)} has gone")
                self._tell(phase, sensed)
            spin()

    def watch(self) -> None:
        """Note where the robots are, once in a control period."""
        physics = self.bodies.worlds.physics
        self.course.append(np.column_stack([physics.positions, physics.headings]))

    def _tell(self, phase: str, sensed: list[Sensed]) -> None:
        for name, one in zip(self.names, sensed, strict=True):
            given = {"tick": self.ticks, "phase": phase, "now": self.bodies.worlds.now, "sensed": as_text(one)}
            self._step[name].publish(String(data=json.dumps(given)))


def odometry_of(sensed: Sensed, name: str, scale: float) -> Odometry:
    """Return a pose as odometry, on a floor of `scale` [m] for a unit of the mission's lengths."""
    odometry = Odometry()
    odometry.header.frame_id, odometry.child_frame_id = "ground", name
    pose = odometry.pose.pose
    pose.position.x, pose.position.y = scale * sensed.x, scale * sensed.y
    pose.orientation.z, pose.orientation.w = sin(0.5 * sensed.heading), cos(0.5 * sensed.heading)
    return odometry
