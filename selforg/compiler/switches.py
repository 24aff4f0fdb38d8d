"""Switches of the compiler, read from the environment once, and the options that follow from them."""

import os

import numba

COMPILED = not numba.config.DISABLE_JIT  # type: ignore[attr-defined]
"""Whether anything is compiled at all; NUMBA_DISABLE_JIT=1 turns this off."""

PLAIN = os.environ.get("CLEAN_SWARM_PLAIN_NUMBA") == "1"
"""Whether only documented features of Numba are used: slower, the same bits.

Records then reach compiled code as Numba's own named tuples, references to arrays are counted, and Chipmunk is called
from Python. Set it when a new version of Numba breaks the undocumented features.
"""

BY_ADDRESS = COMPILED and not PLAIN
"""Whether records and steps reach compiled code by their addresses."""

CHECKED = os.environ.get("CLEAN_SWARM_CHECK_RECORDS") == "1"
"""Whether compiled code raises TypeError when it is given another record than it expects."""

NUMPY_ERRORS = {"error_model": "numpy"}
LEAN = NUMPY_ERRORS if PLAIN else {**NUMPY_ERRORS, "no_cfunc_wrapper": True, "_nrt": False}
"""Options of functions that make no arrays: references to arrays are not counted, the caller holds them anyway.

Counting took 35 ns a pair of robots in place of 3: docs/decisions/0020-no-reference-counts.md."""
