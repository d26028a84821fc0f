"""What the tasks of `rumbo.envs` are worth: returns of standing still, of chance, and of a controller of a few lines.

    python python/benches/baselines.py             # 100 episodes of each
    python python/benches/baselines.py 200000      # and proximal policy optimisation, after so many decisions

The second needs Stable-Baselines3: its `PPO` as it is, with `VecNormalize` and without. docs/python.md has the figures.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

import rumbo
import rumbo.envs  # makes the environments known

Floats = NDArray[Any]
Choose = Callable[[Floats], Floats]

TASKS = ("WheelSpeed", "WheelPwm", "DriveSquare", "StopAtWall", "FollowWall", "Goal")
EPISODES = 100
#: Seeds of episodes that learning does not see.
UNSEEN = 1_000_000
#: Robots beside each other while learning.
ROBOTS = 16


def still(seen: Floats) -> Floats:
    """Nothing."""
    return np.zeros((len(seen), 3), np.float32)


def chance(seed: int = 1) -> Choose:
    """Each action drawn by itself."""
    draw = np.random.default_rng(seed)
    return lambda seen: draw.uniform(-1, 1, (len(seen), 3)).astype(np.float32)


def controller(task: str) -> Choose:
    """What a person writes down first."""

    def choose(seen: Floats) -> Floats:
        actions = np.zeros((len(seen), 3), np.float32)
        actions[:, 0], actions[:, 1] = _wheels(task, seen)
        return actions

    return choose


def _wheels(task: str, seen: Floats) -> tuple[Floats, Floats]:
    left, right, first, second = seen[:, 0], seen[:, 1], seen[:, -2], seen[:, -1]
    range_left, range_right, range_front = (seen[:, rumbo.OBSERVED.index(f"range_{side}_m")] for side in SIDES)
    if task == "WheelSpeed":
        return first / 12, second / 12
    if task == "WheelPwm":
        # What stiction takes, what the motor turns by, and a share of the error.
        feed = [0.2 * np.sign(aim) + 0.02 * aim + 0.05 * (aim - now) for aim, now in ((first, left), (second, right))]
        return feed[0], feed[1]
    if task == "StopAtWall":
        speed = np.clip(3 * (range_front - first), -0.5, 0.5)
        return speed, speed
    if task == "FollowWall":
        off, slope = 0.5 * (range_left + range_right) - first, range_left - range_right
        turn = np.clip(0.8 * off + 1.5 * slope, -0.3, 0.3)
        return 0.75 - turn, 0.75 + turn
    # A point to be driven to: ahead, left. By PWM or by speeds, the share is about the same.
    turn = np.clip(np.arctan2(second, first), -1, 1) * 0.25
    return 0.4 - turn, 0.4 + turn


SIDES = ("left", "right", "front")


def returns(task: str, choose: Choose, episodes: int = EPISODES) -> tuple[float, float]:
    """The mean return of so many episodes that learning does not see, and the share that end by success."""
    vector: Any = gymnasium.make_vec(f"rumbo/{task}-v0", num_envs=episodes, autoreset_mode="Disabled")
    seen, _ = vector.reset(seed=UNSEEN)
    core, over, done_well = vector.unwrapped._core, np.zeros(episodes, bool), np.zeros(episodes, bool)
    earned = np.zeros(episodes)
    while not over.all():
        # Those that are over stand still in time.
        step = core.step(choose(seen), ~over)
        earned += np.where(over, 0.0, step.reward)
        done_well |= ~over & step.terminated & (step.reward > 0)
        over |= step.terminated | step.truncated
        seen = core.known()
    vector.close()
    return float(earned.mean()), float(done_well.mean())


def learned(task: str, decisions: int, normalized: bool) -> Choose:
    """By proximal policy optimisation, with its own settings but for 16 robots."""
    import torch
    from stable_baselines3 import PPO
    from stable_baselines3.common.env_util import make_vec_env
    from stable_baselines3.common.vec_env import VecNormalize

    torch.set_num_threads(1)
    envs: Any = make_vec_env(f"rumbo/{task}-v0", n_envs=ROBOTS, seed=1)
    if normalized:
        envs = VecNormalize(envs)
    model = PPO("MlpPolicy", envs, n_steps=128, batch_size=256, seed=1, device="cpu")
    model.learn(decisions)
    scaled: Any = envs.normalize_obs if normalized else lambda seen: seen
    return lambda seen: np.asarray(model.predict(scaled(seen), deterministic=True)[0])


def main() -> None:
    """Prints a row for each task."""
    decisions = int(sys.argv[1]) if len(sys.argv) > 1 else 0
    tasks = sys.argv[2:] or TASKS
    for task in tasks:
        policies: dict[str, Choose] = {"still": still, "chance": chance(), "controller": controller(task)}
        if decisions:
            policies |= {f"PPO {name}": learned(task, decisions, name == "scaled") for name in ("as it is", "scaled")}
        if task == "Goal":
            policies["policy `goal`"] = rumbo.Policy("goal")
        cells = []
        for name, choose in policies.items():
            earned, well = returns(task, choose)
            cells.append(f"{name} {earned:.1f}" + (f" ({well:.0%})" if well else ""))
        print(f"{task}: " + ", ".join(cells), flush=True)


if __name__ == "__main__":
    main()
