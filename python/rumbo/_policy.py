"""Policies as the robot evaluates them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _rumbo
from ._setup import Source, hold
from ._sim import OBSERVED


class Policy:
    """A policy of mode 9 in the robot's own integers, bit for bit.

    Args:
        policy: The name, path or content of a file of ``rumbo export-policy``.

    Raises:
        ValueError, OSError: As `rumbo.load`.
    """

    def __init__(self, policy: Source) -> None:
        name, held = hold("policy", policy)
        self._policy = _rumbo.Policy(name, held)
        #: What it does.
        self.title: str = self._policy.title

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
