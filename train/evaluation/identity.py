"""What the manifest of an evaluation says: plain data by a stranger, of which nothing is run or imported here."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import BaseModel, ConfigDict, Field

from clean_swarm_env.config.families import FamilyConfig, RobustnessConfig
from selector.documents.errors import validated
from selector.documents.fields import Positive
from train.evaluation.entrants import Entrant
from train.evaluation.trial_task import variants_of
from train.running.run_folder import MANIFEST, Json
from train.running.runs import under

DIGEST = " sha256:"
"""What follows a member that names a file in the manifest."""


class Identity(BaseModel):
    """The identity of an evaluation, without what only some have: an experiment, or a family."""

    model_config = ConfigDict(extra="allow", frozen=True)

    seed: Annotated[int, Field(strict=True, ge=0)]
    """Seed of the evaluation."""
    directories: tuple[Path, ...] = ()
    """The user's own directories of configurations."""
    goal: str = ""
    """Goal that strategies chose options for."""
    strategies: Mapping[str, tuple[str, ...]] = Field(default={})
    """Label of a strategy -> its members, with the digests of their files."""
    deciders: Mapping[str, str] = Field(default={})
    """Condition of an experiment -> its decider, with the digest of its file."""
    periods: tuple[Positive, ...] = ()
    """Lengths of decision periods that were compared [s]."""
    files: Mapping[str, str] = Field(default={})
    """File on which runs depend -> its digest."""

    @classmethod
    def of(cls, manifest: Json, directory: Path) -> Self:
        """Return the identity in the manifest of a directory; an error of one line for a mistake in it."""
        beside = {key: manifest[key] for key in ("directories",) if key in manifest}
        return validated(cls, {**beside, **manifest["identity"]}, f"{directory / MANIFEST}: identity")

    @property
    def of_family(self) -> bool:
        """Whether strategies were compared on a family."""
        return "family" in (self.model_extra or {})

    def content(self, key: str) -> Any:  # noqa: ANN401  (whatever a manifest holds)
        """Return what stands under another key."""
        return (self.model_extra or {}).get(key)

    @property
    def entrants(self) -> list[Entrant]:
        """The strategies, whose members have no digests."""
        return [
            Entrant(label, tuple(member.partition(DIGEST)[0] for member in members))
            for label, members in self.strategies.items()
        ]

    def family(self, directory: Path) -> FamilyConfig:
        """Return the family, with disturbances where it has them."""
        held, where = self.content("family"), f"{directory / MANIFEST}: identity.family"
        if isinstance(held, dict) and "disturbances" in held:
            return validated(RobustnessConfig, held | {"strategies": list(self.strategies)}, where)
        return validated(FamilyConfig, held, where)

    def runs(self, family: FamilyConfig) -> dict[str, tuple[FamilyConfig, str]]:
        """Return condition -> variant of the family, and member with its digest; see `variants_of`."""
        return {
            under(name, condition): (variant, member)
            for name, variant in variants_of(family, self.periods).items()
            for entrant, members in zip(self.entrants, self.strategies.values(), strict=True)
            for condition, member in zip(entrant.conditions, members, strict=True)
        }
