"""Types that all models of the configuration share."""

from typing import Annotated

from pydantic import Field

from selector.documents.fields import Number

Count = Annotated[int, Field(strict=True, ge=1)]
Index = Annotated[int, Field(strict=True, ge=0)]
Point = tuple[Number, Number]
Pose = tuple[Number, Number, Number]
