"""The decision strategies that ship with the project; importing a module registers its strategy."""

from selector.strategies import max_score as max_score
