"""Episodes as logs."""

from __future__ import annotations

import os
import pathlib
from collections.abc import Callable
from typing import Any, SupportsFloat

import gymnasium
import numpy as np
from numpy.typing import NDArray

from .._log import is_there
from ._env import RumboEnv

_Array = NDArray[np.float32]


class RecordLog(gymnasium.Wrapper[_Array, _Array, _Array, _Array], gymnasium.utils.RecordConstructorArgs):
    """Writes episodes as logs: ``rumbo replay`` shows them on the dashboard, `rumbo.read_log` reads them.

    >>> env = rumbo.envs.RecordLog(gymnasium.make("rumbo/Goal-v0"), "logs", episode_trigger=lambda n: n % 100 == 0)

    As with Gymnasium's ``RecordVideo``, an episode is written when it ends, or when the next reset or `close` cuts it
    short. What is recorded is bit for bit the episode without it. A log begins with the robot's start, 0.5 s before the
    first action; its times [s] are those of ``info["t_s"]``.

    Args:
        env: A single environment of Rumbo, wrapped or not.
        folder: Where the logs go; made if it is not there.
        episode_trigger: Whether to write the episode of a number, counted from 0. By default, cubes up to 1000, then
            every 1000th, as ``RecordVideo`` has it.
        name_prefix: The log of episode 8 is ``<name_prefix>-episode-8.mcap``.
        overwrite: Replace files that are there.

    Raises:
        TypeError: The environment is none of Rumbo's single ones.
        FileExistsError: A reset begins an episode whose log is there already.
        OSError: The folder cannot be made, or a log not be written.
    """

    def __init__(
        self,
        env: gymnasium.Env[_Array, _Array],
        folder: str | os.PathLike[str],
        episode_trigger: Callable[[int], bool] | None = None,
        *,
        name_prefix: str = "rumbo",
        overwrite: bool = False,
    ) -> None:
        gymnasium.utils.RecordConstructorArgs.__init__(
            self, folder=folder, episode_trigger=episode_trigger, name_prefix=name_prefix, overwrite=overwrite
        )
        own = env.unwrapped
        if not isinstance(own, RumboEnv):
            raise TypeError(f"{type(own).__name__}: RecordLog writes the episodes of Rumbo's single environments")
        super().__init__(env)
        self._own = own
        self._folder = pathlib.Path(folder)
        self._folder.mkdir(parents=True, exist_ok=True)
        self._trigger = _is_cube if episode_trigger is None else episode_trigger
        self._name_prefix = name_prefix
        self._overwrite = overwrite
        #: Episodes begun, and where the present one is to be written.
        self._begun = 0
        self._path: pathlib.Path | None = None

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[_Array, dict[str, Any]]:
        """Begins the next episode, after writing one that it cuts short."""
        self._write()
        path = None
        if self._trigger(self._begun):
            path = self._folder / f"{self._name_prefix}-episode-{self._begun}.mcap"
            if path.exists() and not self._overwrite:
                raise is_there(path)
        self._own.record(path is not None)
        begun = self.env.reset(seed=seed, options=options)
        self._path = path
        self._begun += 1
        return begun

    def step(self, action: _Array) -> tuple[_Array, SupportsFloat, bool, bool, dict[str, Any]]:
        """Acts, and writes the episode if that ends it."""
        done = self.env.step(action)
        if done[2] or done[3]:
            self._write()
        return done

    def close(self) -> None:
        """Lets go of the robot, after writing the episode that this cuts short."""
        self._write()
        super().close()

    def _write(self) -> None:
        path, self._path = self._path, None
        if path is not None:
            self._own.write_log(path, overwrite=self._overwrite)


def _is_cube(episode: int) -> bool:
    """Often at first, more rarely later."""
    return bool(round(episode ** (1 / 3)) ** 3 == episode) if episode < 1000 else episode % 1000 == 0
