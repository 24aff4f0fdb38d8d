"""What all tests share: Hypothesis sets no limit of time for an example, because a loaded machine is not a fault."""

from hypothesis import settings

settings.register_profile("no deadline", deadline=None)
settings.load_profile("no deadline")
