"""Scenes: for every goal of the library an arena in which it is to be reached, and the measure by which it is.

Importing this package registers them; `find(goal)` returns the scene of a goal, `goals()` lists them all.
"""

from clean_swarm_env.scenes import agreement as agreement
from clean_swarm_env.scenes import avoidance as avoidance
from clean_swarm_env.scenes import exploration as exploration
from clean_swarm_env.scenes import foraging as foraging
from clean_swarm_env.scenes import formation as formation
from clean_swarm_env.scenes import patrol as patrol
from clean_swarm_env.scenes import potential as potential
from clean_swarm_env.scenes import reach_goal as reach_goal
from clean_swarm_env.scenes import uniform as uniform
from clean_swarm_env.scenes.scene import Measure as Measure
from clean_swarm_env.scenes.scene import Scene as Scene
from clean_swarm_env.scenes.scene import Setting as Setting
from clean_swarm_env.scenes.scene import find as find
from clean_swarm_env.scenes.scene import goals as goals
