"""Files of state machines that choose options: probabilistic finite state machines as YAML.

In each decision a robot goes along the first transition of its state that is open, if there is one, and then takes the
option of its state. Like the machines that AutoMoDe designs (Francesca et al. 2014, doi:10.1007/s11721-014-0092-4).
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import Field, model_validator

from selector.documents.errors import DocumentError, impossible
from selector.documents.fields import JOINT, Closed, JointName, Name, Number, Share
from selector.documents.find import load_file
from selector.strategies.probing import Probing
from selector.strategies.problem import Problem, must_know_component

MOST_STATES = 16
"""Most states, and most transitions of a state."""


class Transition(Closed):
    """A way to another state, which is open if all its conditions are met."""

    to: Name
    """The state to which it leads."""
    when: Name | None = None
    """Component of the observation that is compared; None: the way is open whatever the robot sees."""
    above: Number | None = None
    """The component has to be larger; None: no bound."""
    below: Number | None = None
    """The component has to be smaller; None: no bound."""
    probability: Share = 1.0
    """Probability in each decision that the way is open if the component is within the bounds [-]."""

    @model_validator(mode="after")
    def _possible(self) -> Self:
        bounds = [bound for bound in (self.above, self.below) if bound is not None]
        if (self.when is None) == bool(bounds):
            expected = "a component with a bound, above or below" if self.when else "a component that is compared"
            raise impossible("when", expected, self.when or "none")
        if len(bounds) == 2 and bounds[0] >= bounds[1]:
            raise impossible("above", f"less than below, {bounds[1]:g}", f"{bounds[0]:g}")
        return self


class MachineState(Closed):
    """A state of a machine."""

    option: JointName
    """Option that robots in this state take."""
    transitions: Annotated[tuple[Transition, ...], Field(max_length=MOST_STATES)] = ()
    """Ways to other states, of which the first open one is taken."""


class StateMachine(Closed):
    """A finite state machine; each robot is in a state of its own."""

    goal: JointName
    """Name of the self-organisation goal."""
    description: str = ""
    """What it does, in one sentence."""
    terms: tuple[Name, ...] = ()
    """Terms of the observation that it looks at beside the usual ones and those of the mission."""
    start: Name
    """State of every robot before its first decision."""
    states: Annotated[dict[Name, MachineState], Field(min_length=1, max_length=MOST_STATES)]
    """The states."""
    probing: Probing = Probing()
    """Which robots try another of its options; none unless given."""
    training: dict[str, Any] = Field(default_factory=dict)
    """How it was designed: command, configuration, seed, figures."""

    @model_validator(mode="after")
    def _exist(self) -> Self:
        ways = {
            f"states.{name}.transitions.{k}.to": way.to
            for name, state in self.states.items()
            for k, way in enumerate(state.transitions)
        }
        if self.probing.sampled:
            raise impossible("probing.sampled", "false: a machine gives no probabilities of options", "true")
        for key, name in {"start": self.start, **ways}.items():
            if name not in self.states:
                raise impossible(key, f"one of the states {', '.join(self.states)}", name)
        return self

    @property
    def ways(self) -> list[Transition]:
        """All transitions."""
        return [way for state in self.states.values() for way in state.transitions]

    def for_goal(self, goal: str) -> Self:
        """Return the machine with joint goals, and the parts of its options, in the order that `goal` has them in."""
        own, wanted = self.goal.split(JOINT), goal.split(JOINT)
        if self.goal == goal or sorted(own) != sorted(wanted):
            return self
        places = [own.index(name) for name in wanted]

        def ordered(option: str) -> str:
            names = option.split(JOINT)
            return JOINT.join(names[k] for k in places) if len(names) == len(places) else option

        content = self.model_dump(exclude_unset=True) | {"goal": goal}
        for choice in (*content["states"].values(), content.get("probing", {})):
            choice |= {"option": ordered(choice["option"])} if choice.get("option") else {}
        return self.model_validate(content)

    def check_fits(self, problem: Problem, where: str) -> None:
        """Raise DocumentError unless goal, options and components are those of a problem."""
        if self.goal != problem.goal:
            raise DocumentError(f"{where}: made to decide {self.goal}, got {problem.goal} to decide")
        problem.check_options(f"{where}: options", (state.option for state in self.states.values()))
        for way in self.ways:
            if way.when is not None:
                must_know_component(way.when, problem.features, where)


def load_machine(name: str, directories: Sequence[Path] = ()) -> StateMachine:
    """Return the machine of a name or of a path; DocumentError if there is none, or if it has a mistake."""
    return load_file("machines", name, StateMachine, directories)
