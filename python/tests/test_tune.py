"""Tuning from Python is that of the command line."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from typing import Any

import pytest

import rumbo

AIMS = "settling_s, overshoot_m < 0.02"


def test_a_tuning_is_that_of_the_command(rumbo_command: str) -> None:
    # A gain that is too low.
    words = ["tune", "mode1", "--for", AIMS, "--over", "front_kp,front_brake_m_s2=0.1:0.6", "--param", "front_kp=1.5"]
    words += ["--runs", "2000", "--held-out", "10", "--seed", "3", "--json"]
    done = subprocess.run([rumbo_command, *words], capture_output=True, text=True)
    printed = json.loads(done.stdout)
    shares: list[float] = []
    over = ["front_kp", "front_brake_m_s2=0.1:0.6"]
    settings: dict[str, Any] = {"runs": 2000, "seeds": range(1_000_003, 1_000_013), "parameters": {"front_kp": 1.5}}
    tuning = rumbo.tune("mode1", over, AIMS, progress=shares.append, **settings)
    assert tuning.values == {one["name"]: one["tuned"] for one in printed["parameters"]}
    assert tuning.now == {one["name"]: one["now"] for one in printed["parameters"]}
    assert tuning.runs == printed["runs"]
    assert tuning.seeds.tolist() == printed["held_out"]["seeds"]
    assert [tuning.passed_now, tuning.passed] == [printed["held_out"][key] for key in ("passed_now", "passed_tuned")]
    for expected in printed["differences"]:
        assert tuning.differences[expected["metric"]].mean == pytest.approx(expected["mean"], rel=0, abs=0, nan_ok=True)
    assert shares == sorted(shares) and shares[0] > 0 and shares[-1] <= 1
    assert tuning.differences["step1.settling_s"].better > 0.5
    # And once more as parameters of a run.
    run = rumbo.run("mode1", seeds=tuning.seeds.tolist(), parameters=tuning.values)
    # The aims may ask for more than the scenario.
    assert run.passed.sum() >= tuning.passed > 0


@pytest.mark.parametrize(
    ("over", "settings", "why"),
    [
        ("front_kpp", {}, "front_kp"),
        ("front_kp=30:40", {}, "must lie within"),
        ("front_kp=1:2:3", {}, "is searched in a range"),
        (["front_kp", "front_kp"], {}, "given twice"),
        ("front_kp", {"aims": "settling"}, "settling_s"),
        ("front_kp", {"aims": "settling_s <"}, "is not a number"),
        ("front_kp", {"runs": 100}, "at least 2000"),
        ("front_kp", {"seeds": 1}, "1 seeds: a check needs two or more"),
        ("front_kp", {"threads": 0}, "must be 1 to"),
    ],
)
def test_a_tuning_without_sense_is_refused(over: Any, settings: dict[str, Any], why: str) -> None:
    with pytest.raises(ValueError, match=why):
        rumbo.tune("mode1", over, **settings)


def test_a_parameter_that_the_scenario_sets_is_not_tuned() -> None:
    scenario = rumbo.load("scenario", "mode1")
    scenario["parameters"] = {"front_kp": 5.0}
    with pytest.raises(ValueError, match="sets it itself"):
        rumbo.tune(scenario, "front_kp")


def test_an_error_of_progress_ends_the_search() -> None:
    class Enough(Exception):
        pass

    def stop(_: float) -> None:
        raise Enough

    with pytest.raises(Enough):
        rumbo.tune("mode1", "front_kp", runs=1_000_000, progress=stop)


def test_control_c_ends_a_search() -> None:
    act = "rumbo.tune('mode1', 'front_kp', runs=10_000_000, progress=lambda share: print('go', flush=True))"
    code = f"import rumbo; {act}"
    with subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as search:
        assert search.stdout is not None and search.stderr is not None
        assert search.stdout.readline() == "go\n"
        time.sleep(0.2)
        search.send_signal(signal.SIGINT)
        _, errors = search.communicate(timeout=60)
    assert search.returncode != 0 and errors.rstrip().endswith("KeyboardInterrupt")
