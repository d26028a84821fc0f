"""Robots in one world that the caller steps, and the parallel environment of PettingZoo."""

from __future__ import annotations

import copy
import pathlib
import pickle
import warnings
from typing import Any

import gymnasium
import numpy as np
import pytest
from pettingzoo.test import parallel_api_test, parallel_seed_test
from pettingzoo.utils import parallel_to_aec

import rumbo
from rumbo.envs.fleet import FleetGoalEnv, across

CORNERS = str(pathlib.Path(__file__).parents[2] / "examples/fleet/corners.toml")


def to_the_goals(env: FleetGoalEnv, seen: dict[str, Any]) -> dict[str, Any]:
    """Each turns to its goal and drives there, whoever is in the way."""
    actions = {}
    for agent in env.agents:
        ahead, left = seen[agent][12:]
        turn = np.clip(np.arctan2(left, ahead), -1, 1) * 0.25
        actions[agent] = np.array([0.4 - turn, 0.4 + turn, 0], np.float32)
    return actions


def episode(env: FleetGoalEnv, seed: int) -> list[Any]:
    seen, infos = env.reset(seed=seed)
    rows: list[Any] = [(seen, infos)]
    while env.agents:
        seen, *rest = env.step(to_the_goals(env, seen))
        rows.append((seen, *rest))
    return rows


def alike(one: Any, other: Any) -> bool:
    return bool(gymnasium.utils.env_checker.data_equivalence(one, other, exact=True))


def test_by_the_scenario_s_commands_robots_are_those_of_a_run() -> None:
    runs = rumbo.run(CORNERS, seeds=5, trace=True)[0].robots
    batch = rumbo.Batch(CORNERS, seeds=[4, 5])
    assert batch.names == tuple(run.scenario for run in runs) and batch.seeds.tolist() == [4] * 4 + [5] * 4
    for second in (1, 8, 20):
        batch.step(second - batch.truth()["t_s"][0])
        truth = batch.truth()
        for row, run in enumerate(runs, 4):
            trace: Any = run.trace
            sample = int(np.searchsorted(trace["t_s"], second - 1e-6))
            for name in ("x_m", "y_m", "left_rad_s", "right_rad_s", "range_front_m", "battery_v"):
                assert truth[name][row] == trace[name][sample], (second, run.scenario, name)
    assert np.ptp(truth["x_m"]) > 0.1, "they have moved"


def test_pettingzoo_s_own_tests_pass() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        parallel_api_test(FleetGoalEnv(robots=3), num_cycles=200)
        parallel_api_test(FleetGoalEnv(CORNERS), num_cycles=100)
        # A wrapper around it, as SuperSuit has them.
        aec = parallel_to_aec(FleetGoalEnv(robots=2))
        aec.reset(seed=1)
        aec.step(aec.action_space(aec.agent_selection).sample())
        parallel_seed_test(lambda: FleetGoalEnv(robots=3), num_cycles=40)


def test_an_episode_of_a_seed_is_the_same_again() -> None:
    env = FleetGoalEnv(robots=3)
    first, other = episode(env, 4), episode(env, 5)
    again = episode(FleetGoalEnv(robots=3), 4)
    assert alike(first, again) and not alike(first[0], other[0])
    assert first[0][1]["robot_1"]["seed"] == 4
    env.reset(seed=4)
    following = [env.reset()[1]["robot_0"]["seed"] for _ in range(2)]
    env.reset(seed=4)
    assert [env.reset()[1]["robot_0"]["seed"] for _ in range(2)] == following and len({4, *following}) == 3


def test_robots_see_each_other_and_a_hard_contact_ends_both_episodes() -> None:
    # Two on a circle: head on.
    env = FleetGoalEnv(robots=2)
    seen, infos = env.reset(seed=1)
    assert 1.5 < infos["robot_0"]["range_front_m"] < 2.0
    # Each hears the other's burst, on half of the way.
    assert 0.75 < seen["robot_0"][4] < 1.0 and abs(seen["robot_0"][12] - 2.0) < 1e-3
    ends: dict[str, float] = {}
    straight = np.array([0.5, 0.5, 0], np.float32)
    while env.agents:
        _, rewards, terminations, _, infos = env.step({agent: straight for agent in env.agents})
        ends |= {agent: rewards[agent] for agent, over in terminations.items() if over}
    assert set(ends) == {"robot_0", "robot_1"} and max(ends.values()) < -9
    assert all(info["contacts"] >= 1 for info in infos.values())


def test_one_that_arrives_is_done_and_stays_and_the_others_go_on() -> None:
    apart = across(2)
    # Both far from each other's way.
    apart["fleet"][1]["start"] = {"x_m": 1.0, "y_m": 1.2, "heading_deg": 180}
    apart["fleet"][1]["command"] = [{"at_s": 0.4, "goal_m": [1.0, 0.0]}]
    env = FleetGoalEnv(apart)
    seen, _ = env.reset(seed=2)
    at: Any = None
    while len(env.agents) == 2:
        seen, rewards, terminations, _, infos = env.step(to_the_goals(env, seen))
        at = infos["robot_1"]
    assert env.agents == ["robot_0"] and terminations["robot_1"] and rewards["robot_1"] > 9
    assert np.hypot(at["x_m"] - at["goal_x_m"], at["y_m"] - at["goal_y_m"]) < 0.1
    with pytest.raises(ValueError, match="robot_1.*ended"):
        env.step({agent: np.zeros(3, np.float32) for agent in env.possible_agents})
    while env.agents:
        seen, rewards, terminations, _, _ = env.step(to_the_goals(env, seen))
        assert set(rewards) == {"robot_0"}
    assert terminations["robot_0"] and rewards["robot_0"] > 9


def test_robots_in_one_world_are_pickled_copied_and_put_back() -> None:
    env = FleetGoalEnv(CORNERS, agents=["north_east", "south_west"])
    seen, _ = env.reset(seed=4)
    for _ in range(20):
        seen, *_ = env.step(to_the_goals(env, seen))
    snapshot = pickle.loads(pickle.dumps(env.snapshot()))
    others = [pickle.loads(pickle.dumps(env)), copy.deepcopy(env), FleetGoalEnv(CORNERS, agents=env.possible_agents)]
    others[2].restore(snapshot)

    def go_on(env: FleetGoalEnv) -> list[Any]:
        rows: list[Any] = [(seen,)]
        for _ in range(15):
            rows.append(env.step(to_the_goals(env, rows[-1][0])))
        return rows

    expected = go_on(env)
    for other in others:
        assert alike(go_on(other), expected)
    env.restore(snapshot)
    assert alike(go_on(env), expected)
    with pytest.raises(ValueError, match="a snapshot of 4 robots.* does not fit a batch of 2 robots"):
        FleetGoalEnv(robots=2).restore(snapshot)
    # By the scenario alone.
    batch = rumbo.Batch(CORNERS, seeds=5)
    batch.step(3)
    again = pickle.loads(pickle.dumps(batch))
    for one in (batch, again):
        one.step(1)
    assert alike(batch.truth(), again.truth())


def test_the_end_of_the_time_truncates_and_a_step_after_it_is_empty() -> None:
    env = FleetGoalEnv(across(2) | {"duration_s": 1.0})
    env.reset(seed=1)
    still = np.zeros(3, np.float32)
    for step in range(10):
        *_, terminations, truncations, _ = env.step({agent: still for agent in env.agents})
        assert list(truncations.values()) == [step == 9] * 2 and not any(terminations.values())
    assert env.agents == [] and env.step({}) == ({}, {}, {}, {}, {})


def test_robots_that_are_no_agents_go_by_the_scenario() -> None:
    env = FleetGoalEnv(CORNERS, agents=["north_east"])
    assert env.possible_agents == ["north_east"]
    _, infos = env.reset(seed=3)
    still = {"north_east": np.zeros(3, np.float32)}
    for _ in range(60):
        if env.agents:
            *_, infos = env.step(still)
    assert list(infos) == ["north_east"]
    batch: Any = env._batch
    truth = batch.truth()
    moved = np.hypot(np.abs(truth["x_m"]) - 1, np.abs(truth["y_m"]) - 1) > 0.1
    assert moved[[0, 1, 3]].all(), truth


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: FleetGoalEnv(robots=1), "robots = 1: must be 2 to 32"),
        (lambda: FleetGoalEnv(CORNERS, robots=3), "robots = 3: the scenario has robots of its own"),
        (lambda: FleetGoalEnv("mode1"), "mode1: has one robot"),
        (lambda: FleetGoalEnv(CORNERS, agents=["north"]), "no robot 'north'; the scenario has south_west"),
        (lambda: FleetGoalEnv(CORNERS, agents=[]), "agents is empty"),
        (lambda: FleetGoalEnv(across(2) | {"command": []}).reset(), "robot_0: has no goal"),
        (lambda: FleetGoalEnv(robots=2).reset(seed=-1), "seed = -1"),
        (lambda: FleetGoalEnv(robots=2, parameters={"front_kpp": 1}), "front_kp"),
        (lambda: rumbo.Sim(CORNERS), "has several robots; take rumbo.Batch"),
        (lambda: rumbo.Batch(CORNERS, seeds=1, driver=["x"]), "no robot 'x'; the scenario has south_west"),
    ],
)
def test_wrong_settings_are_named(make: Any, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        make()


def test_wrong_actions_are_named() -> None:
    env = FleetGoalEnv(robots=2)
    still = np.zeros(3, np.float32)
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step({})
    env.reset(seed=1)
    for given, words in [
        ({"robot_0": still}, "no action of 'robot_1'"),
        ({"robot_0": still, "robot_1": still, "robot_2": still}, "'robot_2': it is no agent"),
        ({"robot_0": still, "robot_1": np.zeros(2)}, "robot_1.*shape"),
        ({"robot_0": still, "robot_1": np.array([0, np.nan, 0])}, "robot_1.*number 1"),
    ]:
        with pytest.raises(ValueError, match=words):
            env.step(given)
    env.close()
    for use in (lambda: env.reset(), lambda: env.step({})):
        with pytest.raises(gymnasium.error.ClosedEnvironmentError):
            use()
