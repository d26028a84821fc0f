"""The tasks: what the last two numbers of an observation are, what is rewarded, and when an episode ends.

All arithmetic is of kinds that NumPy rounds alike for one robot and for many (no sines, no powers): the reward of an
episode must not depend on the number of environments beside it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import load
from .._setup import Source
from .._sim import TRUE

#: Seconds of an action.
ACTION_S = 0.1
#: The wheel speed of an action of 1 [rad/s].
MAX_WHEEL_RAD_S = 12.0
#: A contact faster than this ends an episode [m/s].
HARD_CONTACT_M_S = 0.1
#: The reward of an end that should not be: a contact, or a fault of the robot.
FAILURE = -10.0
#: The side of the square, and how near a robot must come to a corner of it [m].
SIDE_M, NEAR_M = 1.0, 0.1
#: A distance farther than the sonars reach counts as this [m].
REACH_M = 2.5

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

_COLUMN = {name: column for column, name in enumerate(TRUE)}
_BITS = 2**64 - 1


def mix(number: int) -> int:
    """A hash of 64 bits (the finaliser of SplitMix64)."""
    number = (number + 0x9E3779B97F4A7C15) & _BITS
    number = ((number ^ (number >> 30)) * 0xBF58476D1CE4E5B9) & _BITS
    number = ((number ^ (number >> 27)) * 0x94D049BB133111EB) & _BITS
    return number ^ (number >> 31)


def uniform(seed: int, which: int, low: float, high: float) -> float:
    """A number in [low, high) of an episode's seed."""
    return low + (high - low) * ((mix(seed ^ mix(which)) >> 11) / 2**53)


def column(truth: Floats, name: str) -> Floats:
    """A column of the ground truth."""
    return truth[:, _COLUMN[name]]


def collided(truth: Floats) -> Bools:
    """The robot met something hard, or stopped itself with a fault."""
    hard: Bools = (column(truth, "contact_m_s") > HARD_CONTACT_M_S) | (column(truth, "fault") != 0)
    return hard


def closeness(error: Floats, none: float) -> Floats:
    """1 without an error, 0 from an error of `none` on. Never negative, or an early end would be worth having."""
    return np.maximum(1.0 - error / none, 0.0)


@dataclass(frozen=True)
class Task:
    """A task, in one place for single and vector environments."""

    #: Where robot, sensor layout, world and start come from.
    scenario: str
    #: In place of the scenario's robot and world.
    robot: Source | None
    world: Source | None
    #: An episode is cut off after this many actions.
    steps: int
    #: Names of the last two numbers of an observation.
    names: tuple[str, str]
    #: Actions are shares of the full PWM; else setpoints of the wheels.
    pwm: bool = False
    #: Points to reach one after the other, as seen from the start: ahead, to the left [m].
    course: tuple[tuple[float, float], ...] = ()

    def targets(self, seed: int) -> tuple[float, float] | None:
        """The last two numbers of the observations of an episode; ``None`` where a goal stands there."""
        return None

    def judge(self, before: Floats, truth: Floats, targets: Floats) -> tuple[Floats, Bools]:
        """Rewards, and whether each robot has succeeded, which ends its episode, or reached the point of its course.

        `before` and `truth` are the ground truth before and after the action, `targets` those of `Task.targets`, or
        where in the world the next point of the course is [m].
        """
        raise NotImplementedError


class WheelSpeed(Task):
    """Both wheels at speeds of their own."""

    def targets(self, seed: int) -> tuple[float, float] | None:
        return uniform(seed, 1, -10.0, 10.0), uniform(seed, 2, -10.0, 10.0)

    def judge(self, before: Floats, truth: Floats, targets: Floats) -> tuple[Floats, Bools]:
        left = np.abs(column(truth, "left_rad_s") - targets[:, 0])
        right = np.abs(column(truth, "right_rad_s") - targets[:, 1])
        return closeness(0.5 * (left + right), 20.0), np.zeros(len(truth), np.bool_)


class StopAtWall(Task):
    """Stand at a distance from the wall ahead."""

    def targets(self, seed: int) -> tuple[float, float] | None:
        return uniform(seed, 1, 0.2, 0.8), 0.0

    def judge(self, before: Floats, truth: Floats, targets: Floats) -> tuple[Floats, Bools]:
        error = np.abs(np.minimum(column(truth, "range_front_m"), REACH_M) - targets[:, 0])
        return closeness(error, 1.0), np.zeros(len(truth), np.bool_)


class FollowWall(Task):
    """Drive along the wall on the left at a distance from it."""

    def targets(self, seed: int) -> tuple[float, float] | None:
        return uniform(seed, 1, 0.3, 0.6), 0.0

    def judge(self, before: Floats, truth: Floats, targets: Floats) -> tuple[Floats, Bools]:
        left = np.minimum(column(truth, "range_left_m"), REACH_M)
        right = np.minimum(column(truth, "range_right_m"), REACH_M)
        error = np.abs(0.5 * (left + right) - targets[:, 0])
        ahead = np.clip(column(truth, "forward_m_s"), 0.0, 0.3) / 0.3
        return ahead * closeness(error, 0.5), np.zeros(len(truth), np.bool_)


class DriveSquare(Task):
    """Drive along the corners of a square."""

    def judge(self, before: Floats, truth: Floats, targets: Floats) -> tuple[Floats, Bools]:
        was, now = _distance_m(before, *targets.T), _distance_m(truth, *targets.T)
        reached: Bools = now < NEAR_M
        return (was - now) + 1.0 * reached, reached


class Goal(Task):
    """Reach a goal among boxes."""

    def judge(self, before: Floats, truth: Floats, targets: Floats) -> tuple[Floats, Bools]:
        was, now = _goal_m(before), _goal_m(truth)
        reached: Bools = now < 0.1
        return (was - now) + 10.0 * reached, reached


def _goal_m(truth: Floats) -> Floats:
    return _distance_m(truth, column(truth, "goal_x_m"), column(truth, "goal_y_m"))


def _distance_m(truth: Floats, to_x_m: Floats, to_y_m: Floats) -> Floats:
    x_m, y_m = to_x_m - column(truth, "x_m"), to_y_m - column(truth, "y_m")
    distance: Floats = np.sqrt(x_m * x_m + y_m * y_m)
    return distance


def _calibrated() -> dict[str, Any]:
    """The robot after `rumbo calibrate`: what that leaves unknown of wheels and base (docs/theory/calibration.md).

    Straight out of the box its odometry misses a goal 4 m away by more than the 0.1 m of an arrival.
    """
    robot = load("robot", "memoria")
    robot["plant"]["spread"] |= {"radius": 0.0002, "base": 0.0006}
    return robot


_SPEEDS = ("target_left_rad_s", "target_right_rad_s")
_RANGE = ("target_range_m", "nothing")
_SQUARE = ((SIDE_M, 0.0), (SIDE_M, SIDE_M), (0.0, SIDE_M), (0.0, 0.0))

WHEEL_SPEED = WheelSpeed("mode5", None, None, steps=50, names=_SPEEDS)
WHEEL_PWM = WheelSpeed("mode5", None, None, steps=50, names=_SPEEDS, pwm=True)
DRIVE_SQUARE = DriveSquare(
    "mode5", None, None, steps=400, names=("corner_ahead_m", "corner_left_m"), pwm=True, course=_SQUARE
)
STOP_AT_WALL = StopAtWall("mode1", None, None, steps=100, names=_RANGE)
FOLLOW_WALL = FollowWall("mode4", None, None, steps=200, names=_RANGE)
GOAL = Goal("mode8-random", _calibrated(), "boxes", steps=600, names=("goal_ahead_m", "goal_left_m"))

#: The tasks by the names of their environments, without ``rumbo/`` and ``-v0``.
ALL = {
    "WheelSpeed": WHEEL_SPEED,
    "WheelPwm": WHEEL_PWM,
    "DriveSquare": DRIVE_SQUARE,
    "StopAtWall": STOP_AT_WALL,
    "FollowWall": FOLLOW_WALL,
    "Goal": GOAL,
}
