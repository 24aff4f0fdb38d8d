"""Decision strategies, which choose the option that serves a goal; importing the package registers them."""

from selforg.registry import import_modules

import_modules(__name__)
