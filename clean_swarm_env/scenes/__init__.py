"""Scenes: for every goal of the library an arena in which robots have to reach it, and the measures of success.

Importing this package registers them; `find(goal)` returns the scene of a goal, `goals()` lists them all.
"""

from clean_swarm_env.scenes.scene import SCENES as SCENES
from clean_swarm_env.scenes.scene import Measure as Measure
from clean_swarm_env.scenes.scene import Scene as Scene
from clean_swarm_env.scenes.scene import Setting as Setting
from clean_swarm_env.scenes.scene import find as find
from clean_swarm_env.scenes.scene import goals as goals
from selforg.registry import import_modules

import_modules(__name__)
