"""Sweeps and comparisons from Python are those of the command line."""

from __future__ import annotations

import csv
import json
import pathlib
import subprocess

import numpy as np
import pytest

import rumbo


def test_a_sweep_has_the_rows_of_the_command(rumbo_command: str, tmp_path: pathlib.Path) -> None:
    words = ["sweep", "mode5", "kv=0.01:0.04:3", "battery.open_circuit_v=7.0,8.0", "--runs", "2", "--seed", "5"]
    done = subprocess.run([rumbo_command, *words, "--out", str(tmp_path)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    with open(tmp_path / "runs.csv", newline="") as table:
        rows = list(csv.DictReader(table))
    axes = {"kv": "0.01:0.04:3", "battery.open_circuit_v": np.array([7.0, 8.0])}
    sweep = rumbo.sweep("mode5", axes, seeds=[5, 6])
    columns = sweep.to_dict()
    assert len(sweep) == len(rows) == 12
    assert sweep.points["kv"].tolist() == [0.01, 0.01, 0.025, 0.025, 0.04, 0.04]
    for index, row in enumerate(rows):
        assert row.pop("passed") == str(columns["passed"][index]).lower()
        for name, text in row.items():
            value = columns[name][index]
            assert np.isnan(value) if text == "" else float(text) == value, name


def test_points_are_drawn_as_by_the_command_and_repeat() -> None:
    axes = {"kv": "0.01:0.1:log", "ka": "0:0.02"}
    one, other = (rumbo.sweep("mode1", axes, design="sobol", points=8, seeds=s, threads=1) for s in (1, 2))
    again = rumbo.sweep("mode1", axes, design="sobol", points=8, seeds=1, threads=2)
    assert one.points["kv"].tolist() == again.points["kv"].tolist() != other.points["kv"].tolist()
    assert all(np.array_equal(one.metrics[name], again.metrics[name], equal_nan=True) for name in one.metrics)
    assert ((one.points["kv"] >= 0.01) & (one.points["kv"] <= 0.1)).all()


def test_choices_are_named_in_the_table_too(rumbo_command: str, tmp_path: pathlib.Path) -> None:
    words = ["sweep", "mode1", "rig=front_pair,front_single", "mission_reset_origin=yes", "--runs", "1"]
    subprocess.run([rumbo_command, *words, "--out", str(tmp_path)], check=True, capture_output=True)
    with open(tmp_path / "runs.csv", newline="") as table:
        rows = list(csv.DictReader(table))
    for rigs in (["front_pair", "front_single"], "front_pair,front_single"):
        sweep = rumbo.sweep("mode1", {"rig": rigs, "mission_reset_origin": ["yes"]}, seeds=1)
        columns = sweep.to_dict()
        assert columns["rig"].tolist() == [row["rig"] for row in rows] == ["front_pair", "front_single"]
        assert columns["mission_reset_origin"].tolist() == [row["mission_reset_origin"] for row in rows] == ["yes"] * 2
        assert "front_single" in sweep._repr_html_()


def test_seeds_are_those_that_are_given() -> None:
    sweep = rumbo.sweep("mode1", {"front_kp": [4, 5]}, seeds=[9, 3])
    assert sweep.seeds.tolist() == [9, 3, 9, 3]
    runs = rumbo.run("mode1", seeds=[9, 3], parameters={"front_kp": 5})
    assert sweep.metrics["step1.settling_s"].tolist()[2:] == runs.metrics["step1.settling_s"].tolist()


def test_progress_is_called_and_may_end_the_sweep() -> None:
    class Enough(Exception):
        pass

    def count(done: int, _: int) -> None:
        if done == 3:
            raise Enough

    with pytest.raises(Enough):
        rumbo.sweep("mode1", {"front_kp": "1:20:50"}, progress=count)


@pytest.mark.parametrize(
    ("axes", "settings", "why"),
    [
        ({"front_kpp": [1, 2]}, {}, "front_kp"),
        ({"front_kp": "5:1:3"}, {}, "from a lower to a higher"),
        ({"front_kp": "1:20"}, {}, "needs a count"),
        ({"front_kp": [1, 1]}, {}, "twice"),
        ({"front_kp": [1, 500]}, {}, "must be within"),
        ({"front_kp": [float("nan")]}, {}, "finite"),
        ({"front_kp": "1:20"}, {"design": "sobol"}, "needed for them"),
        ({"front_kp": "1:20:3"}, {"points": 5}, "is for drawn ones"),
        ({"front_kp": "1:20:3"}, {"seeds": []}, "seeds is empty"),
        ({"front_kp": "1:20"}, {"design": "sobol", "points": 0}, "at least 1"),
        ({"front_kp": [[1]]}, {}, "front_kp.*must be numbers, names of a choice"),
        ({"rig": ["front"]}, {}, "front_pair"),
        ({}, {}, "axes is empty"),
        ({"front_kp": "1:20:3"}, {"design": "other", "points": 2}, "must be"),
    ],
)
def test_a_sweep_without_sense_is_refused(axes: dict[str, object], settings: dict[str, object], why: str) -> None:
    with pytest.raises(ValueError, match=why):
        rumbo.sweep("mode1", axes, **settings)  # type: ignore[arg-type]


def test_a_comparison_is_that_of_the_command(rumbo_command: str) -> None:
    words = ["compare", "mode5", "--with", "kv=0", "--with", "kv=0.02", "--runs", "4", "--json"]
    done = subprocess.run([rumbo_command, *words], capture_output=True, text=True)
    printed = {one["metric"]: one for one in json.loads(done.stdout)["differences"]}
    variants = {"none": {"parameters": {"kv": 0}}, "some": {"parameters": {"kv": 0.02}}}
    counts: list[tuple[int, int]] = []
    comparison = rumbo.compare("mode5", variants, seeds=range(1, 5), progress=lambda *count: counts.append(count))
    assert counts == [(done, 8) for done in range(1, 9)]
    assert repr(comparison).startswith("<2 variants, 4 runs of each: passed none ")
    shown = comparison._repr_html_()
    assert "some, median" in shown and shown.count("<tr>") == 1 + len(comparison.differences["some"])
    found = comparison.differences["some"]
    assert found.keys() == printed.keys()
    assert found["step1.rise_s"].better == 1.0
    for name, one in found.items():
        expected = printed[name]
        assert (one.pairs, list(one.never)) == (expected["pairs"], expected["never"])
        if expected["mean"] is not None:
            assert one.mean == expected["mean"]
    with pytest.raises(ValueError, match="needs two of each"):
        rumbo.compare("mode5", {"one": {}})
