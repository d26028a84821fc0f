"""The examples of examples/python run in their short form, and draw what they say."""

from __future__ import annotations

import json
import pathlib
import runpy
import subprocess
import sys

import numpy as np
import pytest

EXAMPLES = pathlib.Path(__file__).parents[2] / "examples/python"


def test_the_sweep_draws_bands_a_map_and_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    matplotlib = pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    matplotlib.use("agg")
    from matplotlib import pyplot

    monkeypatch.setenv("RUMBO_SHORT", "1")
    monkeypatch.setattr(pyplot, "show", lambda: None)
    sweep = runpy.run_path(str(EXAMPLES / "sweep.py"))["sweep"]
    assert len(sweep) == 72
    bands, passed, runs = (pyplot.figure(number).axes[0] for number in pyplot.get_fignums())
    # More gain settles sooner, up to a point; too little never does.
    for line in bands.lines:
        times = np.array(line.get_ydata())
        assert times[0] > times[1] > times[2] and np.isfinite(times[1:]).all()
    assert len(bands.lines) == len(bands.collections) == 3
    shares = passed.collections[0].get_array()
    assert shares.shape == (3, 6) and shares.max() == 100 and shares.min() < 100
    assert len(runs.lines) == 3
    for line in runs.lines:
        assert np.ptp(line.get_ydata()) > 0.1
    pyplot.close("all")


def test_a_policy_learns_in_a_minute_to_reach_some_goals_and_is_written(
    monkeypatch: pytest.MonkeyPatch, tmp_path: pathlib.Path
) -> None:
    pytest.importorskip("jax", reason="JAX is not installed")
    monkeypatch.setenv("RUMBO_SHORT", "1")
    monkeypatch.chdir(tmp_path)
    # In a process of its own: JAX has threads, and other tests fork.
    code = (
        "import json, runpy\n"
        f"learned = runpy.run_path({str(EXAMPLES / 'ppo.py')!r})\n"
        "print(json.dumps([float(learned['arrived']), len(learned['INPUTS'])]))"
    )
    run = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    arrived, inputs = json.loads(run.stdout.splitlines()[-1])
    # Without learning it reaches none.
    assert arrived > 0.2
    network = json.loads((tmp_path / "goal.json").read_text())
    assert len(network["inputs"]) == inputs
    assert [len(layer["biases"]) for layer in network["layers"]] == [32, 32, 3]
