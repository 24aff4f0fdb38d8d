"""Deciders by models of other libraries: Stable-Baselines3, TorchScript and ONNX.

A model gets the observation of a robot (R, F), float32, and gives a number for each option (R, O), of which the largest
counts, in the order of the expert knowledge; or a movement vector (R, 2); or both in a row (R, O + 2). A model of
Stable-Baselines3 is the `.zip` that `save` wrote; what `VecNormalize.save` wrote lies beside it with the ending `.pkl`.
The `.zip` remembers the names of components and options that the spaces of our environments have. A `.json` beside
other files may say the same (`write_names`). Without names a model has the default observation of the mission, and the
options of one goal.
"""

from __future__ import annotations

import json
import pickle
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from zipfile import BadZipFile, ZipFile
from zlib import error as zlib_error

import numpy as np
from gymnasium import Space
from numpy.typing import NDArray

from clean_swarm_env.borders.spaces import NAMES, preferred
from clean_swarm_env.deciders.decider import Decided, Decider, columns_of, mode_of
from clean_swarm_env.learning.actions import Mode, checked_vectors
from clean_swarm_env.learning.observation.observer import Observations
from selector.documents.arrays import check_known
from selector.documents.errors import DocumentError, within
from selector.documents.fields import JOINT
from selector.documents.plain import must_fit
from selector.documents.trust import check_trust
from selector.documents.writing import write_whole
from selector.strategies.problem import Problem
from selforg.arrays import Ints

SPACE_TYPE = ":type:"
"""Key of the kind of a space."""
Model = Callable[[Observations], NDArray[Any]]
"""Function from observations (R, F) to options (R,), to a number for each option (R, O), or to vectors (R, 2)."""


@dataclass(frozen=True)
class TrainedOn:
    """What a file knows of the environment in which its model was trained."""

    observations: tuple[str, ...] = ()
    """Names of the components of an observation; none if the file does not know."""
    options: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Goal -> names of its options; none if the file does not know, or without options."""
    mode: Mode = "option"
    """What an action of the model is."""

    @property
    def goal(self) -> str:
        """Names of the goals whose options it chooses, joined; empty if the file does not know."""
        return JOINT.join(self.options)


def remembered(path: Path) -> TrainedOn:
    """Return the names in a model's file, which are read without running anything; those of a damaged file are none."""
    try:
        if path.suffix == ".zip":
            with ZipFile(path) as archive:
                content = json.loads(archive.read("data"))
        else:
            content = json.loads(path.with_suffix(".json").read_bytes())
        seen, actions = content["observation_space"], content["action_space"]
        options = {str(goal): tuple(map(str, names)) for goal, names in actions.get(NAMES, {}).items()}
        mode = mode_of(options=bool(options), vector=actions[SPACE_TYPE].endswith(("Box", "Box'>")))
        return TrainedOn(tuple(map(str, seen.get(NAMES, ()))), options, mode)
    except (OSError, BadZipFile, zlib_error, RuntimeError, EOFError, ValueError, KeyError, TypeError, AttributeError):
        return TrainedOn()


def write_names(path: Path, observation_space: Space[Any], action_space: Space[Any]) -> None:
    """Write the names in the spaces of an environment into the `.json` beside a model, as a `.zip` has them."""
    spaces = {"observation_space": observation_space, "action_space": action_space}
    content = {
        key: {SPACE_TYPE: type(space).__name__, NAMES: vars(space).get(NAMES, {})} for key, space in spaces.items()
    }
    write_whole(path.with_suffix(".json"), json.dumps(content, indent=2).encode())


class ModelDecider(Decider):
    """A model of another library that takes the options it prefers, gives a movement vector, or both.

    Args:
        path: the model.
        mode: what it gives.
        problem, teams: see `Decider`; without options among its features if the model only drives.

    Raises:
        DocumentError: there is no such file, its library is not installed, or it does not fit the problem.

    """

    def __init__(self, path: Path, mode: Mode, problem: Problem, teams: Ints) -> None:
        super().__init__(problem, teams)
        known = remembered(path)
        fits = not known.options or known.goal == problem.goal
        must_fit(fits, f"{path}: goal", problem.goal, known.goal)
        columns = zip(*(option.split(JOINT) for option in problem.options), strict=True)
        parts = [tuple(dict.fromkeys(column)) for column in columns] if known.options else [problem.options]
        own = list(known.options.values()) or parts
        for part, names in zip(parts, own, strict=True):
            check_known(str(path), "options", part, names)
        self._mode, self._sizes = mode, [len(part) for part in parts]
        self._places = [np.array([part.index(n) for n in names]) for part, names in zip(parts, own, strict=True)]
        check_known(str(path), "observations", problem.features, known.observations)
        self._columns = columns_of(problem, known.observations or problem.features, str(path))
        gives = {"option": f"{sum(map(len, own))} options", "velocity": "a vector"}
        gives["both"] = f"{gives['option']} and a vector"
        self._expected = f"{path}: expected a model that gives {gives[mode]}, got"
        self._model = loaded(path, len(self._columns), gives[mode], self._decided)

    def _decide(self, observations: Observations) -> Decided:
        with within(self._expected):
            return self._decided(self._model(observations[:, self._columns]), len(observations))

    def _decided(self, given: NDArray[Any], rows: int) -> Decided:
        """Return what an answer says; ValueError says what does not fit."""
        options: Ints = np.zeros(rows, dtype=np.int64)
        if self._mode == "velocity":
            return Decided(options, checked_vectors(given, rows))
        vectors, both = np.zeros((rows, 2)), self._mode == "both"
        counts = [len(places) for places in self._places]
        if given.ndim == 2 and given.dtype.kind == "f":
            if given.shape[1] != sum(counts) + 2 * both or not np.isfinite(given).all():
                raise ValueError(
                    f"{given.shape[1]} numbers, of which {np.isfinite(given).all(axis=0).sum()} are finite"
                )
            given = preferred(given, counts)
        if both:
            given, vectors = given[:, :-2], given[:, -2:].astype(np.float64)
        table = given.reshape(rows, -1).astype(np.int64)
        if table.shape[1] != len(counts) or (table >= counts).any() or (table < 0).any():
            raise ValueError(f"options {given.tolist()}")
        chosen = [places[column] for places, column in zip(self._places, table.T, strict=True)]
        return Decided(np.ravel_multi_index(chosen, self._sizes), vectors)


def loaded(path: Path, features: int, gives: str, check: Callable[[NDArray[Any], int], Any]) -> Model:
    """Return the model of a file after an answer for one row, which `check` takes or refuses with ValueError.

    `gives` says what a model of that many `features` has to give.
    """
    if not path.is_file():
        raise DocumentError(f"{path}: no such file")
    if path.suffix not in LOADERS:
        raise DocumentError(f"{path}: expected a file that ends in {', '.join(LOADERS)}")
    check_trust(str(path), f"load {path}, a model of another library")
    try:
        if path.suffix in (".zip", ".pt") and (damaged := ZipFile(path).testzip()):  # libraries would crash on some
            raise ValueError(f"a damaged part {damaged}")
        model = LOADERS[path.suffix](path)
        check(np.asarray(model(np.zeros((1, features), dtype=np.float32))), 1)
    except ImportError as error:
        raise DocumentError(f"{path}: {error}; the extras train and onnx have what models need") from error
    except Exception as error:  # a damaged file makes libraries and the objects in it raise anything
        text = " ".join(str(error).split())[:200] or type(error).__name__
        raise DocumentError(f"{path}: expected a model of {features} numbers and {gives}, got {text}") from error
    return model


def stable_baselines3(path: Path) -> Model:
    """Return the policy of a model of Stable-Baselines3 or sb3-contrib, with its normalisation."""
    from stable_baselines3.common.save_util import load_from_zip_file

    data, parameters, _ = load_from_zip_file(path, device="cpu")
    spaces = data["observation_space"], data["action_space"]
    policy = data["policy_class"](*spaces, lambda _: 0.0, **data["policy_kwargs"])
    policy.load_state_dict(parameters["policy"])
    scales = path.with_suffix(".pkl")
    scaled = pickle.loads(scales.read_bytes()).normalize_obs if scales.is_file() else np.asarray
    return lambda observations: policy.predict(scaled(observations), deterministic=True)[0]


def torch_script(path: Path) -> Model:
    """Return a module that `torch.jit.save` wrote."""
    import torch

    module = torch.jit.load(str(path), map_location="cpu").eval()
    model: Model = torch.no_grad()(lambda observations: module(torch.from_numpy(observations)).numpy())
    return model


def onnx(path: Path) -> Model:
    """Return a model of ONNX, run by onnxruntime."""
    import onnxruntime

    session = onnxruntime.InferenceSession(str(path), providers=["CPUExecutionProvider"])
    name = session.get_inputs()[0].name
    return lambda observations: session.run(None, {name: observations})[0]


LOADERS: dict[str, Callable[[Path], Model]] = {".zip": stable_baselines3, ".pt": torch_script, ".onnx": onnx}
"""Ending of a file -> function that loads it."""
