"""Where the tests find the checkout and what it has for them."""

from pathlib import Path

ROOT = Path(__file__).parents[1]
TRAINED = ROOT / "tests" / "trained"
"""A directory of configurations with a policy and a learned strategy, which no longer ship."""
