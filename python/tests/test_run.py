"""Runs from Python are those of the command line."""

from __future__ import annotations

import json
import math
import os
import pathlib
import signal
import subprocess
import sys
import threading
import time
from typing import Any

import numpy as np
import pytest

import rumbo


def json_of(command: str, *words: str) -> list[dict[str, Any]]:
    done = subprocess.run([command, "run", "--json", "--no-record", *words], capture_output=True, text=True)
    assert done.returncode in (0, 1), done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()]


def same(value: float, printed: float | None) -> bool:
    return math.isnan(value) if printed is None else value == printed


@pytest.mark.parametrize(
    ("words", "settings"),
    [
        (["mode1"], {}),
        (["mode5-reversal"], {"threads": 1}),
        (["mode4-final"], {"threads": 2}),
        (["mode8-random"], {}),
        (["mode2", "--program", "baseline"], {"program": "baseline"}),
        (
            ["mode1", "--param", "front_kp=5", "--param", "battery.open_circuit_v=6.9", "--world", "room"],
            {"parameters": {"front_kp": 5, "battery.open_circuit_v": 6.9}, "world": "room"},
        ),
        (["mode1", "--world", "room"], {"world": rumbo.load("world", "room")}),
        (["mode1"], {"robot": rumbo.load("robot", "memoria")}),
    ],
)
def test_the_numbers_are_those_of_the_command_bit_for_bit(
    rumbo_command: str, words: list[str], settings: dict[str, Any]
) -> None:
    printed = json_of(rumbo_command, *words, "--runs", "4", "--seed", "3")
    runs = rumbo.run(words[0], seeds=range(3, 7), **settings)
    assert len(printed) == len(runs) == 4
    for run, expected in zip(runs, printed):
        assert (run.seed, run.passed, list(run.failures)) == (
            expected["seed"],
            expected["pass"],
            expected.get("failures", []),
        )
        assert run.metrics.keys() == expected["metrics"].keys()
        for name, value in run.metrics.items():
            assert same(value, expected["metrics"][name]), name


def test_a_scenario_may_be_a_dictionary_with_its_world_and_robot() -> None:
    scenario = rumbo.load("scenario", "mode1")
    scenario["robot"] = rumbo.load("robot", "memoria")
    scenario["world"] = rumbo.load("world", "wall_front")
    assert rumbo.run(scenario, seeds=5)[0].metrics == rumbo.run("mode1", seeds=5)[0].metrics


def test_columns_have_a_row_for_each_run() -> None:
    runs = rumbo.run("mode1", seeds=[4, 2**64 - 1])
    table = runs.to_dict()
    assert table["seed"].tolist() == [4, 2**64 - 1]
    assert table["step1.settling_s"].tolist() == [run.metrics["step1.settling_s"] for run in runs]
    assert runs[1:].seeds.tolist() == [2**64 - 1]
    assert "2 runs of mode1" in repr(runs)


def test_each_of_several_robots_has_its_trace() -> None:
    scenario = pathlib.Path(__file__).parents[2] / "examples/fleet/corners.toml"
    run = rumbo.run(str(scenario), trace=True)[0]
    assert [robot.scenario for robot in run.robots] == ["south_west", "south_east", "north_east", "north_west"]
    assert run.trace is None
    assert run.robots[2].metrics["path_m"] == run.metrics["north_east.path_m"]
    starts = [(robot.trace["x_m"][0], robot.trace["y_m"][0]) for robot in run.robots if robot.trace]
    assert np.allclose(starts, [(-1, -1), (1, -1), (1, 1), (-1, 1)], atol=1e-2)


def test_the_trace_is_ground_truth_every_ten_milliseconds() -> None:
    run = rumbo.run("mode1", trace=True)[0]
    assert run.trace is not None
    assert {len(column) for column in run.trace.values()} == {900}
    assert np.allclose(np.diff(run.trace["t_s"]), 0.01)
    assert abs(run.trace["range_front_m"][540] - 0.30) < 0.02
    assert run.trace["left_duty"].dtype == np.int16 and run.trace["touching"].dtype == np.bool_
    assert rumbo.run("mode1")[0].trace is None


def test_other_threads_of_python_go_on() -> None:
    counts = []

    def count() -> None:
        while not counts or counts[-1] != "end":
            counts.append("tick")
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    rumbo.run("mode5", seeds=range(1, 41), threads=1)
    before = len(counts)
    counts.append("end")
    thread.join()
    assert before > 5


def test_progress_counts_and_its_error_ends_the_runs() -> None:
    seen = []
    rumbo.run("mode1", seeds=range(1, 6), progress=lambda done, total: seen.append((done, total)))
    assert seen == [(done, 5) for done in range(1, 6)]

    def fail(done: int, total: int) -> None:
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        rumbo.run("mode1", seeds=range(1, 1000), progress=fail)


@pytest.mark.skipif(sys.platform == "win32", reason="signals of Unix")
@pytest.mark.parametrize(
    "act",
    [
        "rumbo.run('mode5', seeds=range(1_000_000), threads=2)",
        "rumbo.Batch('mode5', seeds=range(100), threads=2).step(1e6)",
        "rumbo.Sim('mode5').step(1e7)",
    ],
)
def test_control_c_ends_what_takes_long(act: str) -> None:
    code = f"import rumbo; print('go', flush=True); {act}"
    child = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        assert child.stdout is not None
        child.stdout.readline()
        time.sleep(0.5)
        child.send_signal(signal.SIGINT)
        _, errors = child.communicate(timeout=60)
    finally:
        child.kill()
    assert "KeyboardInterrupt" in errors and child.returncode != 0


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"parameters": {"front_kpp": 1}}, ["front_kpp", "front_kp"]),
        ({"parameters": {"battery.open_circuit_w": 1}}, ["battery.open_circuit_v"]),
        ({"parameters": {"front_kp": -1}}, ["front_kp = -1"]),
        ({"parameters": {"front_kp": math.nan}}, ["front_kp"]),
        ({"parameters": {"front_kp": "much"}}, ["front_kp", "must be a number"]),
        ({"world": "rom"}, ["unknown world `rom`", "room"]),
        ({"world": {"arena": {"from_m": [0, 0]}}}, ["given world"]),
        ({"world": {"title": math.inf}}, ["world.title", "finite"]),
        ({"robot": "memory"}, ["memoria"]),
        ({"rig": "front"}, ["front_single"]),
        ({"seeds": []}, ["seeds is empty"]),
        ({"seeds": [1, -1]}, ["seeds[1] = -1"]),
        ({"seeds": 2**64}, ["below 2**64"]),
        ({"threads": 0}, ["threads = 0"]),
        ({"threads": -(2**62)}, ["threads"]),
        ({"program": "mine"}, ["baseline"]),
    ],
)
def test_what_is_wrong_is_said_before_anything_runs(settings: dict[str, Any], words: list[str]) -> None:
    with pytest.raises(ValueError) as error:
        rumbo.run("mode1", **settings)
    for word in words:
        assert word in str(error.value)


def test_an_unknown_scenario_names_the_near_ones() -> None:
    with pytest.raises(ValueError, match="unknown scenario `mode11`.*mode1"):
        rumbo.run("mode11")
    with pytest.raises(OSError, match="nowhere.toml"):
        rumbo.run(pathlib.Path("nowhere.toml"))
    with pytest.raises(TypeError, match="scenario = 3"):
        rumbo.run(3)  # type: ignore[arg-type]


def test_names_and_content_of_files() -> None:
    assert "mode1" in rumbo.names("scenario") and "memoria" in rumbo.names("robot")
    assert {"front_kp", "battery.open_circuit_v"} <= set(rumbo.names("parameter"))
    assert rumbo.load("scenario", "mode1")["duration_s"] == 9
    with pytest.raises(ValueError, match="kind"):
        rumbo.names("planet")  # type: ignore[arg-type]


def test_a_log_is_read_as_arrays(rumbo_command: str, tmp_path: pathlib.Path) -> None:
    subprocess.run(
        [rumbo_command, "run", "mode1", "--seed", "7", "--out", str(tmp_path)], check=True, capture_output=True
    )
    log = rumbo.read_log(tmp_path / "mode1-7.mcap")
    rows = {len(column) for column in log.signals.values()}
    assert len(rows) == 1 and rows.pop() > 200
    assert np.all(np.diff(log.signals["t_s"]) > 0)
    assert abs(log.signals["true_x_m"][-1] - log.signals["x_m"][-1]) < 0.05
    assert log.manifest is not None and log.manifest["seed"] == 7 and log.manifest["scenario"] == "mode1"
    assert log.outcome is not None
    run = rumbo.run("mode1", seeds=7)[0]
    assert log.outcome["metrics"] == run.metrics and log.outcome["passed"] == run.passed
    assert any("armed" in text for _, _, text in log.events)
    assert log.cut is None and log.parameters["front_kp"] > 0
    with pytest.raises(ValueError, match="mode1-7.json"):
        rumbo.read_log(tmp_path / "mode1-7.json")
    with pytest.raises(OSError, match="missing"):
        rumbo.read_log(tmp_path / "missing.mcap")


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no forks here")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_runs_work_in_a_fork() -> None:
    before = rumbo.run("mode1", seeds=[1, 2], threads=2).metrics
    child = os.fork()
    if child == 0:
        ok = rumbo.run("mode1", seeds=[1, 2], threads=2).metrics.keys() == before.keys()
        os._exit(0 if ok else 1)
    assert os.waitpid(child, 0)[1] == 0
