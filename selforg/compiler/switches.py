"""Switches of the compiler, read from the environment once."""

import os

import numba

COMPILED = not numba.config.DISABLE_JIT  # type: ignore[attr-defined]
"""Whether anything is compiled at all; NUMBA_DISABLE_JIT=1 turns this off."""

PLAIN = os.environ.get("CLEAN_SWARM_PLAIN_NUMBA") == "1"
"""Whether only documented features of Numba are used: slower, the same bits.

Records then reach compiled code as Numba's own named tuples, and references to arrays are counted. Set it when a new
version of Numba breaks the undocumented features.
"""

CHECKED = os.environ.get("CLEAN_SWARM_CHECK_RECORDS") == "1"
"""Whether compiled code raises TypeError when it is given another record than it expects."""
