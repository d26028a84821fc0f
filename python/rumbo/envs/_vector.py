"""Vector environments: all robots in one batch."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from gymnasium import error
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from .._setup import Parameters, Source
from . import _tasks
from ._core import Core, EnvSnapshot, Settings, action_space, observation_names, observation_space
from ._env import check_render_mode

Observations = NDArray[np.float32]


class RumboVectorEnv(VectorEnv[Observations, NDArray[np.float32], NDArray[Any]]):
    """Many robots with the same task, stepped together; each is bit for bit as in `RumboEnv`.

    Args:
        num_envs: How many.
        robot, world, parameters, randomize, render_mode: As for `RumboEnv`.
        threads: One on each core by default.
        autoreset_mode: What happens at the end of an episode, by Gymnasium's three modes. ``NEXT_STEP`` resets in the
            next step, ``SAME_STEP`` in the same one (``final_obs`` and ``final_info`` in the infos), ``DISABLED`` when
            ``reset(options={"reset_mask": mask})`` is called.
        max_episode_steps: Actions before an episode is truncated; those of the task by default, -1 for no end.

    Raises:
        ValueError, ClosedEnvironmentError, ResetNeeded: As `RumboEnv`.
        RuntimeError: In a process that was forked after threads were used.
    """

    _task: ClassVar[_tasks.Task]

    def __init__(
        self,
        num_envs: int = 1,
        *,
        robot: Source | None = None,
        world: Source | None = None,
        parameters: Parameters | None = None,
        randomize: bool | None = None,
        threads: int | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        render_mode: str | None = None,
        max_episode_steps: int | None = None,
    ) -> None:
        check_render_mode(render_mode)
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        self.metadata = {
            "render_modes": ["rgb_array"],
            "render_fps": 10,
            "autoreset_mode": self.autoreset_mode,
        }
        self.render_mode = render_mode
        self.num_envs = num_envs
        self.single_observation_space = observation_space()
        self.single_action_space = action_space()
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        #: The names of the numbers of an observation.
        self.observation_names: tuple[str, ...] = observation_names(self._task)
        settings = Settings(robot, world, parameters, randomize, threads, max_episode_steps)
        self._core = Core(self._task, settings, num_envs)
        self._over = np.zeros(num_envs, np.bool_)

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Observations, dict[str, Any]]:
        """Begins episodes: of `seed` + i, or of a list of seeds, in the i-th; the next ones where it is ``None``.

        ``options={"reset_mask": mask}`` begins those of which the mask is true, and leaves the others alone.
        """
        self._core.check_open()
        mask = np.ones(self.num_envs, np.bool_)
        if options is not None and "reset_mask" in options:
            mask = self._checked_mask(options["reset_mask"])
        if not self._core.is_seeded and not mask.all():
            raise error.ResetNeeded("the first reset() begins all environments")
        bases = self._bases(seed)
        chosen = np.flatnonzero(mask).tolist()
        self._core.begin(chosen, [bases[index] for index in chosen])
        self._over[mask] = False
        return self._core.known(), self._core.infos(mask)

    def _bases(self, seed: int | Sequence[int | None] | None) -> list[int | None]:
        if seed is None or isinstance(seed, (int, np.integer)):
            if seed is not None:
                # As in a single environment: the source of what is drawn without a seed.
                super().reset(seed=int(seed))
                return [int(seed) + index for index in range(self.num_envs)]
            if self._core.is_seeded:
                return [None] * self.num_envs
            return [int(drawn) for drawn in self.np_random.integers(2**63, size=self.num_envs)]
        if len(seed) != self.num_envs:
            raise ValueError(f"{len(seed)} seeds for {self.num_envs} environments")
        drawn = self.np_random.integers(2**63, size=self.num_envs)
        needed = not self._core.is_seeded
        return [int(drawn[index]) if base is None and needed else base for index, base in enumerate(seed)]

    def _checked_mask(self, mask: Any) -> NDArray[np.bool_]:
        if not isinstance(mask, np.ndarray) or mask.dtype != np.bool_:
            raise TypeError("reset_mask must be a NumPy array of bool")
        if mask.shape != (self.num_envs,):
            raise ValueError(f"reset_mask has the shape {mask.shape}: must be ({self.num_envs},)")
        if not mask.any():
            raise ValueError("reset_mask is false everywhere: nothing to reset")
        return mask

    def step(
        self, actions: NDArray[np.float32]
    ) -> tuple[Observations, NDArray[Any], NDArray[Any], NDArray[Any], dict[str, Any]]:
        """Acts for 0.1 s in every environment."""
        ended = self._over
        if ended.any() and self.autoreset_mode is not AutoresetMode.NEXT_STEP:
            index = int(np.flatnonzero(ended)[0])
            raise error.ResetNeeded(f"the episode of environment {index} is over; reset it by a reset_mask")
        done = self._core.step(actions, ~ended)
        # Those that had ended begin their next episode, and do nothing else in this step.
        reward = np.where(ended, 0.0, done.reward)
        terminated, truncated = done.terminated & ~ended, done.truncated & ~ended
        over = terminated | truncated
        infos: dict[str, Any] = {}
        if self.autoreset_mode is AutoresetMode.SAME_STEP and over.any():
            infos = self._final(done.known, over)
            self._begin_next(over)
            self._over = np.zeros(self.num_envs, np.bool_)
        else:
            if ended.any():
                self._begin_next(ended)
            self._over = over
        infos.update(self._core.infos())
        return self._core.known(), reward, terminated, truncated, infos

    def _begin_next(self, mask: NDArray[np.bool_]) -> None:
        chosen = np.flatnonzero(mask).tolist()
        self._core.begin(chosen, [None] * len(chosen))

    def _final(self, known: Observations, over: NDArray[np.bool_]) -> dict[str, Any]:
        """The last observations and infos of episodes that ended."""
        final = np.full(self.num_envs, None, dtype=object)
        for index in np.flatnonzero(over):
            final[index] = known[index].copy()
        return {
            "final_obs": final,
            "_final_obs": over.copy(),
            "final_info": self._core.infos(over),
            "_final_info": over.copy(),
        }

    def snapshot(self) -> EnvSnapshot:
        """All episodes as they are now: `restore` puts them back, any number of times, and it can be pickled."""
        return self._core.snapshot({"_over": self._over})

    def restore(self, snapshot: EnvSnapshot) -> tuple[Observations, dict[str, Any]]:
        """Puts the environments back to a snapshot of as many of the same task; gives observations and infos of then.

        Raises:
            ValueError: The snapshot is of another task, or of another number.
        """
        self._over = self._core.restore(snapshot)["_over"]
        return self._core.known(), self._core.infos()

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """The worlds from above; ``None`` without a render mode."""
        if self.render_mode is None:
            return None
        return tuple(self._core.render(index) for index in range(self.num_envs))

    def close_extras(self, **kwargs: Any) -> None:
        """Lets go of the robots."""
        self._core.close()


class WheelSpeedVectorEnv(RumboVectorEnv):
    """Many of `WheelSpeedEnv`."""

    _task = _tasks.WHEEL_SPEED


class WheelPwmVectorEnv(RumboVectorEnv):
    """Many of `WheelPwmEnv`."""

    _task = _tasks.WHEEL_PWM


class DriveSquareVectorEnv(RumboVectorEnv):
    """Many of `DriveSquareEnv`."""

    _task = _tasks.DRIVE_SQUARE


class StopAtWallVectorEnv(RumboVectorEnv):
    """Many of `StopAtWallEnv`."""

    _task = _tasks.STOP_AT_WALL


class FollowWallVectorEnv(RumboVectorEnv):
    """Many of `FollowWallEnv`."""

    _task = _tasks.FOLLOW_WALL


class GoalVectorEnv(RumboVectorEnv):
    """Many of `GoalEnv`."""

    _task = _tasks.GOAL
