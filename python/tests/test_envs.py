"""Environments for Gymnasium."""

from __future__ import annotations

import os
import warnings
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode

import rumbo.envs

NAMES = ["WheelSpeed", "StopAtWall", "FollowWall", "Goal"]


def make(name: str, **settings: Any) -> gymnasium.Env[Any, Any]:
    return gymnasium.make(f"rumbo/{name}-v0", **settings)


def make_vec(name: str, count: int, **settings: Any) -> Any:
    return gymnasium.make_vec(f"rumbo/{name}-v0", num_envs=count, **settings)


def actions(seed: int, steps: int, count: int) -> np.ndarray[Any, Any]:
    return np.random.default_rng(seed).uniform(-1, 1, (steps, count, 3)).astype(np.float32)


@pytest.mark.parametrize("name", NAMES)
def test_gymnasium_s_checker_passes(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(make(name, render_mode="rgb_array").unwrapped)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("threads", [1, 2])
def test_an_episode_is_the_same_alone_and_in_a_vector(name: str, threads: int) -> None:
    count, steps = 5, 70
    given = actions(1, steps, count)
    vector = make_vec(name, count, threads=threads)
    seen, infos = vector.reset(seed=40)
    rows = [(seen, np.zeros(count), np.zeros(count, bool), np.zeros(count, bool), infos)]
    rows += [vector.step(given[step]) for step in range(steps)]
    for index in range(count):
        alone = make(name).unwrapped
        begun: Any = alone.reset(seed=40 + index)
        row: tuple[Any, ...] = (begun[0], 0.0, False, False, begun[1])
        for step in range(steps + 1):
            together = rows[step]
            assert np.array_equal(row[0], together[0][index]), (index, step)
            assert tuple(row[1:4]) == tuple(column[index] for column in together[1:4]), (index, step)
            for key, value in row[4].items():
                assert value == together[4][key][index], (index, step, key)
            if step == steps:
                break
            if row[2] or row[3]:
                # As the vector does in its next step.
                begun = alone.reset()
                row = (begun[0], 0.0, False, False, begun[1])
            else:
                row = alone.step(given[step, index])


def test_the_vector_is_gymnasium_s_own_vector_of_single_environments() -> None:
    for mode in (AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP):
        ours = make_vec("WheelSpeed", 3, autoreset_mode=mode)
        theirs = gymnasium.vector.SyncVectorEnv(
            [lambda: gymnasium.make("rumbo/WheelSpeed-v0") for _ in range(3)], autoreset_mode=mode
        )
        assert ours.metadata["autoreset_mode"] is mode
        assert ours.action_space == theirs.action_space and ours.observation_space == theirs.observation_space
        assert np.array_equal(ours.reset(seed=3)[0], theirs.reset(seed=3)[0])
        for step, given in enumerate(actions(2, 120, 3)):
            one, other = ours.step(given), theirs.step(given)
            for a, b in zip(one[:4], other[:4]):
                assert np.array_equal(a, b), step
            assert one[4].keys() == other[4].keys()
            for key in one[4]:
                if key == "final_obs":
                    assert all(np.array_equal(a, b) for a, b in zip(one[4][key], other[4][key]))
                elif key != "final_info":
                    assert np.array_equal(one[4][key], other[4][key]), key
            if "final_info" in one[4]:
                mask = one[4]["_final_info"]
                assert np.array_equal(one[4]["final_info"]["x_m"][mask], other[4]["final_info"]["x_m"][mask])


def test_without_autoreset_the_caller_resets_by_a_mask() -> None:
    vector = make_vec("WheelSpeed", 3, autoreset_mode=AutoresetMode.DISABLED)
    vector.reset(seed=1)
    for _ in range(50):
        _, _, _, truncated, _ = vector.step(np.zeros((3, 3), np.float32))
    assert truncated.all()
    with pytest.raises(gymnasium.error.ResetNeeded, match="environment 0"):
        vector.step(np.zeros((3, 3), np.float32))
    mask = np.array([True, True, True])
    _, before = vector.reset(options={"reset_mask": mask})
    _, after = vector.reset(options={"reset_mask": np.array([False, True, False])})
    assert (before["seed"] != after["seed"]).tolist() == [False, True, False]
    assert after["_seed"].tolist() == [False, True, False]
    vector.step(np.zeros((3, 3), np.float32))
    for wrong, error in [(np.array([True]), ValueError), ([True] * 3, TypeError), (np.zeros(3, bool), ValueError)]:
        with pytest.raises(error):
            vector.reset(options={"reset_mask": wrong})


def test_seeds_draw_robots_and_tasks_and_can_be_asked_not_to_draw_robots() -> None:
    env = make("WheelSpeed")
    first, _ = env.reset(seed=8)
    other, _ = env.reset(seed=9)
    again, info = env.reset(seed=8)
    assert np.array_equal(first, again) and not np.array_equal(first, other) and info["seed"] == 8
    following = [env.reset()[1]["seed"] for _ in range(3)]
    assert len({8, *following}) == 4
    env.reset(seed=8)
    assert [env.reset()[1]["seed"] for _ in range(3)] == following
    ends = []
    for randomize in (True, False):
        vector = make_vec("WheelSpeed", 4, randomize=randomize)
        vector.reset(seed=1)
        for _ in range(30):
            infos = vector.step(np.tile(np.array([0.5, 0.5, 0], np.float32), (4, 1)))[4]
        ends.append(np.std(infos["x_m"]))
    assert ends[0] > 3 * ends[1]


def test_observations_hold_what_the_robot_knows_and_no_more() -> None:
    env = make("Goal").unwrapped
    seen, info = env.reset(seed=3)
    columns = dict(zip(rumbo.OBSERVED, seen))
    assert columns["x_m"] == columns["y_m"] == 0 and 0 < columns["range_front_m"] <= rumbo.REACH_M
    assert columns["age_front_s"] < 0.3
    distance = np.hypot(columns["goal_ahead_m"], columns["goal_left_m"])
    assert abs(distance - np.hypot(info["goal_x_m"], info["goal_y_m"])) < 1e-5
    for _ in range(40):
        seen, _, over, _, info = env.step(np.array([0.3, 0.35, 0.2], np.float32))
        if over:
            break
    # Odometry errs: the estimate is near the truth and not the truth.
    assert 0 < abs(seen[9] - info["x_m"]) < 0.1
    assert "goal_x_m" not in make("StopAtWall").reset(seed=1)[1]


def test_a_simple_controller_reaches_most_goals() -> None:
    count = 20
    vector = make_vec("Goal", count, world=OPEN)
    seen, _ = vector.reset(seed=100)
    done, reached = np.zeros(count, bool), np.zeros(count, bool)
    for _ in range(600):
        ahead, left = seen[:, 12], seen[:, 13]
        turn = np.clip(np.arctan2(left, ahead), -1, 1) * 0.25
        given = np.stack([0.4 - turn, 0.4 + turn, 0 * turn], axis=1).astype(np.float32)
        seen, reward, terminated, truncated, _ = vector.step(given)
        reached |= terminated & (reward > 5) & ~done
        done |= terminated | truncated
        if done.all():
            break
    assert reached.sum() >= 17


OPEN = {
    "title": "A goal on an open floor",
    "arena": {"from_m": [-1.0, -2.1], "to_m": [4.4, 2.1], "walled": True},
    "random": {"groups": [0, 0], "goal_away_m": [1.0, 1.5], "unreachable": 0.0, "blocked": 0.0},
}


@pytest.mark.parametrize("name", ["WheelSpeed", "StopAtWall", "FollowWall"])
def test_no_early_end_is_worth_having(name: str) -> None:
    vector = make_vec(name, 20)
    vector.reset(seed=1)
    for given in actions(3, 150, 20):
        _, rewards, terminated, _, _ = vector.step(3 * given)
        assert np.all((rewards >= 0) & (rewards <= 1) | terminated)


def test_driving_into_the_wall_ends_the_episode() -> None:
    env = make("StopAtWall").unwrapped
    env.reset(seed=1)
    for _ in range(100):
        _, reward, terminated, truncated, info = env.step(np.array([0.8, 0.8, 0], np.float32))
        if terminated:
            break
    assert terminated and not truncated and reward < -9 and info["contacts"] >= 1
    with pytest.raises(gymnasium.error.ResetNeeded, match="over"):
        env.step(np.zeros(3, np.float32))


def test_a_frame_shows_the_world_from_above() -> None:
    env = make("Goal", render_mode="rgb_array")
    env.reset(seed=4)
    frame: Any = env.render()
    assert frame.shape == (256, 256, 3) and frame.dtype == np.uint8
    colours = {tuple(colour) for colour in frame.reshape(-1, 3)}
    assert len(colours) == 4, "floor, obstacles, robot, goal"
    vector = make_vec("Goal", 2, render_mode="rgb_array")
    vector.reset(seed=4)
    frames = vector.render()
    assert len(frames) == 2 and np.array_equal(frames[0], frame)
    assert make("Goal").unwrapped.render() is None
    with pytest.raises(ValueError, match="render_mode"):
        rumbo.envs.GoalEnv(render_mode="human")


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (np.zeros((2, 3), np.float32), "shape"),
        (np.zeros((3, 2), np.float32), "shape"),
        (np.where(np.arange(9).reshape(3, 3) == 5, np.nan, 0.0), r"action\[1, 2\]"),
    ],
)
def test_wrong_actions_are_refused_with_their_index(given: Any, words: str) -> None:
    vector = make_vec("WheelSpeed", 3)
    vector.reset(seed=1)
    with pytest.raises(ValueError, match=words):
        vector.step(given)
    single = make("WheelSpeed").unwrapped
    single.reset(seed=1)
    with pytest.raises(ValueError, match="shape"):
        single.step(np.zeros(2, np.float32))
    with pytest.raises(ValueError, match=r"action\[0, 1\]"):
        single.step(np.array([0, np.nan, 0], np.float32))


def test_actions_out_of_range_are_clipped() -> None:
    ends = []
    for most in (1.0, 5.0, np.inf):
        env = make("WheelSpeed").unwrapped
        env.reset(seed=1)
        ends.append([env.step(np.full(3, most, np.float32))[0] for _ in range(5)][-1])
    assert np.array_equal(ends[0], ends[1]) and np.array_equal(ends[0], ends[2])


def test_use_after_close_says_so() -> None:
    single, vector = rumbo.envs.GoalEnv(render_mode="rgb_array"), rumbo.envs.GoalVectorEnv(2)
    for env in (single, vector):
        env.reset(seed=1)
        env.close()
        for use in (lambda env=env: env.reset(), lambda env=env: env.step(np.zeros(env.action_space.shape))):
            with pytest.raises(gymnasium.error.ClosedEnvironmentError, match="closed"):
                use()
    with pytest.raises(gymnasium.error.ClosedEnvironmentError):
        single.render()


def test_a_step_before_the_first_reset_says_so() -> None:
    with pytest.raises(gymnasium.error.ResetNeeded):
        rumbo.envs.GoalEnv().step(np.zeros(3, np.float32))
    with pytest.raises(gymnasium.error.ResetNeeded):
        rumbo.envs.GoalVectorEnv(2).step(np.zeros((2, 3), np.float32))


def test_wrong_settings_are_named() -> None:
    with pytest.raises(ValueError, match="num_envs"):
        rumbo.envs.GoalVectorEnv(0)
    with pytest.raises(ValueError, match="front_kp"):
        rumbo.envs.StopAtWallEnv(parameters={"front_kpp": 1}).reset(seed=1)
    with pytest.raises(ValueError, match="seed = -1"):
        rumbo.envs.StopAtWallVectorEnv(2).reset(seed=[1, -1])
    with pytest.raises(ValueError, match="below 2"):
        rumbo.envs.StopAtWallVectorEnv(1).reset(seed=2**63)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no forks here")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_single_environments_work_in_a_fork() -> None:
    vector = rumbo.envs.WheelSpeedVectorEnv(2, threads=2)
    vector.reset(seed=1)
    child = os.fork()
    if child == 0:
        env = rumbo.envs.WheelSpeedEnv()
        env.reset(seed=1)
        try:
            vector.step(np.zeros((2, 3), np.float32))
        except RuntimeError:
            os._exit(0)
        os._exit(1)
    assert os.waitpid(child, 0)[1] == 0
