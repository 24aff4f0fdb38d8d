"""Decision strategies: which option serves a goal now. Importing the package registers all that are in it."""

from selforg.registry import import_modules

import_modules(__name__)
