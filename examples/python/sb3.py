# %% [markdown]
# # Stopping before a wall, learned with Stable-Baselines3
#
# `rumbo/StopAtWall-v0` by the proximal policy optimisation of
# [Stable-Baselines3](https://stable-baselines3.readthedocs.io): each episode another robot, and another distance from
# the wall at which it should stand. Rumbo's environments are those of Gymnasium, so nothing here is Rumbo's own but the
# name of the environment, the seeds, and a log of one episode.
#
# Each `# %%` is a cell: Visual Studio Code, Spyder, PyCharm and Jupytext open this file as a notebook. It needs
# `pip install ".[gym]" stable-baselines3`, which brings PyTorch, 5 GB with all that it needs on Linux.

# %%
import gymnasium
import numpy as np
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.env_util import make_vec_env
from stable_baselines3.common.vec_env import VecNormalize

import rumbo.envs

DECISIONS, ROBOTS = 200_000, 100
# Seeds of episodes that learning does not see.
UNSEEN = 1_000_000

# %% [markdown]
# Sixteen robots beside each other, for half a minute. Observations are in metres, radians and seconds: `VecNormalize`
# scales them.

# %%
torch.set_num_threads(1)
envs = VecNormalize(make_vec_env("rumbo/StopAtWall-v0", n_envs=16, seed=1), gamma=0.98)
model = PPO("MlpPolicy", envs, n_steps=128, batch_size=512, gamma=0.98, seed=1, device="cpu")
model.learn(DECISIONS)

# %% [markdown]
# How far each of them stands from where it should, at the end of an episode of 10 s. The first episode is written as a
# log: `rumbo replay logs/rumbo-episode-0.mcap` shows it on the dashboard.

# %%
envs.training = False
env = rumbo.envs.RecordLog(
    gymnasium.make("rumbo/StopAtWall-v0"), "logs", episode_trigger=lambda number: number == 0, overwrite=True
)


def missed(seed: int) -> float:
    """Distance from the place where the robot of an episode should stand at its end [m]; infinite after a crash."""
    observation, info = env.reset(seed=seed)
    while True:
        action, _ = model.predict(envs.normalize_obs(observation), deterministic=True)
        observation, _, crashed, timeout, info = env.step(action)
        if crashed:
            return np.inf
        if timeout:
            return abs(info["range_front_m"] - observation[-2])


missed_m = np.array([missed(seed) for seed in range(UNSEEN, UNSEEN + ROBOTS)])
half_m, near = np.median(missed_m), np.mean(missed_m < 0.05)
print(f"{ROBOTS} unseen robots: half within {1e2 * half_m:.1f} cm, {near:.0%} within 5 cm")
assert near >= 0.9
