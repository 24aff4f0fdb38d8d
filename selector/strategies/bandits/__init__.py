"""Strategies that learn from rewards how good each option is."""

from selforg.registry import import_modules

import_modules(__name__)
