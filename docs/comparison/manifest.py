"""Document model of a comparison: what is raced and trained, and with what it is compared on which families."""

from typing import Annotated, Any

from pydantic import Field

from clean_swarm_env.config.types import Count, Robots, Scenarios
from selector.documents.fields import Closed, DocumentName, JointName, Name, Share


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
    told: dict[Name, JointName] = Field(default_factory=dict)
    """Component of the observation -> options where it is the largest, for a team that is told; those that the race
    finds for each kind of scenario unless given."""
    headroom: bool = False
    """Whether a team that is told is known to gain something, and stands beside."""


class Race(Closed):
    """The race of all options of the goals, joined, on training scenarios: `clean-swarm study headroom --kinds`."""

    searched: Scenarios
    finalists: Count
    seed: int


class Variant(Closed):
    """A family with other numbers of robots, or messages that are lost."""

    family: Name
    robots: tuple[Robots, Robots] | None = None
    loss: Share = 0.0


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
    learners: Annotated[dict[Name, Learner], Field(min_length=1)]
    """Label -> trainings. The first is what is claimed."""
    rules: dict[Name, str] = Field(default_factory=dict)
    """Label -> rule, as `--strategy` takes it; judged where the goals of the comparison are decided."""
    race: Race
    """How the best options are found."""
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
