"""Document model of a comparison: what is raced and trained, and with what it is compared on which families."""

from typing import Annotated, Any

from pydantic import Field

from clean_swarm_env.config.types import Count, Robots, Scenarios
from selector.documents.fields import Closed, DocumentName, JointName, Name, Number, Share


class Learner(Closed):
    """Trainings that are alike but for their seeds."""

    training: DocumentName
    """Name of the training."""
    seeds: Annotated[tuple[int, ...], Field(min_length=1)]
    """Seeds of the training."""
    families: tuple[Name, ...] = ()
    """Families on which they are judged; none: all."""


class Compared(Closed):
    """A family on which all are compared."""

    scenarios: Scenarios
    """Number of test scenarios of each seed."""
    goal: JointName | None = None
    """Goals whose best options are raced, in place of those of the comparison."""
    best: JointName | None = None
    """The best options of each goal, joined; raced unless given."""
    searched: Scenarios | None = None
    """Training scenarios of the race, in place of those of the comparison."""
    kinds: dict[str, JointName] = Field(default_factory=dict)
    """With `best`: kind of scenario -> its best options, which a race of all options found before."""
    told: dict[Name, JointName] = Field(default_factory=dict)
    """Component of the observation -> options where it is the largest, for a team that is told; those that the race
    finds for each kind of scenario unless given."""
    headroom: bool = False
    """Whether a team that is told is known to gain something, and stands beside."""


class Screening(Closed):
    """Test scenarios on which all are judged first: only who is not clearly worse is judged on the others.

    Clearly worse is whose ratio to the claimed learner has a lower bound above 1. Of several trainings that which
    validation prefers goes on.
    """

    scenarios: Scenarios
    seed: int


class Race(Closed):
    """The race of all options of the goals, joined, on training scenarios; see `HeadroomEvaluation`."""

    searched: Scenarios
    finalists: Count
    seed: int


class Numbers(Closed):
    """What is raced, and on how many scenarios."""

    searched: Scenarios
    """Most training scenarios of a race."""
    finalists: Count
    """Options with which a race ends."""
    seed: int
    """Seed of the races."""
    confirmed: Scenarios
    """Fresh training scenarios on which the winner meets the best option of the library."""
    fresh: int
    """Their seed."""
    held: dict[Name, Name]
    """Goal -> option that it holds while another goal is raced before it."""
    tried: dict[Name, dict[Name, dict[Name, tuple[Number, ...]]]]
    """Goal -> option -> parameter -> other values."""
    families: Annotated[tuple[Name, ...], Field(min_length=1)]
    """Families on which numbers are raced."""


class Variant(Closed):
    """A family with other numbers of robots, or messages that are lost."""

    family: Name
    robots: tuple[Robots, Robots] | None = None
    loss: Share = 0.0
    scenarios: Scenarios | None = None
    """Number of test scenarios of each seed, in place of those of the family."""


class Ablation(Closed):
    """A training of the claimed learner with something else or less."""

    changes: dict[Name, Any] = Field(default_factory=dict)
    """Entries of the training -> what they are instead; entries of `ppo` replace its own."""
    without: tuple[Name, ...] = ()
    """Options that the library lacks."""


class Ablations(Closed):
    """What trainings are compared with."""

    seeds: Annotated[tuple[int, ...], Field(min_length=1)]
    """Seeds of each."""
    families: Annotated[tuple[Name, ...], Field(min_length=1)]
    """Families on which they are judged."""
    knowledge: DocumentName
    """Name of the knowledge that lacks options."""
    of: dict[Name, Ablation]
    """Label -> what differs."""


class Manifest(Closed):
    """What is raced, trained and compared."""

    name: Name
    """Directory of the results, below results/."""
    page: bool = False
    """Whether a page of this name in docs/ shows the tables; else they are printed."""
    goal: JointName
    """Goals whose options are chosen."""
    seeds: Annotated[tuple[int, ...], Field(min_length=1)]
    """Seeds of the test scenarios."""
    screening: Screening | None = None
    """Scenarios that drop who is clearly worse; none: all are judged on all scenarios."""
    learners: Annotated[dict[Name, Learner], Field(min_length=1)]
    """Label -> trainings. The first is what is claimed."""
    rules: dict[Name, str] = Field(default_factory=dict)
    """Label -> rule, as `--strategy` takes it; judged where the goals of the comparison are decided."""
    race: Race
    """How the best options are found."""
    numbers: Numbers | None = None
    """The race of the numbers of options; none: no such race."""
    families: Annotated[dict[Name, Compared], Field(min_length=1)]
    """Families."""
    variants: dict[Name, Variant] = Field(default_factory=dict)
    """Label -> family that differs, on which the claimed learner and the best options of its base are judged."""
    ablations: Ablations | None = None
    """What the trainings need; none: no such comparison."""

    @property
    def claimed(self) -> str:
        """Label of the learner that is claimed."""
        return next(iter(self.learners))

    def goal_on(self, family: str) -> str:
        """Return the goals that are decided on a family."""
        return self.families[family].goal or self.goal

    def judged_on(self, family: str) -> list[str]:
        """Return the labels of the learners that are judged on a family."""
        return [label for label, learner in self.learners.items() if family in (learner.families or (family,))]
