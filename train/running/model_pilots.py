"""Pilots by models of other libraries: Stable-Baselines3, TorchScript and ONNX.

A model gets the default observation of a robot (R, F), float32, and gives a number for each option (R, O), of which the
largest counts, in the order of the expert knowledge. A model of Stable-Baselines3 is the `.zip` that `save` wrote; what
`VecNormalize.save` wrote lies beside it with the ending `.pkl`.
"""

from __future__ import annotations

import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.learning.observation.observer import Observations
from selector.documents.errors import DocumentError
from selector.strategies.problem import Problem
from selforg.arrays import Floats, Ints

Model = Callable[[Observations], NDArray[Any]]
"""Function from observations (R, F) to options (R,), or to a number for each option (R, O)."""


class ModelPilot:
    """A model of another library that always takes the option it prefers.

    Raises:
        DocumentError: there is no such file, its library is not installed, or it does not fit the problem.

    """

    def __init__(self, path: Path, problem: Problem) -> None:
        if not path.is_file():
            raise DocumentError(f"{path}: no such file")
        self._path, self._options = path, len(problem.options)
        try:
            self._model = LOADERS[path.suffix](path)
            self.choose(np.zeros((1, len(problem.features)), dtype=np.float32))
        except ImportError as error:
            raise DocumentError(f"{path}: {error}; the extras train and onnx have what models need") from error
        except (RuntimeError, ValueError, KeyError) as error:  # libraries raise different errors
            text = " ".join(str(error).split())[:200]
            expected = f"a model of {len(problem.features)} numbers and {self._options} options"
            raise DocumentError(f"{path}: expected {expected}, got {text}") from error

    def begin(self, rows: Ints, seed: int) -> None:
        """Do nothing: the decisions do not depend on the mission."""

    def choose(self, observations: Observations) -> Ints:
        """Return the options (R,) that the model prefers."""
        given = np.asarray(self._model(observations))
        if given.ndim == 2 and given.shape[1] != self._options:
            raise ValueError(f"{given.shape[1]} options")
        options: Ints = (given.argmax(axis=1) if given.ndim == 2 else given).astype(np.int64)
        if options.shape != observations.shape[:1] or options.max(initial=0) >= self._options:
            raise ValueError(f"options {options.tolist()}")
        self._chosen = options
        return options

    def opinions(self) -> Floats:
        """Return 1 for the option that the model preferred, 0 for the others (R, O)."""
        return np.eye(self._options)[self._chosen]


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
