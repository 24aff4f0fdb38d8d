"""Columns of the tables that compiled code shares; one row is one gradient, one pose or one pair.

Tables instead of one array per field, because a walk reads most fields of a gradient at once (two cache lines) and
because every array argument of a compiled call costs time. Lengths in [m], times in [s].
"""

# A position has always three components in here; the third is zero in the plane.
X, Y, Z = 0, 1, 2
DIFFUSION, GOAL = 3, 4  # radii [m], at the same place in the tables of gradients and of own poses

# A stored gradient has a row in each of four tables. A walk reads the links of all gradients in the cells that it
# visits, then the near columns of those that lie there, and the far ones and the marks of hardly any.

# Links, int32 (M, LINK_COLUMNS)
NEXT = 0  # next slot in the bucket (or in the list of free slots), -1 at the end
CELL = 1  # cell of a static gradient, source of a moving one
LAYER = 2  # row of the layer table, -1 for a free slot
ATTRACTION = 3  # +1, 0, -1
LINK_COLUMNS = 4

# Near columns, float64 (M, NEAR_COLUMNS): X to GOAL and
DUE = 5  # time of the next evaporation [s], infinite if there is none
NEAR_COLUMNS = 6

# Far columns, float64 (M, FAR_COLUMNS)
START = 0  # diffusion at CLOCK [m]
FACTOR, PERIOD = 1, 2  # evaporation [-], [s]
CLOCK = 3  # time from which evaporation counts [s]
STAMP = 4  # when it was spread [s]
HX, HY, HZ = 5, 6, 7  # unit heading, all zero if it has none
VALUE = 8  # a number that it carries; which one, KEY says
FAR_COLUMNS = 9

# Marks, int32 (M, MARK_COLUMNS)
RANK = 0  # age of a moving gradient among those of its source, 0 is the newest
SOURCE = 1  # who spread it
AFTER, BEFORE = 2, 3  # neighbours in the list of the layer, in the order of storing
SERIAL = 4  # running number of the message, modulo SERIALS; the border finds payloads by it
SERIALS = 1 << 31
KEY = 5  # code of the payload entry that VALUE is, -1 for none
MARK_COLUMNS = 6

# Incoming messages, float64 (M, MESSAGE_COLUMNS): columns X to GOAL, then from FAR on the far columns
FAR = 5
MESSAGE_COLUMNS = FAR + FAR_COLUMNS

# Table of layers, int32 (layers, 4): all gradients of one channel, space and level
HEAD, TAIL, COUNT, SWEEP = 0, 1, 2, 3
LAYER_COLUMNS = 4

# Levels: static gradients by reach, doubling; one for those without bound; one for moving gradients
BOUNDED = 12
UNBOUNDED = 12
MOVING = 13
LEVELS = 14

# Table of cells, float64 (LEVELS, 7): largest reach [m], then number and width [m] of the cells along each axis
BOUND = 0
CELLS = 1  # CELLS + 2 * axis: number, CELLS + 2 * axis + 1: width
GRID_COLUMNS = 7

# Counters of the store, int64
FREE, USED, HIGH, LAST_SERIAL, SPACES, CHANNELS, PER_ROW = 0, 1, 2, 3, 4, 5, 6  # PER_ROW: 1 if rows do not share
TIDY_AT = 7  # serial number from which on neighbours are moved together again
COUNTERS = 8

# Settings of the store, float64
AGGREGATION_DISTANCE, MIN_DIFFUSION, WHOLE_SECONDS, HISTORY = 0, 1, 2, 3
EXTENT = 4  # EXTENT + axis: extent of the space [m], 0 for an open axis
SETTINGS = 7

# Table of own poses, float64 (N, K, POSE_COLUMNS), newest first
POSE_STAMP = 5
PHX, PHY, PHZ = 6, 7, 8
POSE_SIGN = 9
POSE_COLUMNS = 10

# Table of rows, int64 (N, ROW_COLUMNS)
TEAM, POSES, SILENT = 0, 1, 2  # team, number of poses known, 1 if the row spreads none
ROW_COLUMNS = 3
HEARD = 3  # from here on, if rows hear each other: age of the last pose received from each of the team, -1 for none

# Table of pairs (what one row sees), float64 (P, PAIR_COLUMNS): offset to the gradient, its distance, its fields
DX, DY, DZ, DISTANCE, PAIR_DIFFUSION, PAIR_GOAL, SIGN, SLOT = 0, 1, 2, 3, 4, 5, 6, 7
PAIR_COLUMNS = 8  # SLOT: slot of the store, or -1 - (row + N * age) for the shared pose of a row, age 0 the newest

# What goes with each incoming message, int64 (M, TAG_COLUMNS)
TAG_SPACE, TAG_CHANNEL, TAG_SOURCE, TAG_SIGN, TAG_MOVING, TAG_KEY = 0, 1, 2, 3, 4, 5
TAG_COLUMNS = 6

# Aggregation rules
DROP, MAX, MIN, AVERAGE, NEW, NEW_SOURCE, NEW_CHANNEL = 0, 1, 2, 3, 4, 5, 6

# What a row looks at, a set of bits
SEE_STATIC, SEE_MOVING, SEE_HISTORY, SKIP_OWN = 1, 2, 4, 8
