"""Policies as the robot evaluates them."""

from __future__ import annotations

import copyreg
import json
import os
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _rumbo
from ._log import write_file
from ._setup import Source, hold
from ._sim import OBSERVED


class Policy:
    """A policy of mode 9 in the robot's own integers, bit for bit.

    Args:
        policy: The name, path or content of a file of `export_policy`.

    Raises:
        ValueError, OSError: As `rumbo.load`.
    """

    def __init__(self, policy: Source) -> None:
        self._hold(_rumbo.Policy(*hold("policy", policy)))

    @classmethod
    def _of(cls, name: str, text: str) -> Policy:
        made = cls.__new__(cls)
        made._hold(_rumbo.Policy(name, [("policy", name, text)]))
        return made

    def _hold(self, policy: _rumbo.Policy) -> None:
        self._policy = policy
        #: What it does.
        self.title: str = policy.title

    def __repr__(self) -> str:
        return f"<policy {self.title!r}: {self._policy.shape}>"

    def decide(self, observations: ArrayLike) -> NDArray[np.int8]:
        """Outputs for observations, -127 to 127: columns left wheel, right wheel, servo, a row for each observation.

        Args:
            observations: Rows of what the robot's program knows, columns by `OBSERVED`.

        Raises:
            ValueError: Another shape, or a value that is not finite, with its index.
        """
        rows = np.ascontiguousarray(observations, np.float32)
        if rows.ndim != 2 or rows.shape[1] != len(OBSERVED):
            raise ValueError(f"observations has the shape {rows.shape}: must be (robots, {len(OBSERVED)})")
        if not np.isfinite(rows).all():
            row, column = np.argwhere(~np.isfinite(rows))[0]
            raise ValueError(f"observations[{row}, {column}] = {rows[row, column]}: must be a finite number")
        outputs = np.zeros((len(rows), 3), np.int8)
        self._policy.decide(rows, outputs)
        return outputs

    def __call__(self, observations: ArrayLike) -> NDArray[np.float32]:
        """The same as actions of an environment, -1 to 1."""
        return self.decide(observations).astype(np.float32) * np.float32(1 / 127)


def export_policy(
    network: str | os.PathLike[str] | Mapping[str, Any],
    path: str | os.PathLike[str] | None = None,
    *,
    title: str = "A learned policy",
    overwrite: bool = False,
) -> Policy:
    """Makes the 8-bit integers of mode 9 of a learned network, as ``rumbo export-policy`` does.

    >>> policy = rumbo.export_policy(network, "goal.toml")
    >>> rumbo.run("mode9-random", policy="goal.toml", seeds=range(1, 21))

    Mode 9 is given a goal, and drives its wheels by speeds: only policies of ``rumbo/Goal-v0`` and of ``FleetGoalEnv``
    find their inputs there. The setpoint of another task is refused by its name.

    Args:
        network: A dictionary, or the path of a JSON file, with ``inputs``, each a column ``of`` an observation (by the
            environment's ``observation_names``) with ``centre`` and ``scale``; ``layers``, each with a list of
            ``weights`` for each neuron and their ``biases``; and ``activation``, which must be ``"clip"``: every
            neuron, those of the last layer too, is clipped to -1..1 (``torch.nn.Hardtanh``). A network that was
            trained with tanh does something else on the robot.
        path: Where the policy file goes, if anywhere.
        title: One line that says what the policy does.
        overwrite: Replace a file that is there.

    Raises:
        ValueError: Whatever the robot cannot evaluate, with its place.
        FileExistsError, OSError: A file that is there, or that cannot be read or written.
    """
    if isinstance(network, Mapping):
        text, where = json.dumps(network, default=_as_list), "network"
    else:
        where = os.fspath(network)
        with open(network, encoding="utf-8") as file:
            text = file.read()
    try:
        made = _rumbo.quantise(text, title)
    except ValueError as error:
        raise ValueError(f"{where}: {error}") from None
    if path is not None:
        write_file(path, made.encode(), overwrite=overwrite)
    return Policy._of("policy" if path is None else os.fspath(path), made)


def _as_list(value: object) -> Any:
    """An array in a dictionary, NumPy's or another learner's."""
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"{value!r} in a network: must be a number, text, a list or an array")


def _again(arguments: tuple[str, list[tuple[str, str, str]]]) -> Any:
    return _rumbo.Policy(*arguments)


copyreg.pickle(_rumbo.Policy, lambda policy: (_again, (policy.arguments(),)))
