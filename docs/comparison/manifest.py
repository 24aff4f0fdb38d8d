"""Document model of a comparison: which learners are trained, and with what they are compared on which families."""

from typing import Annotated, Any

from pydantic import Field

from clean_swarm_env.config.types import Scenarios
from selector.documents.fields import JOINT, Closed, DocumentName, Flag, JointName, Name
from train.deciders.named import FIXED


class Learner(Closed):
    """Trainings that are alike but for their seeds."""

    training: DocumentName
    """Name of the training."""
    seeds: Annotated[tuple[int, ...], Field(min_length=1)]
    """Seeds of the training."""
    baseline: Flag = False
    """Whether the claimed learner has to be better."""


class Compared(Closed):
    """A family on which all are compared."""

    scenarios: Scenarios
    """Number of test scenarios."""
    control: Flag = False
    """Whether nothing is to be gained there: the learner has to be no worse than the best fixed choice."""
    looked_ahead: int = 0
    """Number of the first test scenarios on which teams look ahead, too, from what the claimed learner does."""


class Configured(Closed):
    """The option that is configured, as `clean-swarm study configure` does it."""

    option: Name
    family: Name
    trials: int


class Ablation(Closed):
    """A training with something else or less."""

    learner: Name | None = None
    """Label of the learner whose training it is; none: the claimed one."""
    changes: dict[Name, Any] = Field(default_factory=dict)
    """Entries of the training -> what they are instead."""
    without: Name | None = None
    """Option that the library lacks."""
    only: Name | None = None
    """The only option that the library has."""


class Ablations(Closed):
    """What trainings are compared with."""

    seeds: Annotated[tuple[int, ...], Field(min_length=1)]
    """Seeds of each."""
    of: dict[Name, Ablation]
    """Label -> what differs."""


class Paired(Closed):
    """A family on which strategies are judged beside the best pair of options."""

    best: JointName
    """The pair that cost least on training scenarios: an option of the other goal + one of the goal."""
    scenarios: Scenarios
    """Number of test scenarios of each seed."""


class Pairs(Closed):
    """Strategies beside each of several options of another goal, and the best pair of two options."""

    goal: Name
    """The other goal."""
    strategies: dict[str, tuple[Name, ...]]
    """Strategy, as `--strategy` takes it -> the options of the other goal beside which it is judged."""
    families: dict[Name, Paired]
    """Families."""
    seeds: Annotated[tuple[int, ...], Field(min_length=1)]
    """Seeds of the test scenarios."""

    @property
    def best(self) -> dict[str, str]:
        """Family -> the best pair."""
        return {family: paired.best for family, paired in self.families.items()}

    def beside(self, family: str) -> dict[str, list[str]]:
        """Return option of the other goal -> the strategies to run beside it, that of the best pair among them."""
        other, _, own = self.best[family].partition(JOINT)
        found = {other: [f"{FIXED}:{own}"]}
        for strategy, options in self.strategies.items():
            for option in options:
                found.setdefault(option, []).append(strategy)
        return found


class Manifest(Closed):
    """What is trained and compared."""

    name: Name
    """Directory of the results, below results/."""
    page: Flag = False
    """Whether there is a page with its tables, below docs/; of several learners a picture, too, in docs/pictures/."""
    goal: Name
    """Goal that the strategies choose options for."""
    knowledge: DocumentName
    """Name of the expert knowledge with the options."""
    learners: Annotated[dict[Name, Learner], Field(min_length=1)]
    """Label -> trainings. The first is what is claimed."""
    families: Annotated[dict[Name, Compared], Field(min_length=1)]
    """Families."""
    rule: str | None = None
    """The rule by hand, as `--strategy` takes it; none: no such comparison."""
    others: tuple[str, ...] = ()
    """Further strategies to beat."""
    configured: Configured | None = None
    """The option that is configured; none: no such comparison."""
    ablations: Ablations | None = None
    """What the trainings need; none: no such comparison."""
    pairs: Pairs | None = None
    """Options of another goal; none: no such comparison."""

    @property
    def drawn(self) -> bool:
        """Whether there are curves of several learners to compare."""
        return self.page and len(self.learners) > 1

    @property
    def unlearned(self) -> tuple[str, ...]:
        """The rule by hand, and further strategies."""
        return (*filter(None, [self.rule]), *self.others)

    @property
    def claimed(self) -> str:
        """Label of the learner that is claimed."""
        return next(iter(self.learners))
