"""Tasks: the work in a world. `Task` is the base class of a task of your own; importing this registers ours.

`TASKS` has the tasks by name; cleaning is in `clean_swarm_env.tasks.cleaning.task`.
"""

import clean_swarm_env.tasks.cleaning.by_hand  # noqa: F401  (its changes of items)
from clean_swarm_env.config.tasks import TASKS as TASKS
from clean_swarm_env.config.tasks import ItemsConfig as ItemsConfig
from clean_swarm_env.config.tasks import TaskSettings as TaskSettings
from clean_swarm_env.tasks.cleaning.task import Cleaning as Cleaning
from clean_swarm_env.world.by_hand import by_hand as by_hand
from clean_swarm_env.world.parts.measure import Achievement as Achievement
from clean_swarm_env.world.parts.measure import Measure as Measure
from clean_swarm_env.world.parts.shown import Destination as Destination
from clean_swarm_env.world.parts.shown import Drawn as Drawn
from clean_swarm_env.world.parts.shown import Shown as Shown
from clean_swarm_env.world.parts.things import TaskState as TaskState
from clean_swarm_env.world.parts.things import Things as Things
from clean_swarm_env.world.parts.things import WorldStart as WorldStart
from clean_swarm_env.world.task import Task as Task
from clean_swarm_env.world.view import TaskView as TaskView
from selforg.registry import import_modules

import_modules(__name__)
