"""Document model of the comparison with the work that came before."""

from typing import Annotated, Literal

from pydantic import Field

from clean_swarm_env.config.types import Scenarios
from selector.documents.fields import Closed, Name

Paid = Literal["", "collided", "own", "aligned", "cost"]
"""By what a strategy is paid: nothing; collisions, in each period; or at each meeting its own time that coordination
took, this and that of others whose nearest robot it was, or the mission's cost."""
ROLES, MIXTURE = "roles", "mixture"
"""Labels of teams that begin with the shares that another one has learned: each robot holds its own most usual option;
or each draws, at each meeting, by the shares of the team."""


class Entrant(Closed):
    """What chooses the options."""

    strategy: str
    """The strategy, as `--strategy` takes it."""
    paid: Paid = ""
    """By what it learns."""


class Place(Closed):
    """Missions on which all entrants of a study are judged."""

    family: str
    """Name of the family; with `.yaml` a file beside the other families of comparisons."""
    robots: Annotated[int, Field(strict=True, ge=2)]
    """Number of robots."""
    scenarios: Scenarios
    """Number of test scenarios."""
    practice: Annotated[int, Field(strict=True, ge=0)] = 0
    """Training scenarios that each learning team does before its test scenario."""


class Study(Closed):
    """One of the papers, tried with our terms."""

    entrants: dict[Name, Entrant]
    """Label -> what is judged beside the fixed options."""
    compared: tuple[tuple[Name, Name], ...]
    """Labels that are compared in each place; `best` is the best fixed option."""
    places: dict[Name, Place]
    """Name -> missions."""


class PriorManifest(Closed):
    """What is compared."""

    goal: Name
    """The goal whose options are chosen."""
    fixed: tuple[Name, ...]
    """Its options."""
    seed: int
    """Seed of all scenarios."""
    shares_of: Name
    """Label of the learner whose shares `roles` and `mixture` begin with."""
    effort: Study
    """Rosenfeld, Kaminka, Kraus and Shehory (2008)."""
    learned: Study
    """Kaminka and Douchan (2025)."""

    @property
    def comparisons(self) -> list[tuple[str, str, str]]:
        """Place, label, and label with which it is compared: all, which are judged together."""
        studies = self.effort, self.learned
        return [(place, *pair) for study in studies for place in study.places for pair in study.compared]
