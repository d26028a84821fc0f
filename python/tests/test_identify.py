"""Identification from Python is that of the command line."""

from __future__ import annotations

import json
import pathlib
import subprocess
from typing import Any

import pytest

import rumbo


@pytest.fixture(scope="module")
def drive(rumbo_command: str, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """A drive of a simulated robot, and what the command found in it."""
    folder = tmp_path_factory.mktemp("drive")
    words = [rumbo_command, "identify", "--drive", "lab", "--seed", "2001", "--out", str(folder), "--json"]
    printed: dict[str, Any] = json.loads(subprocess.run(words, capture_output=True, check=True).stdout)
    return printed


def test_an_identification_is_that_of_the_command(drive: dict[str, Any]) -> None:
    shares: list[float] = []
    found = rumbo.identify(drive["log"], progress=shares.append)
    assert [list(one.keys) for one in found.parameters.values()] == [one["keys"] for one in drive["parameters"]]
    for expected in drive["parameters"]:
        one = found.parameters[expected["keys"][0]]
        assert (one.value, one.uncertainty, one.from_runs) == tuple(
            expected[key] for key in ("value", "uncertainty", "from_runs")
        )
    assert list(found.runs) == drive["runs"]
    assert shares == sorted(shares) and shares[0] == 0 and shares[-1] <= 1
    # What was found is a robot, and its text a robot file.
    assert "# Identified by `rumbo identify`" in found.toml
    back_emf = found.parameters["motor.back_emf_v_s"]
    assert found.robot["plant"]["motor"]["back_emf_v_s"] == pytest.approx(back_emf.value, rel=1e-3)
    assert back_emf.from_runs > 0.5
    assert rumbo.run("mode1", robot=found.robot)[0].passed


def test_runs_are_repeated_without_a_fit(drive: dict[str, Any]) -> None:
    checked = rumbo.identify([drive["log"]], rumbo.load("robot", "memoria"), fit=False)
    assert checked.parameters == {} and len(checked.runs) == len(drive["runs"])
    assert checked.robot["plant"] == rumbo.load("robot", "memoria")["plant"]


def test_an_error_of_progress_ends_the_fit(drive: dict[str, Any]) -> None:
    class Enough(Exception):
        pass

    def stop(_: float) -> None:
        raise Enough

    with pytest.raises(Enough):
        rumbo.identify(drive["log"], progress=stop)


def test_what_shows_nothing_is_refused(tmp_path: pathlib.Path) -> None:
    with pytest.raises(ValueError, match="logs is empty"):
        rumbo.identify([])
    with pytest.raises(FileNotFoundError, match=r"none\.csv"):
        rumbo.identify(tmp_path / "none.csv")
    other = tmp_path / "other.csv"
    other.write_text("a,b\n1,2\n")
    with pytest.raises(ValueError, match="no columns dt_ms, pwm_a, pwm_b"):
        rumbo.identify(other)
    log = tmp_path / "log.mcap"
    log.write_bytes(b"no log at all")
    with pytest.raises(ValueError, match="is no MCAP log"):
        rumbo.identify(log)
    with pytest.raises(ValueError, match="memoria"):
        rumbo.identify(log, "memorya")
