"""What learners see of cleaning, and what they are counted for. Importing this package registers its terms."""

from selforg.registry import import_modules

import_modules(__name__)
