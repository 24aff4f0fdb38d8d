"""Parameters of classes are read from their constructors."""

import pytest

from selforg.parameters import parameters_of


def test_options_that_nobody_can_name_are_one_line():
    class Anything:
        def __init__(self, **kw):
            self.kw = kw

    with pytest.raises(ValueError, match=r"Anything.__init__: expected parameters by name, or \*\*kw: Unpack"):
        parameters_of(Anything)
