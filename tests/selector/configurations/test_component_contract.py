"""Every registered sensor, action and activator can be declared in a document, a reader's own as those that ship."""

import numpy as np
import pytest

from clean_swarm_env.testing import check_activator
from clean_swarm_env.testing.components import PARTS, declared
from selector.configurations.configuration import ConfigurationSpec
from selector.configurations.host import trial_host
from selector.configurations.running import RunningConfiguration
from selector.documents.errors import DocumentError, validated
from selector.vocabulary.conditions import ActivatorSpec
from selector.vocabulary.settings import SettingsSpec
from selforg.components import ACTIONS, SENSORS, Action, MovementSource, SensorComponent
from selforg.network.model.activators import ACTIVATORS, THRESHOLD_RULE, Activator
from selforg.network.model.behaviours import NetworkSettings
from selforg.parameters import AtLeastZero
from selforg.plugins import PluginError
from tests.selforg.components import test_contract as own_components  # registers components of its own


@SENSORS.register
class Fast(SensorComponent):
    """A fact: the movement is faster than a limit."""

    kind = "fact"

    def __init__(self, mechanism: MovementSource, limit: AtLeastZero = 0.5) -> None:
        self.sources = (mechanism,)
        self._vectors, self._limit = mechanism.vectors, limit

    def read(self, rows):
        return np.linalg.norm(self._vectors[rows], axis=1) > self._limit


@ACTIVATORS.register
class Low(Activator):
    """Fulfilled at or below 1."""

    kind = THRESHOLD_RULE
    parameters = (1.0, 0.0, -1.0)


def document(sensors=(), actions=()):
    """Return the content of a configuration with these sensors and one behaviour with these actions."""
    return {
        **PARTS,
        "sensors": {f"sensor {k}": sensor for k, sensor in enumerate(sensors)},
        "behaviours": {"Do": {"action": list(actions) or {"type": "Move", "mechanism": "go"}}},
    }


def running(content):
    spec = validated(ConfigurationSpec, content, "mine.yaml")
    return RunningConfiguration(spec, trial_host(spec), "mine.yaml")


@pytest.mark.parametrize("cls", [*SENSORS, *ACTIONS], ids=lambda cls: cls.__name__)
def test_what_a_class_does_not_take_is_refused_with_its_place(cls):
    sensor = issubclass(cls, SensorComponent)
    content = declared(cls, {}) | {"luck": 7}
    whole = document([content]) if sensor else document(actions=[content])
    place = "sensors.sensor 0" if sensor else "behaviours.Do.action.0"
    with pytest.raises(DocumentError, match=rf"^mine.yaml: {place}.{cls.__name__}.luck: unknown key 'luck'"):
        running(whole)
    assert issubclass(own_components.Back, Action)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ({"type": "Fast"}, "sensors.sensor 0.Fast.mechanism: missing key"),
        ({"type": "Fast", "mechanism": "quorum"}, "mechanism: expected a movement mechanism, got 'quorum', which is a"),
        ({"type": "Fast", "mechanism": "go", "limit": -1.0}, "Fast.limit: expected greater than or equal to 0, got -1"),
        ({"type": "Fast", "mechanism": "go", "limit": "no"}, "Fast.limit: expected a valid number, got 'no'"),
        ({"type": "Fats", "mechanism": "go"}, "unknown sensor 'Fats' (known: Changed, .*did you mean 'Fast'"),
    ],
)
def test_a_mistake_about_ones_own_class_is_told_as_about_any(content, message):
    with pytest.raises(DocumentError, match=message.replace("(", r"\(")):
        running(document([content]))


@pytest.mark.parametrize("cls", list(ACTIVATORS), ids=ACTIVATORS.names())
def test_an_activator_keeps_its_contract_and_what_it_does_not_take_is_refused(cls):
    check_activator(cls)
    content = {"type": cls.__name__, **cls.example, "low": 0.25, "high": 0.75}
    assert validated(ActivatorSpec, content, "mine.yaml").build() == cls(**cls.example, low=0.25, high=0.75)
    with pytest.raises(DocumentError, match=rf"mine.yaml: {cls.__name__}.luck: unknown key 'luck'"):
        validated(ActivatorSpec, content | {"luck": 7}, "mine.yaml")
    with pytest.raises(DocumentError, match="expected 0 <= low <= high <= 1"):
        validated(ActivatorSpec, content | {"low": 0.8}, "mine.yaml")


@pytest.mark.parametrize(
    ("members", "said"),
    [
        ({"kind": 7}, "Odd.__init__: expected a kind that is one of our rules"),
        ({"parameters": (np.nan, 0.0, 1.0)}, "Odd.parameters: expected two finite numbers and the sign"),
        ({"parameters": (1.0, 0.0, 0.5)}, "Odd.parameters: expected two finite numbers and the sign"),
    ],
)
def test_an_activator_that_breaks_its_contract_is_one_line(members, said, monkeypatch):
    cls = type("Odd", (Low,), {**members, "__module__": __name__})
    monkeypatch.setitem(ACTIVATORS._classes, "Odd", cls)
    with pytest.raises(PluginError, match=said):
        check_activator(cls)


def test_settings_that_a_document_leaves_out_are_those_of_a_network():
    assert SettingsSpec().build() == NetworkSettings()
