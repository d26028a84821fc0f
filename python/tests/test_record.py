"""Robots that are driven, and episodes, as logs."""

from __future__ import annotations

import pathlib
import subprocess
from typing import Any

import gymnasium
import numpy as np
import pytest

import rumbo
import rumbo.envs
from rumbo.envs import RecordLog

ACTION = np.array([0.4, 0.3, 0.2], np.float32)


def names(folder: pathlib.Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_the_log_of_a_driven_robot_has_its_truth_and_what_it_was_commanded(tmp_path: pathlib.Path) -> None:
    sim, unrecorded = [rumbo.Sim("mode5", seed=7, driver="caller") for _ in range(2)]
    with pytest.raises(ValueError, match=r"robot 0: record\(\)"):
        sim.write_log(tmp_path / "x.mcap")
    sim.record()
    truth = []
    for robot in (sim, unrecorded):
        robot.command(parameter="kv", value=0.05)
        robot.command(arm=True)
    for tick in range(300):
        for robot in (sim, unrecorded):
            if tick % 10 == 0:
                robot.command(left_rpm=40 + tick / 10, right_rpm=60)
            robot.step(0.01)
        truth.append(sim.truth())
        assert sim.observe() == unrecorded.observe()
        # A goal that is not there is no number.
        assert np.array_equal(list(sim.truth().values()), list(unrecorded.truth().values()), equal_nan=True)
    sim.write_log(tmp_path / "x.mcap")
    log = rumbo.read_log(tmp_path / "x.mcap")
    signals = log.signals
    assert np.allclose(np.diff(signals["t_s"]), 0.04) and 2.9 < signals["t_s"][-1] <= 3.0
    for name in ("heading_rad", "left_rad_s", "right_rad_s", "servo_rad"):
        of_ticks = [truth[round(100 * t_s) - 1][name] for t_s in signals["t_s"]]
        assert np.allclose(signals[f"true_{name}"], of_ticks, atol=1e-3), name
    assert signals["right_ref_rad_s"][-1] == pytest.approx(2 * np.pi, abs=0.01)
    assert signals["left_rad_s"][-1] == pytest.approx(truth[-1]["left_rad_s"], abs=0.3)
    assert log.parameters["kv"] == pytest.approx(0.05)
    # Not each of the setpoints.
    assert [text for _, _, text in log.events if text.startswith("sent")] == ["sent: kv = 0.05", "sent: ON"]
    assert log.manifest is not None and log.manifest["kind"] == "episode" and log.manifest["seed"] == 7
    assert log.outcome is None


def test_a_log_replaces_no_file_unasked(tmp_path: pathlib.Path) -> None:
    sim = rumbo.Sim("mode5", driver="caller")
    sim.record()
    sim.step(1)
    path = tmp_path / "x.mcap"
    path.write_text("mine")
    with pytest.raises(FileExistsError, match="overwrite=True"):
        sim.write_log(path)
    assert path.read_text() == "mine"
    sim.write_log(path, overwrite=True)
    assert len(rumbo.read_log(path).signals["t_s"]) > 20
    with pytest.raises(FileNotFoundError, match="missing"):
        sim.write_log(tmp_path / "missing/x.mcap")


def test_a_snapshot_has_what_was_recorded_with_it_and_a_renewed_robot_nothing(tmp_path: pathlib.Path) -> None:
    batch = rumbo.Batch("mode1", seeds=range(1, 10))
    batch.record([1, 8])
    batch.step(1)
    before = batch.snapshot()
    batch.step(1)
    batch.write_log(8, tmp_path / "long.mcap")
    batch.restore(before)
    batch.write_log(8, tmp_path / "short.mcap")
    end_s = [rumbo.read_log(tmp_path / name).signals["t_s"][-1] for name in ("short.mcap", "long.mcap")]
    assert 0.8 < end_s[0] <= 1 and 1.8 < end_s[1] <= 2
    with pytest.raises(ValueError, match="robot 0"):
        batch.write_log(0, tmp_path / "x.mcap")
    batch.renew([1], [77])
    with pytest.raises(ValueError, match="robot 1"):
        batch.write_log(1, tmp_path / "x.mcap")
    for index in (-1, 9):
        with pytest.raises((IndexError, OverflowError)):
            batch.record([index])


def episode(env: gymnasium.Env[Any, Any], seed: int | None, most: int = 1000) -> list[tuple[Any, ...]]:
    """What the steps of an episode gave."""
    env.reset(seed=seed)
    done: list[tuple[Any, ...]] = []
    while len(done) < most and not (done and (done[-1][2] or done[-1][3])):
        done.append(env.step(ACTION))
    return done


def test_an_episode_s_log_is_the_episode(tmp_path: pathlib.Path, rumbo_command: str) -> None:
    folder = tmp_path / "made/for it"
    env = RecordLog(gymnasium.make("rumbo/Goal-v0"), folder, lambda _: True, name_prefix="goal")
    recorded = episode(env, 3)
    # It is there as soon as the episode is over.
    log = rumbo.read_log(folder / "goal-episode-0.mcap")
    unrecorded = episode(gymnasium.make("rumbo/Goal-v0"), 3)
    assert len(recorded) == len(unrecorded) > 20
    for one, other in zip(recorded, unrecorded):
        assert np.array_equal(one[0], other[0]) and one[1:] == other[1:]
    info, signals = recorded[-1][4], log.signals
    assert signals["t_s"][0] < 0.1 and info["t_s"] - 0.05 <= signals["t_s"][-1] <= info["t_s"]
    t_s = [done[4]["t_s"] for done in recorded]
    for name in ("x_m", "y_m", "left_rad_s"):
        true = np.interp(t_s, signals["t_s"], signals[f"true_{name}"])[2:-1]
        assert np.allclose(true, [done[4][name] for done in recorded[2:-1]], atol=0.02 if "_m" in name else 0.5)
    assert abs(signals["x_m"][-1] - info["x_m"]) < 0.1 and np.ptp(signals["true_x_m"]) > 0.3
    assert np.isfinite(signals["range_front_m"]).any() and signals["left_ref_rad_s"][-1] == pytest.approx(4.8, abs=0.01)
    again = subprocess.run([rumbo_command, "rerun", folder / "goal-episode-0.mcap"], capture_output=True, text=True)
    assert again.returncode == 2 and "a program in Python drove" in again.stderr
    env.close()


def test_episodes_are_written_as_triggered_and_when_they_are_cut_short(tmp_path: pathlib.Path) -> None:
    env = RecordLog(gymnasium.make("rumbo/WheelSpeed-v0"), tmp_path, lambda number: number % 2 == 0)
    episode(env, 1)
    assert names(tmp_path) == ["rumbo-episode-0.mcap"]
    episode(env, None)
    episode(env, None, most=10)
    assert names(tmp_path) == ["rumbo-episode-0.mcap"]
    episode(env, None)
    assert names(tmp_path) == ["rumbo-episode-0.mcap", "rumbo-episode-2.mcap"]
    env.reset(seed=9)
    env.step(ACTION)
    env.close()
    env.close()
    ends_s = [rumbo.read_log(tmp_path / name).signals["t_s"][-1] for name in names(tmp_path)]
    assert names(tmp_path)[-1] == "rumbo-episode-4.mcap"
    assert np.allclose(ends_s, [5.5, 1.5, 0.6], atol=0.05)


def test_an_episode_whose_log_is_there_is_not_begun(tmp_path: pathlib.Path) -> None:
    def make(**settings: Any) -> RecordLog:
        return RecordLog(gymnasium.make("rumbo/WheelSpeed-v0"), tmp_path, **settings)

    path = tmp_path / "rumbo-episode-0.mcap"
    path.write_text("mine")
    with pytest.raises(FileExistsError, match="overwrite=True"):
        make().reset(seed=1)
    assert path.read_text() == "mine"
    env = make(overwrite=True)
    episode(env, 1, most=3)
    env.close()
    assert rumbo.read_log(path).manifest is not None
    # By itself it writes fewer and fewer.
    env = make(overwrite=True)
    for _ in range(10):
        episode(env, None, most=1)
    env.close()
    assert names(tmp_path) == [f"rumbo-episode-{number}.mcap" for number in (0, 1, 8)]


def test_only_a_single_environment_of_rumbo_is_recorded(tmp_path: pathlib.Path) -> None:
    vector: Any = gymnasium.make_vec("rumbo/WheelSpeed-v0", num_envs=2)
    for env in (gymnasium.make("CartPole-v1"), vector):
        with pytest.raises(TypeError, match="single environments"):
            RecordLog(env, tmp_path)
