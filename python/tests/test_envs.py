"""Environments for Gymnasium."""

from __future__ import annotations

import copy
import importlib.util
import os
import pathlib
import pickle
import subprocess
import sys
import warnings
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode

import rumbo.envs
from rumbo.envs import _tasks

NAMES = ["WheelSpeed", "WheelPwm", "DriveSquare", "StopAtWall", "FollowWall", "Goal"]


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
        alone = getattr(rumbo.envs, f"{name}Env")()
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
    assert len(set(before["seed"])) == 3
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


def actions_taken(env: Any) -> int:
    """How many actions an episode has that nothing else ends."""
    env.reset(seed=3)
    still = np.zeros(env.action_space.shape, np.float32)
    for step in range(1, 2_000):
        _, _, terminated, truncated, _ = env.step(still)
        assert not np.any(terminated)
        if np.all(truncated):
            return step
    return 0


def test_the_number_of_actions_can_be_chosen_and_is_known() -> None:
    for name in NAMES:
        spec = gymnasium.spec(f"rumbo/{name}-v0")
        assert spec.max_episode_steps == _tasks.ALL[name].steps
    for given, taken in [({}, 50), ({"max_episode_steps": 10}, 10), ({"max_episode_steps": 70}, 70)]:
        assert actions_taken(make("WheelSpeed", **given)) == taken
        assert actions_taken(make_vec("WheelSpeed", 2, **given)) == taken
        assert actions_taken(rumbo.envs.WheelSpeedEnv(**given)) == taken
    assert actions_taken(make_vec("WheelSpeed", 2, max_episode_steps=-1)) == 0
    with pytest.raises(ValueError, match="max_episode_steps = 0: must be at least 1"):
        rumbo.envs.WheelSpeedEnv(max_episode_steps=0)
    timed = gymnasium.wrappers.TimeAwareObservation(make("WheelSpeed"))
    timed.reset(seed=1)
    assert timed.step(np.zeros(3, np.float32))[0][-1] == 1


def follow(env: Any, given: Any) -> list[Any]:
    """All that the same actions lead to."""
    return [env.step(one) for one in given]


def alike(one: Any, other: Any) -> bool:
    return bool(gymnasium.utils.env_checker.data_equivalence(one, other, exact=True))


@pytest.mark.parametrize("name", NAMES)
def test_environments_are_pickled_copied_and_put_back_in_the_middle_of_an_episode(name: str) -> None:
    for env, given in [(make(name), actions(4, 12, 1)[:, 0]), (make_vec(name, 3), actions(4, 12, 3))]:
        env.reset(seed=6)
        follow(env, given[:6])
        snapshot = pickle.loads(pickle.dumps(env.unwrapped.snapshot()))
        others = [pickle.loads(pickle.dumps(env)), copy.deepcopy(env)]
        expected = follow(env, given[6:])
        for other in others:
            assert alike(follow(other, given[6:]), expected)
        kind: Any = type(env.unwrapped)
        again = kind(3) if "Vector" in kind.__name__ else kind()
        again.restore(snapshot)
        assert alike(follow(again, given[6:]), expected)
        # And once more, in the one that it is of; a wrapper around it that counts would go on counting.
        env.unwrapped.restore(snapshot)
        assert alike(follow(env.unwrapped, given[6:]), expected)


def test_a_snapshot_of_another_task_or_number_is_refused() -> None:
    one, two = rumbo.envs.WheelSpeedEnv(), rumbo.envs.WheelSpeedVectorEnv(2)
    with pytest.raises(gymnasium.error.ResetNeeded):
        one.snapshot()
    one.reset(seed=1)
    for other in (two, rumbo.envs.GoalEnv()):
        with pytest.raises(ValueError, match="a snapshot of 1 robots of mode5 does not fit"):
            other.restore(one.snapshot())


@pytest.mark.parametrize("name", NAMES)
def test_a_controller_of_a_few_lines_earns_more_than_chance_and_standing_still(name: str) -> None:
    path = pathlib.Path(__file__).parents[1] / "benches/baselines.py"
    spec: Any = importlib.util.spec_from_file_location("baselines", path)
    baselines: Any = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(baselines)
    best = rumbo.Policy("goal") if name == "Goal" else baselines.controller(name)
    earned = [baselines.returns(name, choose, 10)[0] for choose in (best, baselines.still, baselines.chance())]
    assert earned[0] > 5 + max(earned[1:]), earned


def test_the_last_two_numbers_have_the_names_of_their_task() -> None:
    assert make("Goal").unwrapped.observation_names == rumbo.OBSERVED
    names = make_vec("StopAtWall", 2).unwrapped.observation_names
    assert names == (*rumbo.OBSERVED[:12], "target_range_m", "nothing")
    env = make("DriveSquare").unwrapped
    seen, info = env.reset(seed=2)
    assert env.observation_names[12:] == ("corner_ahead_m", "corner_left_m")
    # The first corner is ahead, and where the world has no goal infos have none.
    assert np.allclose(seen[12:], [1, 0], atol=0.01) and "goal_x_m" not in info


def test_without_gymnasium_or_with_an_old_one_the_remedy_is_named() -> None:
    code = """
import importlib, sys, types
for package, version, module in [
    ("gymnasium", None, "rumbo.envs"), ("gymnasium", "1.0.0", "rumbo.envs"), ("gymnasium", "0.29.1", "rumbo.envs"),
    ("ray", None, "rumbo.ray"), ("ray", "2.9.3", "rumbo.ray"),
]:
    sys.modules[package] = version and types.SimpleNamespace(__version__=version)
    try:
        importlib.import_module(module)
    except ImportError as error:
        print(type(error).__name__, error)
del sys.modules["gymnasium"]
import rumbo.envs
for version in [None, "1.24.3"]:
    sys.modules["pettingzoo"] = version and types.SimpleNamespace(__version__=version)
    try:
        importlib.import_module("rumbo.envs.fleet")
    except ImportError as error:
        print(type(error).__name__, error)
"""
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.splitlines()
    assert said == [
        "ModuleNotFoundError rumbo.envs needs gymnasium 1.1 or newer: pip install 'rumbo[gym]'",
        "ImportError rumbo.envs needs gymnasium 1.1 or newer, and 1.0.0 is installed: pip install 'rumbo[gym]'",
        "ImportError rumbo.envs needs gymnasium 1.1 or newer, and 0.29.1 is installed: pip install 'rumbo[gym]'",
        "ModuleNotFoundError cluster= needs ray 2.60 or newer: pip install 'rumbo[ray]'",
        "ImportError cluster= needs ray 2.60 or newer, and 2.9.3 is installed: pip install 'rumbo[ray]'",
        "ModuleNotFoundError rumbo.envs.fleet needs pettingzoo 1.25 or newer: pip install 'rumbo[pettingzoo]'",
        "ImportError rumbo.envs.fleet needs pettingzoo 1.25 or newer, and 1.24.3 is installed: "
        "pip install 'rumbo[pettingzoo]'",
    ]
