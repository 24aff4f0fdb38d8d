"""What a robot observes, term by term. Importing this package imports its modules, which registers the terms."""

from selforg.registry import import_modules

import_modules(__name__)
