"""Robots that are stepped: one and many."""

from __future__ import annotations

import _thread
import copy
import math
import os
import pathlib
import pickle
import threading
from typing import Any

import numpy as np
import pytest

import rumbo


def test_a_robot_of_its_scenario_is_that_of_the_run_bit_for_bit() -> None:
    for scenario, seed in [("mode1", 7), ("mode4-final", 2), ("mode8-random", 3)]:
        trace = rumbo.run(scenario, seeds=seed, trace=True)[0].trace
        assert trace is not None
        sim = rumbo.Sim(scenario, seed=seed)
        for tick in (1, 50, 120, 500, 800):
            sim.step(0.01 * tick - sim.t_s)
            truth = sim.truth()
            for name in ("x_m", "y_m", "left_rad_s", "right_rad_s", "range_front_m", "servo_rad", "battery_v"):
                assert truth[name] == trace[name][tick - 1], (scenario, tick, name)


def test_a_batch_is_the_same_on_any_number_of_threads() -> None:
    rows = []
    for threads in (1, 2, 3):
        batch = rumbo.Batch("mode8-random", seeds=range(1, 9), driver="caller", threads=threads)
        batch.begin_wheel_speed()
        for step in range(20):
            batch.drive(np.full((8, 3), [4 + step % 3, 5, 0.3], np.float32))
        rows.append(np.hstack([batch.observe_rows(), batch.truth_rows()]))
    assert np.array_equal(rows[0], rows[1]) and np.array_equal(rows[0], rows[2])


def test_a_driven_robot_does_as_commanded() -> None:
    sim = rumbo.Sim("mode1", seed=7, driver="caller")
    sim.step(0.5)
    assert sim.truth()["armed"] == 0
    sim.command(reference_m=0.4)
    sim.command(arm=True)
    sim.step(4)
    assert abs(sim.truth()["range_front_m"] - 0.4) < 0.02
    assert abs(sim.observe()["range_front_m"] - 0.4) < 0.02
    sim.command(disarm=True)
    sim.command(mode="wheel_speed")
    sim.command(left_rpm=-60, right_rpm=-60)
    sim.command(arm=True)
    sim.step(1)
    assert abs(sim.truth()["left_rad_s"] + 2 * math.pi) < 0.5
    assert sim.fault is None and sim.seed == 7 and abs(sim.t_s - 5.5) < 1e-9


def test_the_servo_points_where_it_is_commanded() -> None:
    sim = rumbo.Sim("mode8-random", driver="caller")
    sim.command(servo_rad=0.8)
    sim.step(1)
    assert abs(sim.truth()["servo_rad"] - 0.8) < 0.05 and abs(sim.observe()["servo_rad"] - 0.8) < 1e-6
    sim.command(servo_rad=None)
    sim.step(1)
    assert abs(sim.truth()["servo_rad"]) < 0.05


def test_a_snapshot_comes_back_any_number_of_times() -> None:
    for driver in ("scenario", "caller"):
        sim = rumbo.Sim("mode4-final", seed=5, driver=driver)  # type: ignore[arg-type]
        sim.step(2)
        then, snapshot = sim.truth(), sim.snapshot()
        sim.step(3)
        later = sim.truth()
        for _ in range(2):
            sim.restore(snapshot)
            assert np.array_equal([*sim.truth().values()], [*then.values()], equal_nan=True)
            sim.step(3)
            assert np.array_equal([*sim.truth().values()], [*later.values()], equal_nan=True)
    with pytest.raises(ValueError, match="snapshot of 1"):
        rumbo.Batch("mode1", seeds=[1, 2]).restore(snapshot)


def test_what_another_program_knows_is_not_made_up() -> None:
    sim = rumbo.Sim("mode2", program="baseline")
    sim.step(1)
    assert sim.truth()["t_s"] == 1
    with pytest.raises(ValueError, match="own program"):
        sim.observe()


def test_columns_share_the_memory_of_their_rows() -> None:
    batch = rumbo.Batch("mode1", seeds=range(3))
    truth = batch.truth()
    assert truth["x_m"].base is not None and truth["x_m"].base is truth["y_m"].base
    assert tuple(truth) == rumbo.TRUE and tuple(batch.observe()) == rumbo.OBSERVED


def test_the_words_of_a_fault_begin_with_what_a_sound_robot_met() -> None:
    batch = rumbo.Batch("mode5", world="wall_front", seeds=range(8), driver="caller")
    batch.begin_wheel_speed()
    # 12 rad/s, the fastest: 0.39 m/s.
    _, truth = batch.drive(np.tile([12, 12, 0], (8, 1)), 6.0)
    numbers = truth[:, rumbo.TRUE.index("fault")].astype(int)
    assert numbers.all() and (truth[:, rumbo.TRUE.index("contacts")] > 0).all()
    for index, number in enumerate(numbers):
        assert rumbo.FAULTS[number] == batch.fault(index)
        assert rumbo.FAULTS[number].split(": ")[1].startswith(("the robot met something", "something holds the"))


def test_renewed_robots_begin_again() -> None:
    batch = rumbo.Batch("mode1", seeds=[1, 2, 3], threads=2)
    batch.step(1)
    batch.renew([0, 2], [8, 9])
    assert batch.seeds.tolist() == [8, 2, 9] and batch.truth()["t_s"].tolist() == [0, 1, 0]
    for indices, seeds, error in [([3], [1], IndexError), ([-1], [1], IndexError), ([0], [1, 2], ValueError)]:
        with pytest.raises(error):
            batch.renew(indices, seeds)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"referenc_m": 0.4}, ["reference_m"]),
        ({"reference_m": 9}, ["reference_m = 9", "0.02"]),
        ({"reference_m": math.nan}, ["finite"]),
        ({"arm": False}, ["must be true"]),
        ({"goal_m": [1, 0]}, ["mode"]),
        ({"parameter": "front_kpp", "value": 1}, ["front_kp"]),
        ({"mode": "wheelspeed"}, ["wheel_speed"]),
        ({"servo_rad": 2}, ["servo"]),
        ({"servo_rad": math.nan}, ["servo"]),
        ({}, ["no action"]),
        ({"arm": True, "at_s": 1}, ["at_s"]),
    ],
)
def test_a_wrong_command_is_refused_with_its_reason(keys: dict[str, Any], words: list[str]) -> None:
    sim = rumbo.Sim("mode1", driver="caller")
    with pytest.raises(ValueError) as error:
        sim.command(**keys)
    for word in words:
        assert word in str(error.value)


def test_who_commands_is_checked() -> None:
    with pytest.raises(ValueError, match="scenario commands"):
        rumbo.Sim("mode1").command(arm=True)
    with pytest.raises(ValueError, match="caller"):
        rumbo.Batch("mode1", seeds=1).drive(np.zeros((1, 3)))
    with pytest.raises(ValueError, match="driver"):
        rumbo.Sim("mode1", driver="me")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="program"):
        rumbo.Sim("mode1", driver="caller", program="baseline")


@pytest.mark.parametrize("duration_s", [0, -1, 0.005, math.nan, math.inf, 1e12])
def test_a_step_is_a_number_of_control_ticks(duration_s: float) -> None:
    with pytest.raises(ValueError, match="duration_s"):
        rumbo.Sim("mode1").step(duration_s)


@pytest.mark.parametrize(
    ("actions", "words"),
    [
        (np.zeros((2, 3)), r"\(2, 3\): must be \(4, 3\)"),
        (np.zeros(3), "shape"),
        (np.where(np.arange(12).reshape(4, 3) == 7, np.nan, 0.0), r"action\[2, 1\] = NaN"),
        (np.full((4, 3), np.inf), r"action\[0, 0\]"),
        (np.where(np.arange(12).reshape(4, 3) == 5, 1.6, 0.0), r"action\[1, 2\].*servo"),
    ],
)
def test_wrong_actions_are_refused_with_their_index(actions: Any, words: str) -> None:
    batch = rumbo.Batch("mode5", seeds=range(4), driver="caller")
    with pytest.raises(ValueError, match=words):
        batch.drive(actions)


def test_actions_in_any_memory_order_are_the_same_actions() -> None:
    actions = np.array([[3, 5, 0], [6, 2, 0]], np.float32)
    rows = []
    for given in (actions, np.asfortranarray(actions), actions.astype(np.float64), actions.tolist()):
        batch = rumbo.Batch("mode5", seeds=[1, 2], driver="caller")
        batch.begin_wheel_speed()
        rows.append(batch.drive(given, 0.5)[1])
    assert all(np.array_equal(rows[0], other, equal_nan=True) for other in rows)


def test_two_threads_on_the_same_robots_are_kept_apart() -> None:
    batch = rumbo.Batch("mode5", seeds=range(64), threads=1)
    errors: list[BaseException] = []

    def step() -> None:
        try:
            for _ in range(20):
                batch.step(1)
        except RuntimeError as error:
            errors.append(error)

    threads = [threading.Thread(target=step) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all("another thread" in str(error) for error in errors)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no forks here")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_fork_says_so_in_place_of_hanging() -> None:
    batch = rumbo.Batch("mode1", seeds=[1, 2], threads=2)
    batch.step(0.1)
    alone = rumbo.Sim("mode1")
    child = os.fork()
    if child == 0:
        try:
            batch.step(0.1)
        except RuntimeError as error:
            alone.step(0.1)  # One robot needs no other thread.
            os._exit(0 if "spawn" in str(error) else 1)
        os._exit(2)
    assert os.waitpid(child, 0)[1] == 0


def same(one: Any, other: Any) -> bool:
    return np.array_equal([*one.truth().values()], [*other.truth().values()], equal_nan=True)


def test_robots_are_pickled_and_copied_and_go_on_bit_for_bit_the_same(tmp_path: pathlib.Path) -> None:
    world = rumbo.load("world", "room")
    caller = rumbo.Sim("mode1", seed=7, driver="caller", world=world)
    caller.step(0.5)
    caller.command(reference_m=0.4)
    caller.command(parameter="front_kp", value=4)
    caller.command(arm=True)
    with pytest.raises(ValueError):
        caller.command(mode="mission")
    caller.command(servo_rad=0.1)
    caller.record()
    for sim in (caller, rumbo.Sim("mode8-random", seed=3), rumbo.Sim("mode2", program="baseline")):
        sim.step(1.5)
        path = tmp_path / "snapshot"
        path.write_bytes(pickle.dumps(sim.snapshot()))
        others = [pickle.loads(pickle.dumps(sim)), copy.deepcopy(sim), copy.copy(sim)]
        sim.step(2)
        for other in others:
            other.step(2)
            assert same(other, sim) and other.seed == sim.seed
        other.restore(pickle.loads(path.read_bytes()))
        other.step(2)
        assert same(other, sim)
    caller.write_log(tmp_path / "one.mcap")
    others[0] = pickle.loads(pickle.dumps(caller))
    others[0].write_log(tmp_path / "other.mcap")
    one, other = (rumbo.read_log(tmp_path / f"{name}.mcap").signals for name in ("one", "other"))
    assert all(np.array_equal(one[name], other[name], equal_nan=True) for name in one)


def test_a_batch_in_a_pickle_has_its_renewed_and_its_waiting_robots() -> None:
    batch = rumbo.Batch("mode5", seeds=range(5), driver="caller", threads=2)
    batch.begin_wheel_speed()
    batch.drive(np.full((5, 3), [4.0, 4.0, 0.2]), active=[True, False, True, True, True])
    batch.renew([3], [99])
    batch.drive(np.full((5, 3), 0.3), pwm=True)
    again = pickle.loads(pickle.dumps(batch))
    assert again.seeds.tolist() == [0, 1, 2, 99, 4] and repr(again) == repr(batch)
    for one in (batch, again):
        rows = one.drive(np.full((5, 3), [6.0, 5.0, 0.3]), 1.0)
    assert same(batch, again) and len(set(rows[1][:, 0].tolist())) == 3


def test_a_pickle_of_another_version_is_refused() -> None:
    from rumbo._sim import _snapshot

    parts = rumbo.Sim("mode1").snapshot().parts()
    with pytest.raises(ValueError, match=r"a snapshot: was pickled by Rumbo 0\.1\.0, model 3, and this is Rumbo"):
        _snapshot(("0.1.0", 3), *parts)
    with pytest.raises(ValueError, match="it is damaged, make it again"):
        _snapshot((rumbo.__version__, rumbo.MODEL), *parts[:3], [[b"\x63"]])


def interrupted(act: Any) -> None:
    """Control-C while something is done, and again later: Python ignores one in a weak reference's callback."""
    ended = threading.Event()

    def press() -> None:
        wait_s = 0.3
        while not ended.wait(wait_s):
            _thread.interrupt_main()
            wait_s = 3.0

    presser = threading.Thread(target=press)
    presser.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            act()
    finally:
        ended.set()
        presser.join()


def test_control_c_ends_the_driving_of_robots_with_all_at_one_time() -> None:
    batch = rumbo.Batch("mode5", seeds=range(100), driver="caller")
    interrupted(lambda: batch.begin_wheel_speed(duration_s=36_000))
    interrupted(lambda: batch.drive(np.zeros((100, 3)), 36_000))
    interrupted(lambda: batch.step(36_000))
    times = batch.truth()["t_s"]
    assert times.max() < 36_000 and len(set(times.tolist())) == 1


def test_control_c_ends_the_making_of_robots() -> None:
    shares: list[float] = []
    interrupted(lambda: rumbo.Batch("mode8-random", seeds=range(100_000), progress=shares.append))
    assert not shares or shares[-1] < 0.5
    batch = rumbo.Batch("mode8-random", seeds=range(20), progress=shares.append)
    assert shares[-1] == 1.0
    made = rumbo.Batch("mode5", seeds=range(20_000))
    interrupted(lambda: [made.renew(range(20_000), range(20_000, 40_000)) for _ in range(100)])
    assert len(batch) == 20 and len(made) == 20_000
    many = {
        "title": "Many on a floor",
        "robot": "memoria",
        "rig": "final",
        "world": {"title": "A floor", "arena": {"from_m": [-9, -9], "to_m": [9, 9], "walled": True}},
        "mode": "mission",
        "duration_s": 9.0,
        "calibrated": True,
        "fleet": [{"name": f"r{n}", "start": {"x_m": n % 8 - 4.0, "y_m": n // 8 - 2.0}} for n in range(32)],
    }
    interrupted(lambda: [rumbo.Batch(many, seeds=1) for _ in range(20)])


def test_control_c_ends_the_check_of_a_sweep_s_points() -> None:
    axes = {"front_kp": "1:20", "kv": "0.01:0.1"}
    interrupted(lambda: rumbo.sweep("mode8-random", axes, design="random", points=200_000, seeds=1))


@pytest.mark.parametrize("index", [-1, 2, 2**70])
def test_the_number_of_a_robot_that_is_not_there_is_named(index: int) -> None:
    batch = rumbo.Batch("mode5", seeds=[1, 2], driver="caller")
    for act in (
        batch.fault,
        batch.obstacles,
        lambda index: batch.command(index, arm=True),
        lambda index: batch.record([index]),
        lambda index: batch.write_log(index, "none.mcap"),
        lambda index: batch.renew([index], [1]),
        lambda index: batch.begin_wheel_speed([index]),
    ):
        with pytest.raises(IndexError, match=f"robot {index}: there are 2, numbered from 0"):
            act(index)
    with pytest.raises(TypeError, match="robot 1.5: must be a whole number"):
        batch.fault(1.5)  # type: ignore[arg-type]


def test_shares_of_the_pwm_drive_the_wheels_and_are_checked() -> None:
    batch = rumbo.Batch("mode5", seeds=[1, 2], driver="caller")
    batch.begin_wheel_speed()
    _, truth = batch.drive([[0.5, 0.5, 0], [-0.5, -0.5, 0]], 1.0, pwm=True)
    speeds = truth[:, rumbo.TRUE.index("left_rad_s")]
    assert speeds[0] > 5 and speeds[1] < -5
    with pytest.raises(ValueError, match=r"action\[0, 1\] = 1.5: right wheel's share of the PWM must be within 1"):
        batch.drive([[0, 1.5, 0], [0, 0, 0]], pwm=True)


def test_what_a_prompt_shows_is_short_and_tells_what_it_is() -> None:
    sim = rumbo.Sim("mode1", seed=7)
    sim.step(0.5)
    assert repr(sim) == "<robot of mode1, seed 7, driven by the scenario: 0.50 s>"
    assert repr(rumbo.Batch("mode5", seeds=range(3), driver="caller")) == "<3 robots of mode5, driven by the caller>"
    assert repr(rumbo.Policy("goal")).endswith("16 inputs, 32, 32, 3 neurons>")
