"""A frame: the world from above, drawn with NumPy alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import cos, isfinite, sin

import numpy as np
from numpy.typing import NDArray

#: Side of a frame [pixels].
SIZE = 256
#: What a frame shows, around the robot's start [m].
_FROM_M, _TO_M = (-1.5, -3.0), (4.5, 3.0)

_FLOOR, _SOLID, _ROBOT, _GOAL = (245, 245, 240), (90, 90, 90), (30, 90, 200), (20, 150, 60)
#: The body of the robot of the report, ahead and to the left of the middle of its axis [m].
_BODY = ((-0.07, -0.075), (0.13, -0.075), (0.13, 0.075), (-0.07, 0.075))

_STEP = (_TO_M[0] - _FROM_M[0]) / SIZE
_X, _Y = np.meshgrid(
    _FROM_M[0] + _STEP * (np.arange(SIZE) + 0.5),
    _TO_M[1] - _STEP * (np.arange(SIZE) + 0.5),
)


def frame(obstacles: Sequence[NDArray[np.float64]], truth: Mapping[str, float]) -> NDArray[np.uint8]:
    """The obstacles, the robot with its nose, and the goal; shape (256, 256, 3)."""
    # The view follows a robot that leaves it.
    shift_x = _shift(truth["x_m"], _FROM_M[0], _TO_M[0])
    shift_y = _shift(truth["y_m"], _FROM_M[1], _TO_M[1])
    x_m, y_m = _X + shift_x, _Y + shift_y
    image = np.full((SIZE, SIZE, 3), _FLOOR, np.uint8)
    for corners in obstacles:
        image[_inside(corners, x_m, y_m, _STEP / 2)] = _SOLID
    if isfinite(truth["goal_x_m"]):
        near = (x_m - truth["goal_x_m"]) ** 2 + (y_m - truth["goal_y_m"]) ** 2 < 0.1**2
        image[near] = _GOAL
    ahead, left = cos(truth["heading_rad"]), sin(truth["heading_rad"])
    body = np.array([(truth["x_m"] + a * ahead - b * left, truth["y_m"] + a * left + b * ahead) for a, b in _BODY])
    image[_inside(body, x_m, y_m, 0.0)] = _ROBOT
    nose = (x_m - truth["x_m"] - 0.1 * ahead) ** 2 + (y_m - truth["y_m"] - 0.1 * left) ** 2 < 0.03**2
    image[nose] = _FLOOR
    return image


def _shift(at_m: float, low_m: float, high_m: float) -> float:
    return min(at_m - low_m - 0.5, 0.0) + max(at_m - high_m + 0.5, 0.0)


def _inside(
    corners: NDArray[np.float64], x_m: NDArray[np.float64], y_m: NDArray[np.float64], margin_m: float
) -> NDArray[np.bool_]:
    """Points of a convex shape, and those within a margin of it."""
    after = np.roll(corners, -1, axis=0)
    # Twice the area, positive counter-clockwise; a wall without thickness has none.
    area = float(np.sum(corners[:, 0] * after[:, 1] - after[:, 0] * corners[:, 1]))
    if abs(area) < 1e-9:
        return _near(corners[0], corners[1], x_m, y_m, max(margin_m, _STEP))
    inside = np.ones(x_m.shape, np.bool_)
    for (px, py), (ex, ey) in zip(corners, after - corners):
        beside = (ex * (y_m - py) - ey * (x_m - px)) / max(float(np.hypot(ex, ey)), 1e-12)
        inside &= np.sign(area) * beside >= -margin_m
    return inside


def _near(
    start: NDArray[np.float64],
    end: NDArray[np.float64],
    x_m: NDArray[np.float64],
    y_m: NDArray[np.float64],
    reach_m: float,
) -> NDArray[np.bool_]:
    """Points within reach of a line."""
    (px, py), (ex, ey) = start, end - start
    along = np.clip(((x_m - px) * ex + (y_m - py) * ey) / max(ex * ex + ey * ey, 1e-12), 0.0, 1.0)
    near: NDArray[np.bool_] = (x_m - px - along * ex) ** 2 + (y_m - py - along * ey) ** 2 <= reach_m**2
    return near
