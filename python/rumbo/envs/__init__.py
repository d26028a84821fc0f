"""Environments for Gymnasium: ``import rumbo.envs`` makes them known.

    import gymnasium
    import rumbo.envs
    env = gymnasium.make("rumbo/Goal-v0")
    envs = gymnasium.make_vec("rumbo/Goal-v0", num_envs=4096)

Every environment has the same spaces. An action, ten times a second, is three numbers from -1 to 1: the setpoints of
the left and the right wheel (1 is 12 rad/s) and where the servo points (1 is a quarter turn to the left); what is out
of range is clipped. The robot's own control core drives the wheels to them; in ``WheelPwm`` and ``DriveSquare`` nobody
does: wheels get shares of the full PWM. An observation is what the robot's program knows, by the names of
`rumbo.OBSERVED`, its last two numbers being the task's: ``observation_names`` has all, and see each environment. Ground
truth is in ``info``, by the names of `rumbo.TRUE`, never in an observation.

Each episode has a seed, in ``info["seed"]``: it draws the robot from the spread in its file, the world, the task and
all noise. ``reset(seed=s)`` begins the episode of seed s (of s + i in the i-th of a vector); those after it follow from
s. An episode is bit for bit the same alone, in a vector, and on any number of threads.

`RecordLog` writes episodes of a single environment as logs, which the dashboard replays.
"""

# The packages are looked for before they are imported.
# ruff: noqa: E402
from __future__ import annotations

from .._extras import need

need("rumbo.envs", "gymnasium", "gym", (1, 1))

import gymnasium

from . import _tasks
from ._core import EnvSnapshot
from ._env import (
    DriveSquareEnv,
    FollowWallEnv,
    GoalEnv,
    RumboEnv,
    StopAtWallEnv,
    WheelPwmEnv,
    WheelSpeedEnv,
)
from ._record import RecordLog
from ._vector import (
    DriveSquareVectorEnv,
    FollowWallVectorEnv,
    GoalVectorEnv,
    RumboVectorEnv,
    StopAtWallVectorEnv,
    WheelPwmVectorEnv,
    WheelSpeedVectorEnv,
)

__all__ = [
    "DriveSquareEnv",
    "DriveSquareVectorEnv",
    "EnvSnapshot",
    "FollowWallEnv",
    "FollowWallVectorEnv",
    "GoalEnv",
    "GoalVectorEnv",
    "RecordLog",
    "RumboEnv",
    "RumboVectorEnv",
    "StopAtWallEnv",
    "StopAtWallVectorEnv",
    "WheelPwmEnv",
    "WheelPwmVectorEnv",
    "WheelSpeedEnv",
    "WheelSpeedVectorEnv",
]

for _name, _task in _tasks.ALL.items():
    if f"rumbo/{_name}-v0" not in gymnasium.registry:
        gymnasium.register(
            id=f"rumbo/{_name}-v0",
            entry_point=f"rumbo.envs:{_name}Env",
            vector_entry_point=f"rumbo.envs:{_name}VectorEnv",
            max_episode_steps=_task.steps,
        )
