"""Types that all models of the configuration share, with their bounds and the reasons for these.

Why every number has bounds: docs/decisions/0066-bounds.md.
"""

from typing import Annotated, Final

from pydantic import Field

from selector.documents.errors import DocumentError
from selector.documents.fields import Number

ConfigurationError = DocumentError
"""A configuration, a file or a name that cannot be used."""

Count = Annotated[int, Field(strict=True, ge=1, le=10_000_000)]
"""A number of steps of learning; a day has room for some millions."""
Robots = Annotated[int, Field(strict=True, ge=1, le=10_000)]
"""Robots of one world; ten thousand take some gigabytes where delivery is not ideal, since each knows the others."""
Index = Annotated[int, Field(strict=True, ge=0, le=10_000)]
"""Number of a robot, from 0; or a number of robots or events that may be 0."""
AVOIDANCE: Final = "AvoidCollision"
"""The goal whose options keep robots clear of each other."""
Items = Annotated[int, Field(strict=True, ge=0, le=100_000)]
"""Items of one world; a robot looks for the nearest among those in sight."""
Scenarios = Annotated[int, Field(strict=True, ge=1, le=10_000)]
"""Missions of an evaluation; intervals of ten thousand are narrower than any model is true."""
WorldCount = Annotated[int, Field(strict=True, ge=1, le=10_000)]
"""Worlds side by side."""
Length = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=1e-3, le=1e4)]
"""A size [m], from a millimetre to ten kilometres, which a robot crosses in a simulated day."""
Rate = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0.01, le=10_000.0)]
"""Steps per second [Hz]; a mission of a thousand steps a second is slower than the real one."""
Seconds = Annotated[float, Field(strict=True, allow_inf_nan=False, gt=0.0, le=1e7)]
"""A time in a mission [s], up to four months."""
Wait = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0.0, le=3600.0)]
"""A time for which a robot stops [s], up to an hour."""
ArrivalRate = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0.0, le=10_000.0)]
"""Items that arrive in a minute [1/min]; robots cannot clean a hundredth of it."""
Point = tuple[Number, Number]
Spots = Annotated[tuple[Point, ...], Field(max_length=100)]
"""Centres of places about which garbage comes [m]; more of them would cover any torus evenly."""
Pose = tuple[Number, Number, Number]
