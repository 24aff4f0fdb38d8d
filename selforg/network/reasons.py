"""Why a behaviour runs, was stopped or does not start: codes that arbitration writes in every step, and their words."""

from __future__ import annotations

# in the layer REASON of the marks of an explained network; the layer BY says which other behaviour it was, -1: none
(
    UNKNOWN,
    STARTED_READY,
    STARTED_BY_HAND,
    KEPT,
    KEPT_BY_HAND,
    KEPT_STUBBORN,
    OUT_OF_TIME,
    LOST_READINESS,
    FELL_BELOW,
    CROWDED_OUT,
    DISPLACED,
    DISABLED,
    NOT_READY,
    BELOW_THRESHOLD,
    BLOCKED,
    NO_PLACE,
) = range(16)

GOES_ON = KEPT, KEPT_BY_HAND, KEPT_STUBBORN
"""Reasons of behaviours that go on."""

WORDS = {
    UNKNOWN: "not part of the network, or no step yet",
    STARTED_READY: "started: ready and active enough",
    STARTED_BY_HAND: "started by hand",
    KEPT: "keeps running: ready and active enough",
    KEPT_BY_HAND: "keeps running: started by hand",
    KEPT_STUBBORN: "keeps running: not interruptable",
    OUT_OF_TIME: "stopped: its time is up",
    LOST_READINESS: "stopped: no longer ready",
    FELL_BELOW: "stopped: activation fell below the threshold",
    CROWDED_OUT: "stopped: enough others run",
    DISPLACED: "stopped: had to make room for {by}",
    DISABLED: "does not start: switched off",
    NOT_READY: "does not start: not ready",
    BELOW_THRESHOLD: "does not start: activation below the threshold",
    BLOCKED: "does not start: {by} influences the same sensor and does not yield",
    NO_PLACE: "does not start: enough others run",
}
