"""Stable-Baselines3, where it is installed: `cargo xtask campaign --only python`."""

from __future__ import annotations

import warnings

import gymnasium
import pytest

import rumbo.envs  # noqa: F401  # makes the environments known

pytest.importorskip("stable_baselines3", reason="Stable-Baselines3 is not installed")

from stable_baselines3.common.env_checker import check_env


@pytest.mark.parametrize("name", ["WheelSpeed", "StopAtWall", "FollowWall", "Goal"])
def test_its_checker_passes(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make(f"rumbo/{name}-v0", render_mode="rgb_array").unwrapped)
