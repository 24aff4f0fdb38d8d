"""Columns of the tables that compiled code shares; one row is one gradient, one pose or one pair.

The first word of a constant is the table: NEAR_DUE is a column of the near table. Tables take the place of one array
per field because a walk reads most fields of a gradient at once (two cache lines).
"""

# The columns that the near table, messages and poses have in common. A position has always three components; the third
# is zero in the plane.
X, Y, Z = 0, 1, 2  # [m]
DIFFUSION = 3  # radius over which a gradient weakens [m], may be infinite
GOAL_RADIUS = 4  # radius of the goal area [m]

# A stored gradient has a row in each of four tables. A walk reads the links of all gradients in the cells that it
# visits, the near columns of those that lie there, and the far columns and marks of few. One wide row was slower:
# docs/decisions/0018-four-tables.md.

# Links, int32 (M, LINK_COLUMNS)
(
    LINK_NEXT,  # next slot in the bucket (or in the list of free slots), -1 at the end
    LINK_CELL,  # cell of a static gradient, source of a moving one
    LINK_LAYER,  # row of the table of layers, -1 for a free slot
    LINK_SIGN,  # attraction: +1, 0, -1
    LINK_COLUMNS,
) = range(5)

# Near table, float64 (M, NEAR_COLUMNS): the common columns and
NEAR_DUE = 5  # time of the next evaporation [s], infinite if there is none
NEAR_COLUMNS = 6

# Far table, float64 (M, FAR_COLUMNS)
FAR_START = 0  # diffusion at FAR_CLOCK [m]
FAR_FACTOR = 1  # what is left of the diffusion after each period [-]
FAR_PERIOD = 2  # evaporation period [s]
FAR_CLOCK = 3  # time from which evaporation counts [s]
FAR_STAMP = 4  # when the gradient was spread [s]
FAR_HEADING = 5  # and the two columns after it: unit heading [-], all zero if there is none
FAR_VALUE = 8  # a number that the gradient carries; MARK_KEY says which one
FAR_COLUMNS = 9

# Marks, int32 (M, MARK_COLUMNS)
(
    MARK_RANK,  # age of a moving gradient among those of its source, 0 is the newest
    MARK_SOURCE,  # who spread the gradient
    MARK_AFTER,  # this and the next: neighbours in the list of the layer, in the order of storing
    MARK_BEFORE,
    MARK_SERIAL,  # running number of the message, modulo SERIALS; the border finds payloads by it
    MARK_KEY,  # code of the payload entry that FAR_VALUE is, -1 for none
    MARK_COLUMNS,
) = range(7)
SERIALS = 1 << 31

# Incoming messages, float64 (M, MESSAGE_COLUMNS): the common columns, then the far table's
MESSAGE_FAR = 5  # MESSAGE_FAR + FAR_STAMP: when the message was spread
MESSAGE_COLUMNS = MESSAGE_FAR + FAR_COLUMNS

# What goes with each incoming message, int64 (M, TAG_COLUMNS)
(
    TAG_SPACE,  # information space (a team, or a row) that receives the message
    TAG_CHANNEL,  # code of the channel
    TAG_SOURCE,  # who spread the message
    TAG_SIGN,  # attraction: +1, 0, -1
    TAG_MOVING,  # 1 for a moving gradient
    TAG_KEY,  # code of the payload entry that the message carries, -1 for none
    TAG_COLUMNS,
) = range(7)

# Layers, int32 (C * S * LEVELS, LAYER_COLUMNS): all gradients of one channel, space and level
(
    LAYER_HEAD,  # first slot of the list, -1 for none
    LAYER_TAIL,  # last slot of the list, -1 for none
    LAYER_COUNT,  # gradients in the list
    LAYER_SWEEP,  # slot that is checked next for having evaporated, -1: the first
    LAYER_GONE,  # gradients that evaporated and were taken from the list, at most MOST_CELLS
    LAYER_COLUMNS,
) = range(6)

# Levels: static gradients by reach, doubling; one for those without bound; one for moving gradients
BOUNDED = 12
UNBOUNDED = 12
MOVING = 13
LEVELS = 14

# Counters of the store, int64 (COUNTERS,)
(
    COUNTER_FREE,  # first free slot, -1 for none
    COUNTER_USED,  # gradients stored
    COUNTER_HIGH,  # slots that were ever used
    COUNTER_SERIAL,  # serial number of the last message
    COUNTER_TIDY_AT,  # serial number from which on neighbours are moved together again
    COUNTER_LISTENED,  # 1 while somebody is told who leaves what
    COUNTERS,
) = range(7)

# Own poses, float64 (N, K, POSE_COLUMNS), the newest first: the common columns and
POSE_STAMP = 5  # when the pose was spread [s]
POSE_HEADING = 6  # and the two columns after it: unit heading [-], all zero if there is none
POSE_SIGN = 9  # attraction: +1, 0, -1
POSE_COLUMNS = 10

# Rows, int64 (N, ROW_COLUMNS or more)
ROW_POSES = 0  # number of poses known
ROW_SILENT = 1  # 1 if the row spreads none
ROW_DEAF = 2  # 1 if the row stores nothing that others spread
ROW_COLUMNS = 3
ROW_HEARD = 3  # from here on, if rows hear each other: age of the last pose received from each of the team, -1: none;
# after these, in the same order, the age of the one received before it

# Pairs, float64 (P, PAIR_COLUMNS): what a row sees of one gradient
(
    PAIR_DX,  # offset from the row to the gradient, with the next two [m]
    PAIR_DY,
    PAIR_DZ,
    PAIR_DISTANCE,  # [m]
    PAIR_DIFFUSION,  # radii of the gradient, with the next one [m]
    PAIR_GOAL_RADIUS,
    PAIR_SIGN,  # attraction of the gradient: +1, 0, -1
    PAIR_SLOT,  # slot of the store, or -1 - (row + N * age) for the shared pose of a row, age 0 the newest
    PAIR_COLUMNS,
) = range(9)

# What a row looks at, a set of bits
SEE_STATIC, SEE_MOVING, SEE_HISTORY, SKIP_OWN = 1, 2, 4, 8
