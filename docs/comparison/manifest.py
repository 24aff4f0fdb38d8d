"""Document model of a comparison: which strategies are judged on which families, and by which comparisons."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from clean_swarm_env.config.types import Count, Scenarios
from clean_swarm_env.deciders.named import FIXED
from selector.documents.errors import impossible
from selector.documents.fields import Closed, DocumentName, JointName, Name
from train.analysis.verdict import RANDOM

BEST = "best"
"""Label of the cheaper of the fixed options of a family: chosen on one half of the scenarios, judged on the other."""
OFF = "no avoidance"
"""Label of options that never avoid."""
TOLD = "told"
"""Label of a team that knows what no robot can know."""


class Imitation(Closed):
    """How a network learns to choose as a told team does: rounds of whole missions, see `docs.comparison.imitation`."""

    rounds: Count = 4
    """Rounds; in the first one told teams do the missions, in the others the network does."""
    scenarios: Scenarios = 4
    """Missions of each family in a round."""
    hidden: tuple[Count, ...] = (32,)
    """Widths of the hidden layers; none: logistic regression."""


class Trained(Closed):
    """A learner; the result of each of its trainings is judged."""

    training: DocumentName
    """The training of PPO; of an imitation, that whose families, goals, observation and `ppo.holds` it has."""
    seeds: Annotated[tuple[Count, ...], Field(min_length=1)]
    """Seed of each training."""
    imitation: Imitation | None = None
    """Imitate told teams, in place of PPO."""
    critic: Literal["own", "team"] = "own"
    """What the value function of PPO sees: what the robot sees, or the global state of its world, too (MAPPO)."""
    start: Name | None = None
    """Label of the imitation from whose network PPO starts, that of the same seed."""


class Taught(Closed):
    """What serves on a family, by races on training scenarios."""

    fixed: Annotated[tuple[JointName, ...], Field(min_length=1)]
    """Options that races on training scenarios named; the cheaper of them is what others are compared with."""
    told: dict[str, JointName] = Field(default_factory=dict)
    """Kind of scenario -> what a told team holds there."""
    told_by: dict[Name, JointName] = Field(default_factory=dict)
    """Component of the observation -> what a told team holds while it is the largest, in place of `told`."""
    goal: JointName | None = None
    """Goals whose options are chosen, in place of those of the comparison."""
    file: str = ""
    """File of the family beside the manifest; a family that ships has none."""


class Compared(Taught):
    """A family on which all are compared."""

    scenarios: Scenarios
    """Number of test scenarios."""
    off: JointName | None = None
    """Options that never avoid."""


class Manifest(Closed):
    """What is compared."""

    name: Name
    """Name of the page in docs/, or of the directory of the results below results/."""
    page: bool = False
    """Whether a page shows the tables; else they are printed."""
    goal: JointName
    """Goals whose options are chosen."""
    seed: int
    """Seed of the test scenarios."""
    strategies: dict[Name, str] = Field(default_factory=dict)
    """Label -> strategy, as `--strategy` takes it. The first is claimed, and compared with the others, too."""
    trained: dict[Name, Trained] = Field(default_factory=dict)
    """Label -> learner, which is trained first."""
    seen: dict[Name, Taught] = Field(default_factory=dict)
    """Families that trainings see, and what imitations are taught there; nobody is judged on them."""
    only: dict[Name, tuple[Name, ...]] = Field(default_factory=dict)
    """Label -> families on which it is judged; all unless given."""
    better: tuple[Name, ...] = ()
    """Families on which the claimed strategy has to be shown to cost less than the fixed options."""
    at_most: dict[Name, float] = Field(default_factory=dict)
    """Family -> the largest ratio to the best configured pair with which a learner is accepted."""
    families: Annotated[dict[Name, Compared], Field(min_length=1)]
    """Families."""

    @model_validator(mode="after")
    def _start(self) -> Self:
        for label, own in self.trained.items():
            first = self.trained.get(own.start or label)
            if own.start and (first is None or first.imitation is None or not set(own.seeds) <= set(first.seeds)):
                raise impossible(f"trained.{label}.start", "an imitation with the same seeds", repr(own.start))
        return self

    @property
    def claimed(self) -> str:
        """Label of what is claimed: the first strategy; of trainings alone the first of these."""
        return next(iter([*self.strategies, *self.trained]))

    def judged_on(self, family: str) -> list[str]:
        """Return the labels that are judged on a family beside the fixed options."""
        compared = self.families[family]
        named = [*self.strategies, *self.trained]
        found = [label for label in named if family in self.only.get(label, (family,))]
        told = bool(compared.told or compared.told_by)
        chance = family in self.only.get(RANDOM, (family,))
        return [*found, *[TOLD] * told, *[RANDOM] * chance, *[OFF] * (compared.off is not None)]

    def run_on(self, family: str) -> list[str]:
        """Return the labels of all that do missions on a family, one for each training of a learner."""
        found = [f"{FIXED}:{options}" for options in self.families[family].fixed]
        return [*found, *(run for label in self.judged_on(family) for run in self.runs_of(label))]

    def runs_of(self, label: str) -> list[str]:
        """Return the labels under which the missions of a label are kept: those of each training if it has several."""
        seeds = self.trained[label].seeds if label in self.trained else ()
        return [f"{label} {seed}" for seed in seeds] if len(seeds) > 1 else [label]

    @property
    def trainings(self) -> dict[str, tuple[str, int]]:
        """Label of the missions of a training -> label of its learner, and its seed."""
        return {
            run: (label, seed)
            for label, own in self.trained.items()
            for run, seed in zip(self.runs_of(label), own.seeds, strict=True)
        }

    @property
    def comparisons(self) -> list[tuple[str, str, str]]:
        """Family, label, and label with which it is compared: all of the page, which are judged together."""
        return [
            (family, label, against)
            for family in self.families
            for judged in (self.judged_on(family),)
            for label, against in (
                *((label, BEST) for label in judged),
                *((self.claimed, other) for other in self.strategies if other != self.claimed and other in judged),
            )
        ]
