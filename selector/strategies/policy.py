"""Networks of trained policies, run from exported files by NumPy and compiled code."""

import numpy as np

from selector.strategies.policy_file import Floats32, TrainedPolicy
from selforg.arrays import Floats
from selforg.compiler.decorators import kernel
from selforg.elementary import hyperbolic_tangent

ACTIVATIONS = {"none": 0, "tanh": 1, "relu": 2}


class Network:
    """A network of dense layers in float32, whose outputs for a row do not depend on the rows beside it."""

    def __init__(self, policy: TrainedPolicy) -> None:
        spec = policy.spec
        self._mean, self._clip = np.array(spec.mean), spec.clip
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
            heads["vector"] = np.clip(heads["vector"], -1.0, 1.0)
        return heads


def passed(values: Floats32, layer: tuple[Floats32, Floats32], activation: int) -> Floats32:
    """Return the output of a layer with weights (I, H) and bias (H,) for `values` (K, I)."""
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
