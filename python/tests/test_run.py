"""Runs from Python are those of the command line."""

from __future__ import annotations

import csv
import errno
import json
import math
import os
import pathlib
import re
import signal
import subprocess
import sys
import threading
import time
from typing import Any

import numpy as np
import pytest

import rumbo
from rumbo._progress import Bar


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
            expected["passed"],
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
        ({"parameters": {"front_kp": "much"}}, ["front_kp", "`much` is not a number"]),
        ({"parameters": {"front_kp": []}}, ["front_kp", "must be a number, or the name of a choice"]),
        ({"parameters": {"rig": "front"}}, ["rig", "`front_pair`", "not `front`"]),
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
    with pytest.raises(TypeError, match="scenario = 3"):
        rumbo.run(3)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"seeds = 1\.5: must be a whole number, or several such as range\(1, 11\)"):
        rumbo.run("mode1", seeds=1.5)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"seeds\[1\] = 2\.5: must be a whole number"):
        rumbo.run("mode1", seeds=[1, 2.5])  # type: ignore[list-item]


@pytest.mark.parametrize(
    "use",
    [
        lambda path: rumbo.run(path),
        lambda path: rumbo.load("robot", path),
        lambda path: rumbo.Sim("mode1", world=path),
        lambda path: rumbo.Policy(path),
        lambda path: rumbo.run("mode1", firmware=path),
        lambda path: rumbo.read_log(path),
        lambda path: rumbo.identify(path),
        lambda path: rumbo.export_policy(path),
    ],
)
def test_a_file_that_is_not_there_is_the_system_s_error(use: Any) -> None:
    with pytest.raises(FileNotFoundError) as error:
        use("nowhere.toml")
    assert error.value.errno == errno.ENOENT and "nowhere.toml" in str(error.value.filename)


@pytest.mark.parametrize(
    ("use", "words"),
    [
        (lambda: rumbo.sweep("mode1", {"front_kp": "1:20"}), "a grid needs a count"),
        (lambda: rumbo.sweep("mode1", {"front_kp": "1:20:9999", "kv": "0:1:9999"}), "fewer values or fewer runs"),
        (lambda: rumbo.sweep("mode1", {"front_kp": "1:2"}, design="sobol", points=99999), "have them drawn at random"),
        (lambda: rumbo.run("mode1", robot="uno"), "run a sketch or an image of your own"),
        (lambda: rumbo.run("mode2-final", program="baseline"), "leave out the program baseline"),
    ],
)
def test_errors_speak_of_no_command_line(use: Any, words: str) -> None:
    with pytest.raises(ValueError, match=words) as error:
        use()
    assert not re.search(r"--\w|`rumbo ", str(error.value)), error.value


def test_choices_are_made_by_name() -> None:
    by_name = rumbo.run("mode1", parameters={"rig": "front_pair", "mission_reset_origin": "yes"})[0]
    by_number = rumbo.run("mode1", parameters={"rig": 1, "mission_reset_origin": True})[0]
    assert by_name == by_number and by_name.metrics != rumbo.run("mode1", parameters={"rig": "front_single"})[0].metrics


def test_a_clear_range_is_infinite_and_one_of_no_sonar_unknown(rumbo_command: str, tmp_path: pathlib.Path) -> None:
    words = ["run", "mode8-goals", "mode1", "--out", str(tmp_path)]
    subprocess.run([rumbo_command, *words], capture_output=True)
    for scenario in ("mode8-goals", "mode1"):
        trace = rumbo.run(scenario, trace=True)[0].trace
        with open(tmp_path / f"{scenario}-1.truth.csv", newline="") as table:
            rows = list(csv.DictReader(table))
        log = rumbo.read_log(tmp_path / f"{scenario}-1.mcap").signals
        assert trace is not None and len(rows) == len(trace["t_s"])
        for name in ("range_left_m", "range_front_m"):
            told = np.array([float(row[name] or "nan") for row in rows])
            assert np.allclose(told, trace[name], atol=1e-5, equal_nan=True), (scenario, name)
        missing = np.isnan(trace["range_left_m"]).all()
        assert missing == (scenario == "mode1") == ("true_range_left_m" not in log)
        if not missing:
            assert np.isinf(trace["range_front_m"]).any() and np.isinf(log["true_range_front_m"]).any()


def test_a_notebook_shows_runs_as_tables_and_plots() -> None:
    runs = rumbo.run("mode1", seeds=range(1, 15), trace=True)
    assert repr(runs[0]) == "<run of mode1, seed 1: passed>"
    one, table = runs[0]._repr_html_(), runs._repr_html_()
    # A way, two wheels, and the ranges that are within reach.
    assert one.count("<svg") == 3 and one.count("<polyline") >= 4 and "step1.settling_s" in one
    assert table.count("<tr>") == 11 and "4 more rows" in table and len(table) < 10_000
    assert "NaN" not in one and "inf" not in one.split("</table>")[1]


def test_progress_has_a_rate_and_the_time_left(capsys: pytest.CaptureFixture[str]) -> None:
    bar = Bar(total=100, first=20)
    bar._began_s -= 4
    for done in (30, 40, 100):
        bar._shown_s -= 1
        bar.show(done)
    bar.end()
    lines = [line.strip() for line in capsys.readouterr().err.split("\r")]
    assert lines == [
        "",
        "30 of 100 runs, 2.5 a second, 28 s left",
        "40 of 100 runs, 5 a second, 12 s left",
        "100 of 100 runs, 20 a second, 4 s",
    ]
    rumbo.run("mode1", seeds=range(3), progress=True)
    assert re.search(r"3 of 3 runs, .* a second, 0 s\s*\n$", capsys.readouterr().err)


def test_as_a_program_it_says_where_the_command_is() -> None:
    done = subprocess.run([sys.executable, "-m", "rumbo", "replay", "one.mcap"], capture_output=True, text=True)
    assert done.returncode == 2 and "rumbo replay" in done.stderr and "rumbo.read_log" in done.stderr


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
    assert repr(log).startswith(f"<log of mode1: {len(log.signals['t_s'])} rows of ") and len(repr(log)) < 100
    shown = log._repr_html_()
    assert "<td>mode1</td>" in shown and shown.count("<polyline") >= 2 and len(shown) < 20_000


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no forks here")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_runs_work_in_a_fork() -> None:
    before = rumbo.run("mode1", seeds=[1, 2], threads=2).metrics
    child = os.fork()
    if child == 0:
        ok = rumbo.run("mode1", seeds=[1, 2], threads=2).metrics.keys() == before.keys()
        os._exit(0 if ok else 1)
    assert os.waitpid(child, 0)[1] == 0
