"""The trials of a study in a storage of optuna, for its dashboard and other tools; and the importance of parameters."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import optuna
from optuna.importance import get_param_importances
from optuna.storages import BaseStorage, JournalStorage, RDBStorage
from optuna.storages.journal import JournalFileBackend
from optuna.trial import FrozenTrial, TrialState, create_trial

from selector.documents.errors import DocumentError, within
from selector.store.connection import parsed
from selector.store.errors import reported
from train.studies.missions import COST, FIGURES
from train.studies.proposals import distributions
from train.studies.search import StudyTrial
from train.studies.space import StudySpace

JOURNAL_SCHEME = "journal:"
"""Begins the URL of a journal file, which processes on several machines may append to (network drives)."""
FEWEST = 4
"""Least number of trials from which importances are computed."""


class TrialStorage:
    """A storage of optuna that gets the trials of a study.

    Args:
        url: sqlite:///PATH, postgresql://USER@HOST/DATABASE, or journal:PATH.

    Raises:
        DocumentError: the storage cannot be used.

    """

    def __init__(self, url: str, *, own: str = "") -> None:
        """Open the storage; `own` names in errors a file that the study keeps itself and makes again."""
        given = url.partition("://")[0] if "://" in url else url
        self._where = f"{own}: may be deleted, the study makes it again" if own else f"--storage {given}"
        if url.startswith(JOURNAL_SCHEME):
            with self._one_line():
                self._storage: BaseStorage = JournalStorage(JournalFileBackend(url.removeprefix(JOURNAL_SCHEME)))
            return
        full = parsed(url).render_as_string(hide_password=False)
        with self._one_line():
            self._storage = RDBStorage(full)

    def keep(self, name: str, trials: Sequence[StudyTrial], space: StudySpace, directions: int) -> None:
        """Add the trials that the study of a `name` lacks; DocumentError if it holds other ones."""
        with self._one_line():
            study = optuna.create_study(
                storage=self._storage, study_name=name, directions=["minimize"] * directions, load_if_exists=True
            )
            held = study.get_trials(deepcopy=False)
            for number, trial in enumerate(trials):
                own = frozen(trial, space, trial.feedback.values)
                if number >= len(held):
                    study.add_trial(own)
                elif (held[number].params, held[number].values) != (own.params, own.values):
                    raise DocumentError(f"study {name!r} holds another trial {number + 1}")

    @contextmanager
    def _one_line(self) -> Iterator[None]:
        """Turn what optuna and a database raise into errors of one line."""
        try:
            with within(self._where), reported("database"):
                yield
        except (OSError, RuntimeError, ValueError, ImportError) as error:
            if isinstance(error, DocumentError):
                raise
            raise DocumentError(f"{self._where}: {' '.join(str(error).split())}") from error


def importances(trials: Sequence[StudyTrial], space: StudySpace) -> dict[str, float]:
    """Return the share of each dimension in the differences of cost, by PED-ANOVA; nothing for too few trials."""
    study = optuna.create_study()
    study.add_trials([frozen(trial, space, trial.means[COST : COST + 1]) for trial in trials])
    if len(study.get_trials(states=(TrialState.COMPLETE,))) < FEWEST:
        return {}
    found = get_param_importances(study)
    return {name: float(found.get(name, 0.0)) for name in space.names}


def frozen(trial: StudyTrial, space: StudySpace, values: Sequence[float]) -> FrozenTrial:
    """Return a trial as optuna keeps it; one without values failed."""
    return create_trial(
        state=TrialState.COMPLETE if values else TrialState.FAIL,
        values=list(values) or None,
        params=dict(zip(space.names, trial.candidate.values, strict=True)),
        distributions=distributions(space),
        user_attrs={
            "name": trial.candidate.name,
            "scenarios": trial.scenarios,
            **dict(zip(FIGURES, trial.means, strict=False)),
        },
    )
