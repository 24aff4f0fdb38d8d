import pytest

from tests.selforg.network.side_by_side import live
from tests.selforg.network.soak import STEPS

CHUNK = 20


@pytest.mark.parametrize("first", range(0, 300, CHUNK))
def test_random_networks_equal_the_naive_reference(first):
    assert [told for seed in range(first, first + CHUNK) if (told := live(seed, STEPS)[0])] == []
