"""The robots of a scenario with several, in one world, that the caller steps."""

from __future__ import annotations

import copy
import copyreg
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _rumbo
from ._setup import MADE_BY, Parameters, Source, check_version, make_seeds, make_setup, to_ticks
from ._sim import OBSERVED, TRUE


@dataclass(frozen=True)
class FleetSnapshot:
    """The robots of a fleet as they were at one moment."""

    _fleet: _rumbo.Fleet = field(repr=False)
    _seed: int


class Fleet:
    """The robots of a scenario with ``[[fleet]]``, in one world, stepped together.

    Driven by the scenario, each robot is bit for bit the one that `rumbo.run` simulates for the seed. What is said of
    robots that the caller drives holds as for `rumbo.Batch`.

    >>> fleet = rumbo.Fleet("examples/fleet/corners.toml", seed=7)
    >>> fleet.step(10)
    >>> fleet.truth()["x_m"]

    Args:
        scenario: A path, or the content of a scenario file as a dictionary.
        seed: Of all robots: each is drawn by its place in the list, too.
        callers: Names of the robots that the caller drives; the scenario commands the others.
        robot, world, parameters, randomize: As for `rumbo.run`.

    Raises:
        ValueError: A scenario with one robot, a name in `callers` that none has, and as `rumbo.run`.
        RuntimeError: From any method, while another thread is stepping the same robots.
    """

    def __init__(
        self,
        scenario: Source,
        *,
        seed: int = 1,
        callers: Sequence[str] = (),
        robot: Source | None = None,
        world: Source | None = None,
        parameters: Parameters | None = None,
        randomize: bool | None = None,
    ) -> None:
        setup = make_setup(scenario, robot=robot, world=world, parameters=parameters, randomize=randomize)
        #: The seed of all robots.
        self.seed: int = make_seeds(seed)[0]
        self._setup, self._callers = setup, list(callers)
        self._fleet = _rumbo.Fleet(setup, self.seed, callers=self._callers)
        #: How long the scenario lasts [s]; the robots can be stepped beyond.
        self.duration_s: float = setup.duration_s
        #: The robots' names: they are the rows of all arrays, in this order.
        self.names: tuple[str, ...] = tuple(setup.robots)

    def __repr__(self) -> str:
        return f"<{len(self)} robots of {self._setup.name} in one world, seed {self.seed}>"

    def __copy__(self) -> Fleet:
        return copy.deepcopy(self)

    def __len__(self) -> int:
        return len(self.names)

    def renew(self, seed: int) -> None:
        """Puts the robots of another seed, at their start, in place of these."""
        number = make_seeds(seed)[0]
        self._fleet = _rumbo.Fleet(self._setup, number, callers=self._callers)
        self.seed = number

    def snapshot(self) -> FleetSnapshot:
        """The robots as they are now: `restore` puts them back, any number of times, and it can be pickled."""
        return FleetSnapshot(copy.deepcopy(self._fleet), self.seed)

    def restore(self, snapshot: FleetSnapshot) -> None:
        """Puts the robots back to a snapshot; from there on they are bit for bit the same.

        Raises:
            ValueError: The snapshot is of other robots.
        """
        names = snapshot._fleet.parts()[0].robots
        if tuple(names) != self.names:
            raise ValueError(f"a snapshot of {', '.join(names)} does not fit {', '.join(self.names)}")
        self._fleet, self.seed = copy.deepcopy(snapshot._fleet), snapshot._seed

    def step(self, duration_s: float = 0.01) -> None:
        """Advances all robots by `duration_s` [s], a multiple of the control tick of 0.01 s."""
        self._fleet.advance(to_ticks(duration_s))

    def begin_wheel_speed(self, duration_s: float = 0.5) -> None:
        """Selects mode ``wheel_speed`` for the robots that the caller drives, and arms them.

        They then stand for `duration_s` [s], so that every sonar has answered; the others go by the scenario meanwhile.
        """
        self._fleet.begin(to_ticks(duration_s))

    def drive(self, actions: ArrayLike, duration_s: float = 0.1, *, active: ArrayLike | None = None) -> None:
        """Sets wheel speeds and servo of the robots that the caller drives, and advances all.

        Args:
            actions: Shape (robots, 3), as for `rumbo.Batch.drive`; rows of robots that the scenario commands are of no
                effect.
            duration_s: A multiple of 0.01 s.
            active: Shape (robots,); robots of which it is false are disarmed: their wheels roll out, and stay so.

        Raises:
            ValueError: A wrong shape, or a value that is out of range or not a number, with its index.
        """
        rows = np.ascontiguousarray(actions, dtype=np.float32)
        if rows.shape != (len(self), 3):
            raise ValueError(f"actions has the shape {rows.shape}: must be ({len(self)}, 3)")
        chosen = np.ones(len(self), np.bool_) if active is None else np.ascontiguousarray(active, dtype=np.bool_)
        if chosen.shape != (len(self),):
            raise ValueError(f"active has the shape {chosen.shape}: must be ({len(self)},)")
        self._fleet.drive(rows, chosen, to_ticks(duration_s))

    def rows(self) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
        """What the robots know and what is true, a row for each: see `rumbo.Batch.observe_rows` and `truth_rows`.

        The goal is that of the world, else the first one of the robot's commands. What runs another program than
        Rumbo's knows zeros.
        """
        known = np.empty((len(self), len(OBSERVED)), np.float32)
        truth = np.empty((len(self), len(TRUE)), np.float64)
        self._fleet.observe(known, truth)
        return known, truth

    def observe(self) -> dict[str, NDArray[np.float32]]:
        """What the robots' programs know after the last tick, by the names of `rumbo.OBSERVED`: shape (robots,)."""
        rows = self.rows()[0]
        return {name: rows[:, column] for column, name in enumerate(OBSERVED)}

    def truth(self) -> dict[str, NDArray[np.float64]]:
        """Ground truth now, by the names of `rumbo.TRUE`, shape (robots,) each."""
        rows = self.rows()[1]
        return {name: rows[:, column] for column, name in enumerate(TRUE)}

    def obstacles(self) -> list[NDArray[np.float64]]:
        """The corners of each wall and box, shape (corners, 2) each [m]."""
        return [np.array(corners) for corners in self._fleet.obstacles()]

    def fault(self, name: str) -> str | None:
        """The fault that a robot has latched, in words."""
        if name not in self.names:
            raise ValueError(f"no robot {name!r}: there are {', '.join(self.names)}")
        return self._fleet.fault(self.names.index(name))


def _again(made_by: tuple[str, int], setup: _rumbo.Setup, seed: int, callers: list[str], history: bytes) -> Any:
    check_version("robots", made_by)
    return _rumbo.Fleet(setup, seed, callers=callers, history=history)


copyreg.pickle(_rumbo.Fleet, lambda fleet: (_again, (MADE_BY, *fleet.parts())))
