"""Trained policies: networks that choose options, run from exported files by NumPy and compiled code."""

import numpy as np

from selector.documents.errors import DocumentError, shown
from selector.documents.fields import Closed, DocumentName, Flag
from selector.strategies.choosing import best, chance_of, drawn, shares
from selector.strategies.policy_file import Floats32, TrainedPolicy, find_policy, load_policy
from selector.strategies.problem import Decisions
from selector.strategies.registry import STRATEGIES
from selector.strategies.strategy import DecisionStrategy
from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import kernel
from selforg.elementary import hyperbolic_tangent

ACTIVATIONS = {"none": 0, "tanh": 1, "relu": 2}


class PolicyParameters(Closed):
    """The policy, and how its outputs become an option."""

    policy: DocumentName
    """Directory of an exported policy, or the name of one in `policies/` of a directory of configurations."""
    sampled: Flag = False
    """Draw an option with the probabilities of the network, as in training, instead of taking the likeliest."""


@STRATEGIES.register
class Policy(DecisionStrategy):
    """A policy trained by PPO (Schulman et al. 2017, doi:10.48550/arXiv.1707.06347), which does not learn any more."""

    Parameters = PolicyParameters
    parameters: PolicyParameters

    def _prepare(self) -> None:
        directory = find_policy(self.parameters.policy, self.directories)
        policy = load_policy(directory)
        if policy.spec.vector:
            raise DocumentError(f"{shown(directory)}: expected a policy that chooses options only, got one that steers")
        self.network = Network(policy.ordered_for(self.problem, shown(directory)))

    @property
    def draws_per_decision(self) -> int:
        """Random numbers that one row takes for one decision."""
        return int(self.parameters.sampled)

    def _opinions(self, decisions: Decisions) -> Floats:
        return shares(self.network.outputs(decisions.context))

    def _select(self, decisions: Decisions) -> Ints:
        preferences = np.where(decisions.allowed, self.network.outputs(decisions.context), -np.inf)
        if not self.parameters.sampled:
            return best(preferences, decisions.allowed)
        chances = shares(preferences)
        option = drawn(chances, decisions.draws[:, 0])
        self.chance[decisions.rows] = chance_of(chances, option)
        return option


class Network:
    """A network of dense layers in float32, whose outputs for a row do not depend on the rows beside it."""

    def __init__(self, policy: TrainedPolicy) -> None:
        spec = policy.spec
        self._mean, self._clip, self._reach = np.array(spec.mean), spec.clip, spec.reach
        self._deviation = np.sqrt(np.array(spec.variance) + spec.epsilon)
        self._activation = ACTIVATIONS[spec.activation]
        layers = {
            name: (np.ascontiguousarray(policy.weights[f"{name}.weight"].T), policy.weights[f"{name}.bias"])
            for name, _, _ in spec.layers()
        }
        self._heads = {name: layers.pop(name) for name in spec.heads}
        self._hidden = list(layers.values())

    def outputs(self, context: Floats) -> Floats:
        """Return the output (K, O) for each observation (K, F): logarithms of probabilities, up to a constant."""
        return self.heads(context)["options"]

    def heads(self, context: Floats) -> dict[str, Floats]:
        """Return the outputs (K, ...) of each head, of `options` and of `vector`, for each observation (K, F)."""
        normal = np.clip((context - self._mean) / self._deviation, -self._clip, self._clip)
        values: Floats32 = normal.astype(np.float32)
        for layer in self._hidden:
            values = passed(values, layer, self._activation)
        none = ACTIVATIONS["none"]
        heads = {name: passed(values, head, none).astype(np.float64) for name, head in self._heads.items()}
        if "vector" in heads:
            heads["vector"] = np.clip(heads["vector"], -self._reach, self._reach)
        return heads


def passed(values: Floats32, layer: tuple[Floats32, Floats32], activation: int) -> Floats32:
    """Return what a layer with weights (I, H) and bias (H,) makes of `values` (K, I)."""
    following = np.empty((len(values), len(layer[1])), dtype=np.float32)
    dense(values, *layer, activation, following)
    return following


@kernel
def dense(inputs: Floats32, weights: Floats32, bias: Floats32, activation: int, outputs: Floats32) -> None:
    """Fill `outputs` (K, H) for `inputs` (K, I), `weights` (I, H) and `bias` (H,), summed in the order of inputs.

    The order of summation in a library's matrix product depends on K; here a row gets the same bits for every K.
    """
    for k in range(inputs.shape[0]):
        for h in range(outputs.shape[1]):
            outputs[k, h] = bias[h]
        for i in range(inputs.shape[1]):
            value = inputs[k, i]
            for h in range(outputs.shape[1]):
                outputs[k, h] += value * weights[i, h]
        for h in range(outputs.shape[1]):
            if activation == 1:
                outputs[k, h] = np.float32(hyperbolic_tangent(outputs[k, h]))
            elif activation == 2:
                outputs[k, h] = max(outputs[k, h], np.float32(0.0))
