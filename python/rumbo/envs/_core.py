"""Robots with a task: what single and vector environments share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from gymnasium import error, spaces
from numpy.typing import NDArray

from .._rumbo import REACH_M
from .._setup import Source
from .._sim import TRUE, Batch
from ._render import frame
from ._tasks import ACTION_S, FAILURE, MAX_WHEEL_RAD_S, Bools, Floats, Task, collided, mix

#: An episode begins after the robot has stood for this long, so that every sonar has answered [s].
STAND_S = 0.5

_ANGLE = np.float32(np.pi)
_LOW = [-60, -60, 0, 0, 0, 0, 0, 0, -_ANGLE / 2, -50, -50, -_ANGLE, -50, -50]
_HIGH = [60, 60, REACH_M, REACH_M, REACH_M, 1, 1, 1, _ANGLE / 2, 50, 50, _ANGLE, 50, 50]
#: What an action of 1 is: the wheels [rad/s], the servo [rad]; a little less than its end, which it must not pass.
SCALE = np.array([MAX_WHEEL_RAD_S, MAX_WHEEL_RAD_S, 1.5707], np.float32)
SCALE.setflags(write=False)


def observation_space() -> spaces.Box:
    """Of one environment: by the names of `rumbo.OBSERVED`."""
    return spaces.Box(np.array(_LOW, np.float32), np.array(_HIGH, np.float32), dtype=np.float32)


def action_space() -> spaces.Box:
    """Of one environment: left wheel, right wheel, servo, in shares of `SCALE`."""
    return spaces.Box(-1.0, 1.0, (3,), np.float32)


@dataclass(frozen=True)
class Settings:
    """What an environment can be made with, besides its task."""

    robot: Source | None = None
    world: Source | None = None
    parameters: Mapping[str, float] | None = None
    randomize: bool | None = None
    threads: int | None = None


@dataclass
class Step:
    """What an action led to, a row for each robot."""

    known: NDArray[np.float32]
    truth: Floats
    reward: Floats
    terminated: Bools
    truncated: Bools


class Core:
    """Robots with a task, each in an episode of its own."""

    def __init__(self, task: Task, settings: Settings, count: int) -> None:
        if count < 1:
            raise ValueError(f"num_envs = {count}: must be at least 1")
        self.task = task
        self.count = count
        self._settings = settings
        self._robot = task.robot if settings.robot is None else settings.robot
        self._world = task.world if settings.world is None else settings.world
        space = observation_space()
        self._low, self._high = space.low, space.high
        #: The robots, once the first reset has given their seeds.
        self._batch: Batch | None = None
        self._closed = False
        #: The seed given to each, and how many of its episodes were begun.
        self._bases = [0] * count
        self._begun = [0] * count
        self.seeds = np.zeros(count, np.int64)
        self._targets = np.zeros((count, 2))
        self._has_targets = task.targets(0) is not None
        #: Episodes that begin from now on are recorded.
        self.recorded = False
        #: The columns of the ground truth that infos have: without a goal where the task has none.
        self._names = [
            (column, name) for column, name in enumerate(TRUE) if not (self._has_targets and name.startswith("goal_"))
        ]
        self._steps = np.zeros(count, np.int64)
        self._known = np.zeros((count, len(_LOW)), np.float32)
        self._truth = np.zeros((count, len(TRUE)))

    @property
    def batch(self) -> Batch:
        """The robots, to be looked at; `gymnasium.error.ResetNeeded` before the first reset."""
        self.check_open()
        if self._batch is None:
            raise error.ResetNeeded("reset() comes first")
        return self._batch

    @property
    def is_seeded(self) -> bool:
        """Some reset has given seeds."""
        return self._batch is not None

    def begin(self, chosen: Sequence[int], bases: Sequence[int | None]) -> None:
        """Begins an episode for each of the chosen: that of its base, or with ``None`` the next of the last base."""
        self.check_open()
        for index, base in zip(chosen, bases):
            if base is not None:
                self._bases[index], self._begun[index] = checked_seed(base), 0
            self.seeds[index] = self._episode_seed(index)
            self._begun[index] += 1
        seeds = [int(self.seeds[index]) for index in chosen]
        if self._batch is None:
            self._batch = self._make()
        else:
            self._batch.renew(chosen, seeds)
        if self.recorded:
            self._batch.record(chosen)
        self._batch.begin_wheel_speed(chosen, STAND_S)
        for index, seed in zip(chosen, seeds):
            self._targets[index] = self.task.targets(seed) or (0.0, 0.0)
        self._steps[chosen] = 0
        # All are looked at again, which changes nothing for those that go on.
        self._known, self._truth = self._batch.rows()
        self._finish(self._known)

    def _make(self) -> Batch:
        settings = self._settings
        return Batch(
            self.task.scenario,
            seeds=[int(seed) for seed in self.seeds],
            driver="caller",
            robot=self._robot,
            world=self._world,
            parameters=settings.parameters,
            randomize=settings.randomize,
            threads=settings.threads,
        )

    def _episode_seed(self, index: int) -> int:
        begun = self._begun[index]
        # Below 2**63: infos hold it in 64 bits with a sign.
        return self._bases[index] if begun == 0 else mix(self._bases[index] ^ mix(begun)) >> 1

    def step(self, actions: Any, active: Bools) -> Step:
        """Acts for the 0.1 s of an action; robots of which `active` is false stay as they are."""
        batch = self.batch
        rows = self._checked_actions(actions)
        before = self._truth
        known, truth = batch.drive(rows, ACTION_S, active=active)
        self._finish(known)
        self._known, self._truth = known, truth
        self._steps[active] += 1
        reward, succeeded = self.task.judge(before, truth, self._targets)
        failed = collided(truth) & ~succeeded
        reward = np.where(failed, reward + FAILURE, reward)
        terminated = failed | succeeded
        truncated = (self._steps >= self.task.steps) & ~terminated
        return Step(known, truth, reward, terminated, truncated)

    def _finish(self, known: NDArray[np.float32]) -> None:
        if self._has_targets:
            known[:, -2:] = self._targets
        np.clip(known, self._low, self._high, out=known)

    def _checked_actions(self, actions: Any) -> NDArray[np.float32]:
        rows = np.asarray(actions, dtype=np.float32)
        if rows.shape != (self.count, 3):
            raise ValueError(f"actions has the shape {rows.shape}: must be ({self.count}, 3)")
        if np.isnan(rows).any():
            row, column = np.argwhere(np.isnan(rows))[0]
            raise ValueError(f"action[{row}, {column}] is not a number")
        return np.clip(rows, np.float32(-1), np.float32(1)) * SCALE

    def known(self) -> NDArray[np.float32]:
        """The present observations: a copy."""
        return self._known.copy()

    def info(self, index: int) -> dict[str, Any]:
        """Ground truth of one robot, by name."""
        values: dict[str, Any] = {name: float(self._truth[index, column]) for column, name in self._names}
        values["seed"] = int(self.seeds[index])
        return values

    def infos(self, mask: Bools | None = None) -> dict[str, Any]:
        """Ground truth of all robots as Gymnasium wants it of a vector: an array for each name, and which are valid."""
        valid = np.ones(self.count, np.bool_) if mask is None else mask
        values: dict[str, Any] = {name: self._truth[:, column].copy() for column, name in self._names}
        values["seed"] = self.seeds.copy()
        return values | {f"_{name}": valid.copy() for name in values}

    def render(self, index: int) -> NDArray[np.uint8]:
        """The world from above."""
        return frame(self.batch.obstacles(index), dict(zip(TRUE, self._truth[index])))

    def close(self) -> None:
        """Lets go of the robots."""
        self._closed = True
        self._batch = None

    def check_open(self) -> None:
        """Refuses what comes after `close`."""
        if self._closed:
            raise error.ClosedEnvironmentError("this environment was closed; make a new one")


def checked_seed(seed: int) -> int:
    """A seed that infos can hold."""
    if not 0 <= seed < 2**63:
        raise ValueError(f"seed = {seed}: must be 0 or more and below 2**63")
    return int(seed)
