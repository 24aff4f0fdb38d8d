"""Thompson sampling: the option whose reward is the highest of draws from what is believed of the rewards."""

import numpy as np

from selector.documents.fields import Positive
from selector.strategies.bandits.linear import LinearModel
from selector.strategies.bandits.value_table import ValueTable
from selector.strategies.choosing import best
from selector.strategies.problem import Decisions
from selector.strategies.registry import STRATEGIES
from selector.strategies.streams import normals, student_t
from selforg.arrays import Floats, Ints


@STRATEGIES.register
class GaussianThompson(ValueTable):
    """Thompson sampling for normal rewards of unknown mean and variance (Thompson 1933, doi:10.1093/biomet/25.3-4.285).

    The conjugate prior, around the scores of the expert, is normal-inverse-gamma. The mean of an option, given its
    rewards, has a Student distribution (Gelman et al., Bayesian Data Analysis, section 3.3), from which it is drawn.
    """

    prior: Positive = 1.0
    """The expert's score of an option counts as this many rewards of that size [rewards]."""
    deviation: Positive = 1.0
    """Expected standard deviation of a reward [reward]."""
    shape: Positive = 1.0
    """Half the number of rewards that `deviation` counts as [rewards]."""
    draws_per_option = 2

    def posterior(self) -> tuple[Floats, Floats, Floats]:
        """Return location, scale and degrees of freedom (G, O) of the Student distribution of each option's mean."""
        kappa = self.prior + self.counts
        alpha = self.shape + 0.5 * self.counts
        surprise = self.prior * self.counts / kappa * (self.means - self.problem.scores) ** 2
        beta = self.shape * self.deviation**2 + 0.5 * (self.spreads + surprise)
        return self.estimates(), np.sqrt(beta / (alpha * kappa)), 2.0 * alpha

    def _select(self, decisions: Decisions) -> Ints:
        location, scale, freedom = (values[decisions.groups] for values in self.posterior())
        deviates = np.empty_like(location)
        student_t(decisions.draws, freedom, deviates)
        return best(location + scale * deviates, decisions.allowed)


@STRATEGIES.register
class LinearThompson(LinearModel):
    """Thompson sampling with linear rewards (Agrawal & Goyal 2013, doi:10.48550/arXiv.1209.3352, algorithm 1).

    The paper draws the weights of each option. Only their product with the context counts, which is normal with the
    expected reward as mean and exploration * standard error as deviation; so this product is drawn. `exploration` is
    the paper's v, at least the standard deviation of the noise of the rewards.
    """

    draws_per_option = 2

    def _select(self, decisions: Decisions) -> Ints:
        expected, error = self.predictions(decisions)
        deviates = np.empty_like(expected)
        normals(decisions.draws, deviates)
        return best(expected + self.exploration * error * deviates, decisions.allowed)
