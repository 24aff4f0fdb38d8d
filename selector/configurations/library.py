"""The configuration library: all mechanism configurations by key, one YAML file each."""

from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from selector.configurations.configuration import ConfigurationSpec
from selector.configurations.host import trial_host
from selector.configurations.running import RunningConfiguration
from selector.documents.errors import shown, validated, within
from selector.documents.find import files_of
from selector.documents.parameters import check_parameters_used, declared_parameters, resolved
from selector.documents.plain import must_know
from selector.documents.reading import read_mapping
from selector.knowledge import Option


class Library:
    """All configurations of some directories and of the shipped one; a key in an earlier directory hides a later one.

    A file is read and checked when its configuration is first asked for: one that nobody uses may be half written.

    Args:
        directories: searched for `mechanisms/*.yaml` before the shipped directory.

    Raises:
        DocumentError: there is no such directory.

    >>> Library().configuration("RepulsionGradient", {"view_distance": 1.0}).mechanisms["avoidance"].parameters
    {'view_distance': 1.0}

    """

    def __init__(self, directories: Sequence[Path] = ()) -> None:
        self._paths = files_of("mechanisms", directories)
        self._documents: dict[str, dict[str, Any]] = {}

    @property
    def keys(self) -> tuple[str, ...]:
        """Names of all configurations, sorted."""
        return tuple(self._paths)

    def configuration(self, key: str, parameters: Mapping[str, Any] | None = None) -> ConfigurationSpec:
        """Return a configuration with its parameters overridden by `parameters`.

        Raises:
            DocumentError: the file cannot be read, or the configuration cannot be built.

        """
        must_know("configuration", key, self.keys)
        where = shown(self._paths[key])
        document = self._documents.get(key) or read_mapping(self._paths[key])
        with within(where):
            content = resolved(document, parameters or {})
        configuration = validated(ConfigurationSpec, content, where)
        RunningConfiguration(configuration, trial_host(configuration), where)
        if key not in self._documents:
            with within(where):
                check_parameters_used(document)
            self._documents[key] = document
        return configuration

    def parameters(self, key: str) -> dict[str, Any]:
        """Return the parameters of a configuration that options may override, with their own values."""
        self.configuration(key)
        return dict(declared_parameters(self._documents[key]))

    def of_option(self, option: Option, where: str) -> ConfigurationSpec:
        """Return the configuration of an option with the parameters of the option; `where` begins errors."""
        with within(where):
            return self.configuration(option.configuration, option.parameters)


@cache
def library_of(directories: tuple[Path, ...] = ()) -> Library:
    """Return the library of some directories; a process reads it once."""
    return Library(directories)
