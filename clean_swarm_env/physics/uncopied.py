"""Objects that cannot be copied."""

from typing import NoReturn, SupportsIndex


class Uncopied:
    """The base class of objects that hold robots that may touch: it refuses copies and pickles.

    Chipmunk keeps contacts in memory of its own. Pymunk copies them, but not the order in which they are solved: of 40
    crowded spaces that pymunk 7.3.1 copied, 33 took another course than their originals within 200 steps.
    """

    def __reduce_ex__(self, protocol: SupportsIndex) -> NoReturn:
        """Raise TypeError."""
        raise TypeError(
            f"{type(self).__name__} cannot be copied or pickled: Chipmunk keeps contacts in memory of its own. Make "
            "another one of the same mission, reset it with the same start and seed, and repeat the calls: same bits"
        )
