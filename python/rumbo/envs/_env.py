"""Single environments."""

from __future__ import annotations

import os
from typing import Any, ClassVar

import gymnasium
import numpy as np
from gymnasium import error
from numpy.typing import NDArray

from .._setup import Parameters, Source
from . import _tasks
from ._core import Core, EnvSnapshot, Settings, action_space, observation_names, observation_space

_ALL = np.ones(1, np.bool_)


class RumboEnv(gymnasium.Env[NDArray[np.float32], NDArray[np.float32]]):
    """One robot with a task.

    Args:
        robot, world, parameters: As for `rumbo.run`, in place of the task's.
        randomize: ``False``: every episode drives the robot of the file; only noise, world and task differ.
        render_mode: ``"rgb_array"``, the world from above, shape (256, 256, 3); or ``None``.
        max_episode_steps: Actions before the episode is truncated; those of the task by default, -1 for no end. In an
            environment of ``gymnasium.make`` its ``TimeLimit`` does that, by the argument of the same name.

    Raises:
        ValueError: An action of a wrong shape or with a value that is not a number, with its index; whatever is wrong
            with robot, world or parameters, at the first reset.
        gymnasium.error.ClosedEnvironmentError: Use after `close`.
        gymnasium.error.ResetNeeded: A step before the first reset, or after the end of an episode.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 10}  # noqa: RUF012
    _task: ClassVar[_tasks.Task]

    def __init__(
        self,
        *,
        robot: Source | None = None,
        world: Source | None = None,
        parameters: Parameters | None = None,
        randomize: bool | None = None,
        render_mode: str | None = None,
        max_episode_steps: int | None = None,
    ) -> None:
        check_render_mode(render_mode)
        self.render_mode = render_mode
        self.observation_space: gymnasium.spaces.Box = observation_space()  # type: ignore[assignment]
        self.action_space: gymnasium.spaces.Box = action_space()  # type: ignore[assignment]
        #: The names of the numbers of an observation.
        self.observation_names: tuple[str, ...] = observation_names(self._task)
        settings = Settings(robot, world, parameters, randomize, threads=1, max_episode_steps=max_episode_steps)
        self._core = Core(self._task, settings, 1)
        self._over = True

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begins the episode of `seed`, or the next one."""
        self._core.check_open()
        super().reset(seed=seed)
        if seed is None and not self._core.is_seeded:
            seed = int(self.np_random.integers(2**63))
        self._core.begin([0], [seed])
        self._over = False
        return self._core.known()[0], self._core.info(0)

    def step(self, action: NDArray[np.float32]) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Acts for 0.1 s."""
        self._core.check_open()
        if self._core.is_seeded and self._over:
            raise error.ResetNeeded("the episode is over; reset() begins the next one")
        one = np.asarray(action, dtype=np.float32)
        if one.shape != (3,):
            raise ValueError(f"action has the shape {one.shape}: must be (3,)")
        done = self._core.step(one[None], _ALL)
        # Gymnasium's `make` wraps a limit around, which may be another one.
        terminated, truncated = bool(done.terminated[0]), bool(done.truncated[0]) and self.spec is None
        self._over = terminated or truncated
        return done.known[0].copy(), float(done.reward[0]), terminated, truncated, self._core.info(0)

    def render(self) -> NDArray[np.uint8] | None:
        """The world from above; ``None`` without a render mode."""
        return None if self.render_mode is None else self._core.render(0)

    def snapshot(self) -> EnvSnapshot:
        """The episode as it is now: `restore` puts it back, any number of times, and it can be pickled.

        It is of this environment, not of wrappers around it that count or average; ``copy.deepcopy`` copies those, too.
        """
        return self._core.snapshot({"_over": self._over})

    def restore(self, snapshot: EnvSnapshot) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Puts the environment back to a snapshot of one of the same task; gives the observation and infos of then.

        From there on it is bit for bit the same.

        Raises:
            ValueError: The snapshot is of another task, or of a vector.
        """
        self._over = self._core.restore(snapshot)["_over"]
        return self._core.known()[0], self._core.info(0)

    def record(self, wanted: bool = True) -> None:
        """Whether episodes that begin from now on are recorded, for `write_log`; `RecordLog` does both."""
        self._core.recorded = wanted

    def write_log(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> None:
        """Writes the episode so far, from the robot's start on, as a log: see `rumbo.Sim.write_log`."""
        self._core.batch.write_log(0, path, overwrite=overwrite)

    def close(self) -> None:
        """Lets go of the robot."""
        self._core.close()
        super().close()


def check_render_mode(render_mode: str | None) -> None:
    """Refuses what cannot be drawn."""
    if render_mode not in (None, "rgb_array"):
        raise ValueError(f'render_mode = {render_mode!r}: must be "rgb_array" or None')


class WheelSpeedEnv(RumboEnv):
    """``rumbo/WheelSpeed-v0``: both wheels at speeds of their own, on an open floor, for 5 s.

    The last two numbers of an observation are the speeds to reach, left and right [rad/s], -10 to 10. The reward is 1
    minus the mean of both wheels' errors divided by 20 rad/s, at least 0. A contact above 0.1 m/s, or a fault of the
    robot, costs 10 and ends the episode.
    """

    _task = _tasks.WHEEL_SPEED


class WheelPwmEnv(RumboEnv):
    """``rumbo/WheelPwm-v0``: both wheels at speeds of their own, as `WheelSpeedEnv`, but by PWM, for 5 s.

    The first two numbers of an action are shares of the full PWM, -1 to 1, which the motors get as they are: battery,
    friction and load are the policy's to make up for, by the wheel speeds that the robot makes of its encoders' edges.
    """

    _task = _tasks.WHEEL_PWM


class DriveSquareEnv(RumboEnv):
    """``rumbo/DriveSquare-v0``: drive a square with sides of 1 m, to the left, by PWM, within 40 s.

    The first two numbers of an action are shares of the full PWM, -1 to 1. The last two numbers of an observation are
    the next corner as seen from the robot by its odometry: ahead, to the left [m]. The reward is how much nearer the
    robot came to it [m], and 1 for each corner that it comes nearer to than 0.1 m. The fourth, where it started, ends
    the episode. A contact above 0.1 m/s, or a fault of the robot, costs 10 and ends it.
    """

    _task = _tasks.DRIVE_SQUARE


class StopAtWallEnv(RumboEnv):
    """``rumbo/StopAtWall-v0``: stand at a distance from the wall ahead, for 10 s.

    The second last number of an observation is the distance [m] from sonar to wall, 0.2 to 0.8; the last is 0. The
    reward is 1 minus the error divided by 1 m, at least 0. A contact above 0.1 m/s, or a fault of the robot, costs 10
    and ends the episode.
    """

    _task = _tasks.STOP_AT_WALL


class FollowWallEnv(RumboEnv):
    """``rumbo/FollowWall-v0``: drive along the wall on the left at a distance from it, for 20 s.

    The second last number of an observation is the distance [m] from the pair of sonars to the wall, 0.3 to 0.6; the
    last is 0. The reward is the forward speed divided by 0.3 m/s, 0 to 1, times 1 minus the error divided by 0.5 m, at
    least 0. A contact above 0.1 m/s, or a fault of the robot, costs 10 and ends the episode.
    """

    _task = _tasks.FOLLOW_WALL


class GoalEnv(RumboEnv):
    """``rumbo/Goal-v0``: reach a goal among one to three groups of boxes, other ones in each episode, within 60 s.

    The last two numbers of an observation are the goal as seen from the robot by its odometry: ahead, to the left [m].
    The reward is how much nearer the robot came to it [m]. At less than 0.1 m it has arrived: 10, and the end. A
    contact above 0.1 m/s, or a fault of the robot, costs 10 and ends the episode.
    """

    _task = _tasks.GOAL
