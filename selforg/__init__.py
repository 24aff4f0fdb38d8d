"""Self-organisation for robots: gradients, mechanisms and the behaviour network (knows NumPy and Numba only)."""

import os

# LLVM's third level compiles a tenth longer than its first; bits are equal, and no tick was faster. Users may choose.
os.environ.setdefault("NUMBA_OPT", "1")
