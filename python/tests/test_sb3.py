"""Stable-Baselines3, where it is installed: `cargo xtask campaign --only python`."""

from __future__ import annotations

import warnings

import gymnasium
import pytest

import rumbo
from rumbo.envs import _tasks

pytest.importorskip("stable_baselines3", reason="Stable-Baselines3 is not installed")

from stable_baselines3.common.env_checker import check_env


@pytest.mark.parametrize("name", [*_tasks.ALL])
def test_its_checker_passes(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make(f"rumbo/{name}-v0", render_mode="rgb_array").unwrapped)


@pytest.mark.filterwarnings("ignore")
def test_several_robots_in_one_world_learn_together_through_supersuit() -> None:
    supersuit = pytest.importorskip("supersuit", reason="SuperSuit is not installed")
    from stable_baselines3 import PPO

    from rumbo.envs.fleet import FleetGoalEnv

    vector = supersuit.pettingzoo_env_to_vec_env_v1(supersuit.black_death_v3(FleetGoalEnv(robots=3)))
    vector = supersuit.concat_vec_envs_v1(vector, 2, base_class="stable_baselines3")
    assert vector.num_envs == 6
    PPO("MlpPolicy", vector, n_steps=16, batch_size=32, device="cpu").learn(200)


def test_a_network_with_its_default_activation_does_not_reach_the_robot() -> None:
    from stable_baselines3 import PPO

    model = PPO("MlpPolicy", gymnasium.make("rumbo/Goal-v0"), n_steps=16, batch_size=16, device="cpu")
    layers = [layer for layer in (*model.policy.mlp_extractor.policy_net, model.policy.action_net)]
    network = {
        "activation": type(layers[1]).__name__.lower(),
        "inputs": [{"of": name, "centre": 0.0, "scale": 1.0} for name in rumbo.OBSERVED],
        "layers": [
            {"weights": layer.weight.detach().numpy(), "biases": layer.bias.detach().numpy()}
            for layer in layers
            if hasattr(layer, "weight")
        ],
    }
    with pytest.raises(ValueError, match='activation = "tanh"'):
        rumbo.export_policy(network)
    with pytest.raises(ValueError, match="neurons of layer 1: there are 64, must be 1 to 32"):
        rumbo.export_policy(network | {"activation": "clip"})
