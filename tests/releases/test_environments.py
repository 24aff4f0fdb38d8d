"""What release 1.0.0 froze of `clean_swarm_v0`: spaces, options, rewards, and how courses begin."""

import pytest

from selector.documents.reading import read_json
from tests.releases.environments import GROWING, environments
from tests.releases.test_files import HERE

FROZEN = read_json(HERE / "1.0.0" / "environments.json")
"""What must stay: a change of it is `clean_swarm_v1` (docs/versions.md)."""


@pytest.fixture(scope="module")
def today():
    return environments()


@pytest.mark.parametrize("name", FROZEN)
def test_an_environment_is_what_it_was_in_1_0_0(today, name):
    frozen, now = dict(FROZEN[name]), dict(today[name])
    assert set(frozen.pop(GROWING, ())) <= set(now.pop(GROWING, ()))
    assert now == frozen
