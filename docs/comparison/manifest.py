"""Document model of a comparison: which strategies are judged on which families, and by which comparisons."""

from typing import Annotated

from pydantic import Field

from clean_swarm_env.config.types import Scenarios
from clean_swarm_env.deciders.named import FIXED
from selector.documents.fields import Closed, DocumentName, JointName, Name
from train.analysis.verdict import RANDOM

BEST = "best"
"""Label of the cheaper of the fixed options of a family: chosen on one half of the scenarios, judged on the other."""
OFF = "no avoidance"
"""Label of options that never avoid."""
TOLD = "told"
"""Label of a team that knows what no robot can know."""


class Trained(Closed):
    """A training whose result is judged."""

    training: DocumentName
    seed: int


class Compared(Closed):
    """A family on which all are compared."""

    scenarios: Scenarios
    """Number of test scenarios."""
    fixed: Annotated[tuple[JointName, ...], Field(min_length=1)]
    """Options that races on training scenarios named; the cheaper of them is what others are compared with."""
    off: JointName | None = None
    """Options that never avoid."""
    told: dict[str, JointName] = Field(default_factory=dict)
    """Kind of scenario -> what a told team holds there."""
    told_by: dict[Name, JointName] = Field(default_factory=dict)
    """Component of the observation -> what a told team holds while it is the largest, in place of `told`."""
    goal: JointName | None = None
    """Goals whose options are chosen, in place of those of the comparison."""
    file: str = ""
    """File of the family beside the manifest; a family that ships has none."""


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
    """Label -> training, which is done first."""
    only: dict[Name, tuple[Name, ...]] = Field(default_factory=dict)
    """Label -> families on which it is judged; all unless given."""
    better: tuple[Name, ...] = ()
    """Families on which the claimed strategy has to be shown to cost less than the fixed options."""
    at_most: dict[Name, float] = Field(default_factory=dict)
    """Family -> the largest ratio to the best configured pair with which a learner is accepted."""
    families: Annotated[dict[Name, Compared], Field(min_length=1)]
    """Families."""

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
        """Return the labels of all that do missions on a family."""
        return [*(f"{FIXED}:{options}" for options in self.families[family].fixed), *self.judged_on(family)]

    def runs_of(self, label: str) -> list[str]:
        """Return the labels under which the missions of a label are kept."""
        return [label]

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
