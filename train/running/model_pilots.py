"""Pilots by models of other libraries: Stable-Baselines3, TorchScript and ONNX.

A model gets the default observation of a robot (R, F), float32, and gives a number for each option (R, O), of which the
largest counts, in the order of the expert knowledge; or a movement vector (R, 2). A model of Stable-Baselines3 is the
`.zip` that `save` wrote; what `VecNormalize.save` wrote lies beside it with the ending `.pkl`.
"""

from __future__ import annotations

import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.learning.actions import checked_vectors
from clean_swarm_env.learning.observation.observer import Observations
from selector.documents.errors import DocumentError
from selector.strategies.problem import Problem
from selforg.arrays import Floats, Ints

Model = Callable[[Observations], NDArray[Any]]
"""Function from observations (R, F) to options (R,), to a number for each option (R, O), or to vectors (R, 2)."""


class ModelPilot:
    """A model of another library that always takes the option it prefers.

    Raises:
        DocumentError: there is no such file, its library is not installed, or it does not fit the problem.

    """

    def __init__(self, path: Path, problem: Problem) -> None:
        self._options = len(problem.options)
        self._model = loaded(path, len(problem.features), f"{self._options} options", self._preferred)

    def begin(self, rows: Ints, seed: int) -> None:
        """Do nothing: the decisions do not depend on the mission."""

    def choose(self, observations: Observations) -> Ints:
        """Return the options (R,) that the model prefers."""
        self._chosen = self._preferred(self._model(observations), len(observations))
        return self._chosen

    def opinions(self) -> Floats:
        """Return 1 for the option that the model preferred, 0 for the others (R, O)."""
        return np.eye(self._options)[self._chosen]

    def _preferred(self, given: NDArray[Any], rows: int) -> Ints:
        """Return the options (R,) in an answer; ValueError says what does not fit."""
        if given.ndim == 2 and given.shape[1] != self._options:
            raise ValueError(f"{given.shape[1]} options")
        options: Ints = (given.argmax(axis=1) if given.ndim == 2 else given).astype(np.int64)
        if options.shape != (rows,) or options.max(initial=0) >= self._options:
            raise ValueError(f"options {options.tolist()}")
        return options


class VectorPilot:
    """A model whose answers are movement vectors (R, 2), see `Controls`."""

    def __init__(self, model: Model) -> None:
        self.choose = model

    @classmethod
    def of_file(cls, path: Path, features: int) -> VectorPilot:
        """Return the pilot of a file by another library, for `features` components of an observation without options.

        DocumentError as `ModelPilot`.
        """
        return cls(loaded(path, features, "a vector", checked_vectors))

    def begin(self, rows: Ints, seed: int) -> None:
        """Do nothing: the vectors do not depend on the mission."""


def loaded(path: Path, features: int, gives: str, check: Callable[[NDArray[Any], int], Any]) -> Model:
    """Return the model of a file after an answer for one row, which `check` takes or refuses with ValueError.

    `gives` says what a model of that many `features` has to give.
    """
    if not path.is_file():
        raise DocumentError(f"{path}: no such file")
    if path.suffix not in LOADERS:
        raise DocumentError(f"{path}: expected a file that ends in {', '.join(LOADERS)}")
    try:
        model = LOADERS[path.suffix](path)
        check(np.asarray(model(np.zeros((1, features), dtype=np.float32))), 1)
    except ImportError as error:
        raise DocumentError(f"{path}: {error}; the extras train and onnx have what models need") from error
    except (RuntimeError, ValueError, KeyError) as error:  # libraries raise different errors
        text = " ".join(str(error).split())[:200]
        raise DocumentError(f"{path}: expected a model of {features} numbers and {gives}, got {text}") from error
    return model


def stable_baselines3(path: Path) -> Model:
    """Return the policy of a model of Stable-Baselines3 or sb3-contrib, with its normalisation."""
    from stable_baselines3.common.save_util import load_from_zip_file

    data, parameters, _ = load_from_zip_file(path, device="cpu")
    spaces = data["observation_space"], data["action_space"]
    policy = data["policy_class"](*spaces, lambda _: 0.0, **data["policy_kwargs"])
    policy.load_state_dict(parameters["policy"])
    beside = path.with_suffix(".pkl")
    normal = pickle.loads(beside.read_bytes()) if beside.is_file() else None

    def model(observations: Observations) -> NDArray[Any]:
        seen = observations if normal is None else normal.normalize_obs(observations)
        options: NDArray[Any] = policy.predict(seen, deterministic=True)[0]
        return options

    return model


def torch_script(path: Path) -> Model:
    """Return a module that `torch.jit.save` wrote."""
    import torch

    module = torch.jit.load(str(path), map_location="cpu").eval()

    def model(observations: Observations) -> NDArray[Any]:
        with torch.no_grad():
            outputs: NDArray[Any] = module(torch.from_numpy(observations)).numpy()
        return outputs

    return model


def onnx(path: Path) -> Model:
    """Return a model of ONNX, run by onnxruntime."""
    import onnxruntime

    session = onnxruntime.InferenceSession(str(path), providers=["CPUExecutionProvider"])
    name = session.get_inputs()[0].name

    def model(observations: Observations) -> NDArray[Any]:
        outputs: NDArray[Any] = session.run(None, {name: observations})[0]
        return outputs

    return model


LOADERS: dict[str, Callable[[Path], Model]] = {".zip": stable_baselines3, ".pt": torch_script, ".onnx": onnx}
"""Ending of a file -> function that loads it."""
