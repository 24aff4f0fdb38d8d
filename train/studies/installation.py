"""The packages of the extra `tune`, which everything here needs and nothing else."""

from importlib.metadata import PackageNotFoundError

from selector.documents.errors import DocumentError
from train.running.provenance import versions

STUDY_PACKAGES = ("optuna", "cmaes", "ribs")


def study_versions() -> dict[str, str]:
    """Return the versions of all that a study depends on; DocumentError for a missing package."""
    try:
        return versions(STUDY_PACKAGES)
    except PackageNotFoundError as error:
        advice = "pip install -c constraints.txt '.[tune]'"
        raise DocumentError(f"studies need {error.name}, which is not installed: {advice}") from error
