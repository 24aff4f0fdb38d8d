"""The study behind `clean-swarm study configure`: one option, all its numbers and flags."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from clean_swarm_env.config.known import knowledge_of
from clean_swarm_env.config.load import load_family
from selector.documents.errors import validated
from selector.knowledge import load_knowledge
from train.studies.config import StudyConfig
from train.studies.space import default_space


def configured_study(
    option: str, family: str, knowledge: str | None, changes: Mapping[str, Any], directories: tuple[Path, ...] = ()
) -> StudyConfig:
    """Return the study of an option for a family, with the default space and `changes`.

    Raises:
        DocumentError: the family, the knowledge or the option does not exist, or `changes` do not fit.

    """
    config = load_family(family, directories)
    known = load_knowledge(knowledge, directories) if knowledge else knowledge_of(config.mission, directories)
    content = {
        "name": f"{option}-{config.name}",
        "description": f"{option}, configured for {config.name}.",
        "family": family,
        "knowledge": knowledge,
        "space": default_space(known, option, directories),
        **changes,
    }
    return validated(StudyConfig, content, "configure")
