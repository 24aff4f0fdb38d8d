"""Take what the expert rates highest, as in the paper."""

import numpy as np

from selector.strategy import DecisionStrategy, Floats, Ints, register


@register
class MaxScore(DecisionStrategy):
    """The option of the highest score, the first of several; rewards change nothing."""

    def _select(self, context: Floats, draws: Floats) -> Ints:
        best = np.argmax(self.estimates, axis=1)  # argmax returns the first of equals
        return np.broadcast_to(best, (self.rows,))

    def _update(self, option: Ints, reward: Floats, context: Floats) -> None:
        pass  # the expert's scores are not for rewards to move: strategies that learn do that
