"""Self-organisation for robots: gradients, mechanisms and the behaviour network (knows NumPy and Numba only)."""

import os

# LLVM's third level compiles a tenth longer than its first, and no tick was faster by it. Whoever asks for it gets it.
# docs/decisions/0021-llvm-level.md
os.environ.setdefault("NUMBA_OPT", "1")
