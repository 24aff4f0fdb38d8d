"""Strategies that learn the value of each option from rewards."""

from selforg.registry import import_modules

import_modules(__name__)
