"""Files of start configurations of cleaning, with its stations."""

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import StartsFile
from clean_swarm_env.config.types import Point
from clean_swarm_env.tasks.cleaning.settings import CleaningSettings, settings_of


class CleaningStarts(StartsFile):
    """A file of start configurations with its torus and stations."""

    recycling: Point
    """Position of the recycling station [m]."""
    dump: Point
    """Position of the dump station [m]."""

    def task_of(self, mission: MissionConfig) -> CleaningSettings:
        """Return the settings with the stations of this file."""
        task = settings_of(mission)
        stations = task.stations.model_copy(update={"recycling": self.recycling, "dump": self.dump})
        return task.model_copy(update={"stations": stations})
