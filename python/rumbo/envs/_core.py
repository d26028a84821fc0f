"""Robots with a task: what single and vector environments share."""

from __future__ import annotations

import contextlib
import copy
import ctypes
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from gymnasium import error, spaces
from numpy.typing import NDArray

from .. import _rumbo
from .._rumbo import REACH_M
from .._setup import Parameters, Source
from .._sim import OBSERVED, TRUE, Batch
from ._render import frame
from ._tasks import ACTION_S, FAILURE, MAX_WHEEL_RAD_S, Bools, Floats, Task, collided, mix

#: An episode begins after the robot has stood for this long, so that every sonar has answered [s].
STAND_S = 0.5

_ANGLE = np.float32(np.pi)
_LOW = [-60, -60, 0, 0, 0, 0, 0, 0, -_ANGLE / 2, -50, -50, -_ANGLE, -50, -50]
_HIGH = [60, 60, REACH_M, REACH_M, REACH_M, 1, 1, 1, _ANGLE / 2, 50, 50, _ANGLE, 50, 50]
#: So many robots are worth the while that giving their memory back takes.
MANY = 64
#: Where the servo points at an action of 1 [rad]: a little less than its end, which it must not pass.
_SERVO_RAD = 1.5707
#: What an action of 1 is: the wheels [rad/s], the servo [rad]; and the same where wheels get shares of the full PWM.
SCALE = np.array([MAX_WHEEL_RAD_S, MAX_WHEEL_RAD_S, _SERVO_RAD], np.float32)
PWM_SCALE = np.array([1.0, 1.0, _SERVO_RAD], np.float32)
for _scale in (SCALE, PWM_SCALE):
    _scale.setflags(write=False)

_X, _Y, _HEADING = (OBSERVED.index(name) for name in ("x_m", "y_m", "heading_rad"))


def observation_names(task: Task) -> tuple[str, ...]:
    """The names of the numbers of an observation: those of `rumbo.OBSERVED`, the last two being the task's."""
    return (*OBSERVED[:-2], *task.names)


def observation_space() -> spaces.Box:
    """Of one environment: by its `observation_names`."""
    return spaces.Box(np.array(_LOW, np.float32), np.array(_HIGH, np.float32), dtype=np.float32)


def action_space() -> spaces.Box:
    """Of one environment: left wheel, right wheel, servo, in shares of `SCALE`."""
    return spaces.Box(-1.0, 1.0, (3,), np.float32)


@dataclass(frozen=True)
class Settings:
    """What an environment can be made with, besides its task."""

    robot: Source | None = None
    world: Source | None = None
    parameters: Parameters | None = None
    randomize: bool | None = None
    threads: int | None = None
    #: Actions of an episode before it is cut off; that of the task by default, -1 for no end.
    max_episode_steps: int | None = None


@dataclass(frozen=True)
class EnvSnapshot:
    """Environments as they were at one moment, to be restored any number of times; they can be pickled."""

    _scenario: str
    _robots: _rumbo.Snapshot
    _state: dict[str, Any] = field(repr=False)


@dataclass
class Step:
    """What an action led to, a row for each robot."""

    known: NDArray[np.float32]
    truth: Floats
    reward: Floats
    terminated: Bools
    truncated: Bools


#: What of a core changes with time, besides the robots.
_MOMENT = ("_names", "_bases", "_begun", "seeds", "_targets", "_reached", "_points", "_steps", "_known", "_truth")


class Core:
    """Robots with a task, each in an episode of its own."""

    def __init__(self, task: Task, settings: Settings, count: int) -> None:
        if count < 1:
            raise ValueError(f"num_envs = {count}: must be at least 1")
        steps = task.steps if settings.max_episode_steps is None else settings.max_episode_steps
        if steps < 1 and steps != -1:
            raise ValueError(f"max_episode_steps = {steps}: must be at least 1, or -1 for no end")
        self.task = task
        self.count = count
        self._most_steps = np.iinfo(np.int64).max if steps == -1 else steps
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
        #: Of a course: how many of its points each robot has reached, and all of them in the world [m].
        self._reached = np.zeros(count, np.int64)
        self._points = np.zeros((count, len(task.course), 2))
        #: Episodes that begin from now on are recorded.
        self.recorded = False
        #: The columns of the ground truth that infos have: none of a goal that the world lacks, or of a sonar that the
        #: robots lack. The first reset shows it.
        self._names: list[tuple[int, str]] = []
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
            first = self._batch.truth_rows()[0]
            self._names = [(column, name) for column, name in enumerate(TRUE) if not np.isnan(first[column])]
        else:
            self._batch.renew(chosen, seeds)
        if self.recorded:
            self._batch.record(chosen)
        self._batch.begin_wheel_speed(chosen, STAND_S)
        self._steps[chosen] = 0
        self._reached[chosen] = 0
        # All are looked at again, which changes nothing for those that go on.
        self._known, self._truth = self._batch.rows()
        for index, seed in zip(chosen, seeds):
            self._targets[index] = self.task.targets(seed) or (0.0, 0.0)
            if self.task.course:
                self._points[index] = self._course_from(self._truth[index])
        self._finish(self._known)

    def _course_from(self, truth: Floats) -> list[tuple[float, float]]:
        """Where in the world the points of the course are, for a robot that begins here [m]."""
        x_m, y_m, heading_rad = (float(truth[TRUE.index(name)]) for name in ("x_m", "y_m", "heading_rad"))
        ahead, left = math.cos(heading_rad), math.sin(heading_rad)
        return [(x_m + x * ahead - y * left, y_m + x * left + y * ahead) for x, y in self.task.course]

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
        known, truth = batch.drive(rows, ACTION_S, active=active, pwm=self.task.pwm)
        self._steps[active] += 1
        reward, succeeded = self.task.judge(before, truth, self._aims())
        if self.task.course:
            self._reached[active & succeeded] += 1
            succeeded &= self._reached == len(self.task.course)
        self._finish(known)
        self._known, self._truth = known, truth
        failed = collided(truth) & ~succeeded
        reward = np.where(failed, reward + FAILURE, reward)
        terminated = failed | succeeded
        truncated = (self._steps >= self._most_steps) & ~terminated
        return Step(known, truth, reward, terminated, truncated)

    def _aims(self) -> Floats:
        """What the task judges by: its targets, or the next point of the course, the last one if there is none."""
        if not self.task.course:
            return self._targets
        aims: Floats = self._points[np.arange(self.count), self._next()]
        return aims

    def _next(self) -> NDArray[np.int64]:
        return np.minimum(self._reached, len(self.task.course) - 1)

    def _finish(self, known: NDArray[np.float32]) -> None:
        if self._has_targets:
            known[:, -2:] = self._targets
        elif self.task.course:
            # One by one: NumPy may round sines of many otherwise than those of one.
            for row, next_one in zip(known, self._next().tolist()):
                x_m, y_m = self.task.course[next_one]
                x_m, y_m, heading_rad = x_m - float(row[_X]), y_m - float(row[_Y]), float(row[_HEADING])
                ahead, left = math.cos(heading_rad), math.sin(heading_rad)
                row[-2:] = x_m * ahead + y_m * left, y_m * ahead - x_m * left
        np.clip(known, self._low, self._high, out=known)

    def _checked_actions(self, actions: Any) -> NDArray[np.float32]:
        rows = np.asarray(actions, dtype=np.float32)
        if rows.shape != (self.count, 3):
            raise ValueError(f"actions has the shape {rows.shape}: must be ({self.count}, 3)")
        if np.isnan(rows).any():
            row, column = np.argwhere(np.isnan(rows))[0]
            raise ValueError(f"action[{row}, {column}] is not a number")
        return np.clip(rows, np.float32(-1), np.float32(1)) * (PWM_SCALE if self.task.pwm else SCALE)

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

    def snapshot(self, also: Mapping[str, Any]) -> EnvSnapshot:
        """The robots and their episodes as they are now, and what else there is."""
        state = {name: getattr(self, name) for name in _MOMENT} | dict(also)
        return EnvSnapshot(self.task.scenario, self.batch.snapshot(), copy.deepcopy(state))

    def restore(self, snapshot: EnvSnapshot) -> dict[str, Any]:
        """Puts all back, and gives what else was there."""
        self.check_open()
        robots = snapshot._robots
        if (snapshot._scenario, len(robots)) != (self.task.scenario, self.count):
            raise ValueError(
                f"a snapshot of {len(robots)} robots of {snapshot._scenario} does not fit {self.count} of "
                f"{self.task.scenario}"
            )
        if self._batch is None:
            self._batch = self._make()
        self._batch.restore(robots)
        state = copy.deepcopy(snapshot._state)
        for name in _MOMENT:
            setattr(self, name, state.pop(name))
        return state

    def close(self) -> None:
        """Lets go of the robots."""
        held, self._batch, self._closed = self._batch, None, True
        if held is not None and self.count >= MANY:
            del held
            _give_back()

    def check_open(self) -> None:
        """Refuses what comes after `close`."""
        if self._closed:
            raise error.ClosedEnvironmentError("this environment was closed; make a new one")


def _give_back() -> None:
    """Has glibc hand freed memory to the system: of thousands of small robots it keeps most for itself."""
    with contextlib.suppress(AttributeError, OSError, TypeError):
        ctypes.CDLL(None).malloc_trim(0)


def checked_seed(seed: int) -> int:
    """A seed that infos can hold."""
    if not 0 <= seed < 2**63:
        raise ValueError(f"seed = {seed}: must be 0 or more and below 2**63")
    return int(seed)
