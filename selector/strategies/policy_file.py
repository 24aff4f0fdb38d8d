"""Files of trained policies, which are read and run without torch: weights as safetensors, the rest as JSON.

A policy is a directory with `policy.json` (`PolicySpec`) and `policy.safetensors`: `hidden.0.weight` (H, F) and
`hidden.0.bias` (H,), ..., `options.weight` (O, H) and `options.bias` (O,), float32 as torch lays them out. Options are
those of all goals, one goal after the other. One that drives has `vector.weight` (2, H) and `vector.bias` (2,) in place
of those of options, or beside them.
"""

import base64
import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
import numpy.typing as npt
import safetensors
import safetensors.numpy
from pydantic import Field, model_validator

from selector.documents.arrays import check_same_names
from selector.documents.errors import DocumentError, shown, validated
from selector.documents.fields import JOINT, Closed, JointName, Name, Number, Positive
from selector.documents.find import find_file
from selector.documents.plain import must_know, plain
from selector.documents.reading import read_bytes, read_json
from selector.documents.writing import write_whole
from selector.knowledge import Definition
from selector.strategies.probing import Probing
from selforg.arrays import Floats
from selforg.compiler.decorators import kernel
from selforg.elementary import hyperbolic_tangent

Floats32 = npt.NDArray[np.float32]
SPECIFICATION, WEIGHTS_FILE = "policy.json", "policy.safetensors"
ACTIVATIONS = {"none": 0, "tanh": 1, "relu": 2}


class PolicySpec(Closed):
    """The problem that a policy was trained for, and the shape of its network."""

    version: Literal[1] = 1
    """Version of this form."""
    goals: dict[JointName, Annotated[tuple[JointName, ...], Field(min_length=1)]] = Field(default_factory=dict)
    """Goal of self-organisation -> names of its options, in the order of the network's outputs; none if it only drives.
    Several goals that are decided as one have one name here, joined by `+`."""
    definitions: Mapping[Name, Mapping[Name, Definition]] = Field(default_factory=dict)
    """Goal -> option -> what it was trained with; missions whose option of that name is another are refused."""
    holds: dict[JointName, Annotated[int, Field(strict=True, ge=1, le=1_000_000)]] = Field(default_factory=dict)
    """Goal -> decision periods for which a robot keeps an option; 1 for goals that are not named."""
    terms: tuple[Name, ...] = ()
    """Terms of the observation, with their usual settings; none: the usual terms and those of the mission."""
    observation: dict[str, Any] = Field(default_factory=dict)
    """The whole configuration of the observation, if it is not the usual one of `terms`."""
    vector: bool = False
    """Whether the network gives a movement vector: ahead and left, in shares of the largest speed."""
    observations: tuple[Name, ...]
    """(F,) names of the components of an observation, in the order of the network's inputs."""
    hidden: Annotated[tuple[Annotated[int, Field(strict=True, ge=1, le=100_000)], ...], Field(max_length=100)]
    """Widths of the hidden layers."""
    activation: Literal["tanh", "relu"] = "tanh"
    """Function after each hidden layer."""
    mean: tuple[Number, ...]
    """(F,) subtracted from an observation."""
    variance: tuple[Annotated[Number, Field(ge=0.0)], ...]
    """(F,) variance; the difference is divided by sqrt(variance + epsilon)."""
    epsilon: Positive = 1e-8
    """Added to the variance."""
    clip: Positive = 10.0
    """Largest absolute value of an input of the network."""
    probing: Probing = Probing()
    """Which robots try another option than the likeliest; none unless given."""
    weights_sha256: str = ""
    """Digest of the file of the weights; filled in when the policy is written."""
    training: dict[str, Any] = Field(default_factory=dict)
    """How it was trained: command, configuration, seed, versions, figures."""

    @model_validator(mode="after")
    def _widths(self) -> Self:
        if not self.goals and not self.vector:
            raise ValueError("goals: expected at least one, or a vector, got none")
        for goal in self.holds:
            must_know("goal", goal, self.goals, "holds")
        for joint, options in self.goals.items():
            if len(set(options)) < len(options):
                raise ValueError(f"goals: {joint}: expected each option once, got {list(options)}")
            for k, goal in enumerate(joint.split(JOINT)):
                names = {option.split(JOINT)[k] for option in options}
                if lacking := sorted(names - self.definitions.get(goal, {}).keys()):
                    raise ValueError(f"definitions: {goal}: expected those of all its options, got none of {lacking}")
        for name in ("mean", "variance"):
            count = len(getattr(self, name))
            if count != len(self.observations):
                raise ValueError(f"{name}: expected {len(self.observations)} numbers, one an observation, got {count}")
        return self

    def layers(self) -> list[tuple[str, int, int]]:
        """Return name, inputs and outputs of each layer."""
        widths = (len(self.observations), *self.hidden)
        hidden = [(f"hidden.{k}", widths[k], widths[k + 1]) for k in range(len(self.hidden))]
        return hidden + [(name, widths[-1], count) for name, count in self.heads.items()]

    @property
    def heads(self) -> dict[str, int]:
        """Names of the last layers, and their outputs."""
        counts = {"options": sum(map(len, self.goals.values())), "vector": 2 * self.vector}
        return {name: count for name, count in counts.items() if count}


@dataclass(frozen=True)
class TrainedPolicy:
    """A policy, as its files hold it.

    Attributes:
        spec: content of `policy.json`.
        weights: arrays by the names in the docstring of this module.

    """

    spec: PolicySpec
    weights: dict[str, Floats32]


def described(policy: TrainedPolicy) -> dict[str, Any]:
    """Return what is needed to compute the options of a policy again, as plain data; nothing if it chooses none.

    `weights`: of each layer the matrix (inputs, outputs) and the biases, float32, in base64.
    """
    spec, layers = policy.spec, [name for name, _, _ in policy.spec.layers() if name != "vector"]
    if "options" not in layers:
        return {}
    parts = [part for name in layers for part in (policy.weights[f"{name}.weight"].T, policy.weights[f"{name}.bias"])]
    return {
        "goals": spec.goals,
        "holds": spec.holds,
        "observations": spec.observations,
        "mean": spec.mean,
        "deviation": np.sqrt(np.array(spec.variance) + spec.epsilon).tolist(),
        "clip": spec.clip,
        "activation": spec.activation,
        "widths": [len(spec.observations), *spec.hidden, spec.heads["options"]],
        "weights": base64.b64encode(b"".join(np.ascontiguousarray(part).tobytes() for part in parts)).decode(),
    }


def save_policy(directory: Path, policy: TrainedPolicy) -> None:
    """Write a policy: the weights first, then the specification that names their digest.

    Raises:
        DocumentError: the weights do not fit the specification, or the files cannot be written.

    """
    _check(policy, shown(directory))
    content = safetensors.numpy.save({name: np.ascontiguousarray(array) for name, array in policy.weights.items()})
    spec = policy.spec.model_copy(update={"weights_sha256": hashlib.sha256(content).hexdigest()})
    write_whole(directory / WEIGHTS_FILE, content)
    text = json.dumps(spec.model_dump(mode="json"), indent=2, allow_nan=False) + "\n"
    write_whole(directory / SPECIFICATION, text.encode())


def find_policy(name: str, directories: Sequence[Path] = ()) -> Path:
    """Return the directory of a policy: a path, or the name of one in `directories` or of one that ships.

    Raises:
        DocumentError: there is no such policy.

    """
    return find_file("policies", name, directories).parent


def load_policy(directory: Path) -> TrainedPolicy:
    """Return the policy in a directory.

    Raises:
        DocumentError: a file is missing or damaged, or the files do not belong together.

    """
    where = shown(directory / SPECIFICATION)
    spec = validated(PolicySpec, read_json(directory / SPECIFICATION), where)
    content = read_bytes(directory / WEIGHTS_FILE)
    digest = hashlib.sha256(content).hexdigest()
    if digest != spec.weights_sha256:
        raise DocumentError(
            f"{where}: weights_sha256: expected that of {WEIGHTS_FILE}, {digest}, got {spec.weights_sha256}"
        )
    try:
        policy = TrainedPolicy(spec, safetensors.numpy.load(content))
    except (safetensors.SafetensorError, ValueError, KeyError) as error:
        raise DocumentError(f"{shown(directory / WEIGHTS_FILE)}: cannot be read ({plain(str(error))})") from error
    _check(policy, shown(directory))
    return policy


def _check(policy: TrainedPolicy, where: str) -> None:
    """Raise DocumentError unless the weights have the names, shapes and type of the specification, and are finite."""
    expected: dict[str, tuple[int, ...]] = {}
    for name, inputs, outputs in policy.spec.layers():
        expected |= {f"{name}.weight": (outputs, inputs), f"{name}.bias": (outputs,)}
    check_same_names(where, "weights", tuple(expected), tuple(sorted(policy.weights)))
    for name, shape in expected.items():
        array = policy.weights[name]
        if array.shape != shape or array.dtype != np.float32:
            raise DocumentError(f"{where}: {name}: expected {shape} of float32, got {array.shape} of {array.dtype}")
        if not np.isfinite(array).all():
            raise DocumentError(f"{where}: {name}: expected finite numbers, got {array[~np.isfinite(array)][0]}")


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

    def heads(self, context: Floats) -> dict[str, Floats]:
        """Return the outputs (K, ...) of each head for each observation (K, F).

        Those of `options` are logarithms of probabilities, up to a constant; those of `vector` are a movement.
        """
        normal = np.clip((context - self._mean) / self._deviation, -self._clip, self._clip)
        values: Floats32 = normal.astype(np.float32)
        for layer in self._hidden:
            values = passed(values, layer, self._activation)
        heads = {name: passed(values, head, ACTIVATIONS["none"]).astype(float) for name, head in self._heads.items()}
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
