"""Claims over families: Holm's correction, and intervals that hold together."""

import numpy as np
import pytest

from docs.comparison.claims import claims_of
from train.analysis.flips import holm


def test_holm_is_between_nothing_and_bonferroni():
    rng = np.random.default_rng(0)
    for _ in range(50):
        ps = rng.uniform(0.0, 0.2, 6)
        corrected = np.array(holm(ps.tolist()))
        assert (corrected >= ps).all()
        assert (corrected <= np.minimum(6 * ps, 1.0) + 1e-12).all()
        assert (
            np.array_equal(np.argsort(ps), np.argsort(corrected, kind="stable"))
            or (np.diff(np.sort(corrected)) == 0).any()
        )
        assert corrected[ps.argmin()] == pytest.approx(min(6 * ps.min(), 1.0))


def test_of_many_families_without_a_difference_hardly_any_is_claimed():
    rng = np.random.default_rng(0)
    wrong, alone = 0, 0
    for _ in range(40):
        families = {
            str(k): {"a": rng.gamma(4.0, 25.0, (1, 30, 1)), "b": rng.gamma(4.0, 25.0, (1, 30, 1))} for k in range(6)
        }
        claims = claims_of([(name, "a", "b") for name in families], families)
        wrong += any(claim.holm < 0.05 for claim in claims)
        alone += any(claim.of.p < 0.05 for claim in claims)
        assert all(c.corrected[0] <= c.ci95[0] <= c.ratio <= c.ci95[1] <= c.corrected[1] for c in claims)
    assert wrong <= 8  # of 40 at 5 %: more would be rarer than one in a thousand
    assert wrong < alone


def test_a_real_difference_is_claimed_on_every_family():
    rng = np.random.default_rng(2)
    families = {str(k): {"a": (b := rng.gamma(9.0, 10.0, (1, 60, 2))) * 0.8, "b": b} for k in range(6)}
    for claim in claims_of([(name, "a", "b") for name in families], families):
        assert claim.holm < 0.01
        assert claim.corrected == pytest.approx((0.8, 0.8))
