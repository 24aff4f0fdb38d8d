"""What a robot observes, term by term. Importing this package registers all terms, those of our tasks too."""

from importlib import import_module

from clean_swarm_env.config.task_names import TASKS_HOME
from selforg.registry import import_modules

import_modules(__name__)
import_module(TASKS_HOME)
