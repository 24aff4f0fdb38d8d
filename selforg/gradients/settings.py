"""Settings of a buffer, and the codes of its aggregation rules."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from selforg.parameters import at_least, check_choice, positive

AGGREGATE_DROP, AGGREGATE_MAX, AGGREGATE_MIN, AGGREGATE_AVERAGE = 0, 1, 2, 3
AGGREGATE_NEW, AGGREGATE_NEW_SOURCE, AGGREGATE_NEW_CHANNEL = 4, 5, 6

AGGREGATION_RULES: Mapping[str, int] = {
    "max": AGGREGATE_MAX,
    "min": AGGREGATE_MIN,
    "average": AGGREGATE_AVERAGE,
    "new": AGGREGATE_NEW,
    "newparent": AGGREGATE_NEW_SOURCE,
    "newframe": AGGREGATE_NEW_CHANNEL,
}


@dataclass(frozen=True)
class BufferSettings:
    """Which gradients a buffer keeps, and how; raises ValueError for impossible values.

    Attributes:
        view_distance: default margin of the view [m]: a gradient is seen within its reach + this.
        aggregation: channel -> rule (max, min, average, new, newparent, newframe); DEFAULT for channels not named.
            Without a rule a static gradient is dropped.
        aggregation_distance: static gradients closer than this aggregate [m].
        min_diffusion: a gradient without goal area and with less diffusion than this is deleted [m].
        moving_storage_size: moving gradients kept per channel and source.
        store_all: keep all channels; otherwise only those in `channels`.
        channels: channels to keep.
        whole_seconds: evaporate as the original does, by whole seconds of age (Q3), instead of exactly.
        hidden: whether gradients behind the walls that the poses know are not seen.
        smallest_cell: bound of the lowest level of reaches [m]; changes speed, never results.

    """

    view_distance: float = 1.5
    aggregation: Mapping[str, str] = field(default_factory=lambda: {"DEFAULT": "max"})
    aggregation_distance: float = 1.0
    min_diffusion: float = 0.1
    moving_storage_size: int = 2
    store_all: bool = True
    channels: tuple[str, ...] = ()
    whole_seconds: bool = False
    hidden: bool = False
    smallest_cell: float = 0.5

    def __post_init__(self) -> None:
        """Check every field."""
        for name in ("view_distance", "aggregation_distance", "min_diffusion", "moving_storage_size"):
            at_least(self, name, getattr(self, name), 0)
        positive(self, "smallest_cell", self.smallest_cell)
        for channel, rule in self.aggregation.items():
            check_choice(f"BufferSettings: aggregation of {channel!r}", rule, AGGREGATION_RULES)

    def rule_of(self, channel: str) -> int:
        """Return the code of the aggregation rule of `channel`."""
        name = self.aggregation.get(channel, self.aggregation.get("DEFAULT"))
        return AGGREGATE_DROP if name is None else AGGREGATION_RULES[name]
