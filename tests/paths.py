"""Where the tests find the checkout and the recorded numbers beside it."""

from pathlib import Path

ROOT = Path(__file__).parents[1]
SHARED = ROOT.parent / "shared"
TRAINED = ROOT / "tests" / "trained"
"""A directory of configurations with a policy and a learned strategy, which no longer ship, and their trainings."""
