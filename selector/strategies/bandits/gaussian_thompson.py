"""Thompson sampling: each option is taken with the probability that it is the best."""

import numpy as np

from selector.documents.fields import Positive
from selector.strategies.bandits.value_table import PriorParameters, ValueTable
from selector.strategies.choosing import best
from selector.strategies.problem import Decisions
from selector.strategies.registry import STRATEGIES
from selector.strategies.streams import student_t
from selforg.arrays import Floats, Ints


class GaussianThompsonParameters(PriorParameters):
    """Prior distribution of the rewards: normal-inverse-gamma around the scores of the expert."""

    prior: Positive = 1.0
    """Pseudo-count: the expert's score of an option counts as this many rewards of that size [rewards]."""
    deviation: Positive = 1.0
    """Expected standard deviation of a reward [reward]."""
    shape: Positive = 1.0
    """Half the number of rewards that `deviation` counts as [rewards]."""


@STRATEGIES.register
class GaussianThompson(ValueTable):
    """Thompson sampling for normal rewards of unknown mean and variance (Thompson 1933, doi:10.1093/biomet/25.3-4.285).

    The conjugate prior is normal-inverse-gamma. The mean of an option, given its rewards, has a Student
    distribution (Gelman et al., Bayesian Data Analysis, section 3.3), from which it is drawn directly.
    """

    Parameters = GaussianThompsonParameters
    parameters: GaussianThompsonParameters

    @property
    def draws_per_decision(self) -> int:
        """Random numbers that one row takes for one decision: two for each option."""
        return 2 * self.options

    def posterior(self) -> tuple[Floats, Floats, Floats]:
        """Return location, scale and degrees of freedom (G, O) of the Student distribution of each option's mean."""
        settings, counts = self.parameters, self.counts
        kappa = settings.prior + counts
        alpha = settings.shape + 0.5 * counts
        surprise = settings.prior * counts / kappa * (self.means - self.problem.scores) ** 2
        beta = settings.shape * settings.deviation**2 + 0.5 * (self.spreads + surprise)
        return self.estimates(), np.sqrt(beta / (alpha * kappa)), 2.0 * alpha

    def _select(self, decisions: Decisions) -> Ints:
        location, scale, freedom = (values[decisions.groups] for values in self.posterior())
        deviates = np.empty_like(location)
        student_t(decisions.draws, freedom, deviates)
        return best(location + scale * deviates, decisions.allowed)
