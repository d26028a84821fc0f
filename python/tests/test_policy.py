"""Policies: the robot's own integers."""

from __future__ import annotations

import copy
import json
import os
import pathlib
import pickle
import subprocess

import numpy as np
import pytest

import rumbo
import rumbo.envs


def test_a_policy_decides_in_integers_and_the_same_from_its_content() -> None:
    policy, content = rumbo.Policy("goal"), rumbo.load("policy", "goal")
    observations = np.random.default_rng(1).normal(size=(200, 14)).astype(np.float32)
    decided = policy.decide(observations)
    assert decided.dtype == np.int8 and decided.shape == (200, 3)
    assert decided.min() >= -127 and len(np.unique(decided)) > 50
    assert np.array_equal(rumbo.Policy(content).decide(observations), decided)
    assert np.allclose(policy(observations), decided / 127)
    assert policy.title == content["title"]
    assert len(policy.decide(np.zeros((0, 14), np.float32))) == 0


def test_the_neurons_are_those_of_the_file() -> None:
    content = {
        "title": "Turns towards the goal",
        "input": [{"of": "goal_left_m", "centre": 0.0, "scale": 1.0}],
        "layer": [{"neurons": [[6, 0, -32], [6, 0, 32], [0, 0, 0]]}],
    }
    observations = np.zeros((3, 14), np.float32)
    observations[:, rumbo.OBSERVED.index("goal_left_m")] = [0.0, 0.5, -9.0]
    # Half an input of 64 or -127, rounded up.
    assert rumbo.Policy(content).decide(observations).tolist() == [[0, 0, 0], [-32, 32, 0], [64, -63, 0]]


@pytest.mark.parametrize(
    ("observations", "message"),
    [
        (np.zeros(14), r"observations has the shape \(14,\): must be \(robots, 14\)"),
        (np.zeros((2, 13)), r"observations has the shape \(2, 13\)"),
        (np.full((2, 14), np.nan), r"observations\[0, 0\] = nan: must be a finite number"),
        (np.where(np.arange(28).reshape(2, 14) == 17, np.inf, 0), r"observations\[1, 3\] = inf"),
    ],
)
def test_observations_of_another_shape_or_without_sense_are_refused(observations: object, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        rumbo.Policy("goal").decide(observations)  # type: ignore[arg-type]


def test_a_sweep_takes_a_policy_as_a_run_does() -> None:
    content = rumbo.load("policy", "goal")
    content["title"] = "another"
    swept = rumbo.sweep("mode9-random", {"kv": [0.02]}, seeds=2, policy=content)
    run = rumbo.run("mode9-random", seeds=2, parameters={"kv": 0.02}, policy=content)
    assert swept.metrics["time_s"].tolist() == run.metrics["time_s"].tolist()
    with pytest.raises(ValueError, match="unknown policy `gaol`"):
        rumbo.sweep("mode9-random", {"kv": [0.02]}, policy="gaol")


def test_what_is_no_policy_is_refused() -> None:
    content = rumbo.load("policy", "goal")
    for change, message in [
        ({"layer": content["layer"][:2]}, "is no network"),
        ({"input": content["input"][1:]}, "16 weights: must be 15"),
        ({"title": 3}, "title"),
    ]:
        with pytest.raises(ValueError, match=message):
            rumbo.Policy(content | change)
    with pytest.raises(ValueError, match="unknown policy `gaol`; did you mean `goal`"):
        rumbo.Policy("gaol")
    with pytest.raises(OSError, match=r"none\.toml"):
        rumbo.Policy("none.toml")


def test_the_integers_reach_goals_in_unseen_worlds() -> None:
    policy, count = rumbo.Policy("goal"), 60
    envs = rumbo.envs.GoalVectorEnv(count, autoreset_mode="Disabled")
    observations, _ = envs.reset(seed=3_000_000)
    waiting = np.zeros((count, 3), np.float32)
    arrived, over = np.zeros(count, bool), np.zeros(count, bool)
    core = envs._core
    while not over.all():
        done = core.step(waiting, ~over)
        arrived |= ~over & done.terminated & (done.reward > 5)
        over |= done.terminated | done.truncated
        waiting, observations = policy(observations), core.known()
    envs.close()
    assert arrived.mean() >= 0.82


@pytest.mark.skipif("RUMBO_COMMAND" not in os.environ, reason="no command to compare with")
def test_an_exported_network_is_refused_or_becomes_a_policy(tmp_path: pathlib.Path) -> None:
    network = {
        "inputs": [{"of": "goal_left_m", "centre": 0, "scale": 1}],
        "layers": [{"weights": [[-0.5], [0.5], [0]], "biases": [0, 0, 0]}],
        "activation": "clip",
    }
    given, made = tmp_path / "network.json", tmp_path / "policy.toml"

    def export(text: str) -> subprocess.CompletedProcess[str]:
        given.write_text(text)
        command = [os.environ["RUMBO_COMMAND"], "export-policy", str(given), "--out", str(made)]
        return subprocess.run(command, capture_output=True, text=True)

    assert export(json.dumps(network)).returncode == 0
    assert rumbo.Policy(made).decide(np.ones((1, 14), np.float32)).tolist() == [[-63, 64, 0]]
    runs = rumbo.run("mode9-random", policy=made, seeds=1)
    assert not runs[0].metrics["reached"]
    for wrong in ["", "[]", json.dumps(network).replace("-0.5", "NaN"), json.dumps(network | {"bias": 1})]:
        refused = export(wrong)
        assert refused.returncode == 2 and "is no network" in refused.stderr, wrong
    refused = export(json.dumps(network).replace("-0.5", "1e300"))
    assert refused.returncode == 2 and "neuron 1 of layer 1" in refused.stderr
    # From Python the same, bit for bit, also of arrays.
    layer = {"weights": np.array([[-0.5], [0.5], [0]], np.float32), "biases": np.zeros(3)}
    python = tmp_path / "python.toml"
    policy = rumbo.export_policy(network | {"layers": [layer]}, python)
    assert python.read_bytes() == made.read_bytes()
    with pytest.raises(FileExistsError):
        rumbo.export_policy(network, python)
    given.write_text(json.dumps(network))
    for one in (policy, rumbo.export_policy(given), pickle.loads(pickle.dumps(policy)), copy.deepcopy(policy)):
        assert one.decide(np.ones((1, 14), np.float32)).tolist() == [[-63, 64, 0]]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"activation": "tanh"}, 'activation = "tanh": the robot\'s neurons are clipped'),
        ({"activation": None}, "invalid type: null"),
        ({"layers": [{"weights": [[0.0]] * 64, "biases": [0.0] * 64}]}, "neurons of layer 1: there are 64, must be 3"),
        ({"inputs": [{"of": "goal_left_m", "centre": 0, "scale": 0}]}, "scale of goal_left_m = 0: must be .* above 0"),
        ({"inputs": [{"of": "target_range_m", "centre": 0, "scale": 1}]}, "mode 9 has no source for it: .* a goal"),
    ],
)
def test_what_the_robot_cannot_evaluate_is_refused_with_its_place(change: dict[str, object], words: str) -> None:
    network = {
        "activation": "clip",
        "inputs": [{"of": "goal_left_m", "centre": 0, "scale": 1}],
        "layers": [{"weights": [[-0.5], [0.5], [0]], "biases": [0, 0, 0]}],
    }
    with pytest.raises(ValueError, match=words):
        rumbo.export_policy(network | change)


def test_every_setpoint_that_the_robot_has_no_source_for_is_refused() -> None:
    for task in rumbo.envs._tasks.ALL.values():
        for name in {*task.names} - {"goal_ahead_m", "goal_left_m", "nothing"}:
            layer = {"weights": [[0.0]] * 3, "biases": [0.0] * 3}
            network = {"activation": "clip", "inputs": [{"of": name, "centre": 0, "scale": 1}], "layers": [layer]}
            with pytest.raises(ValueError, match=f"network: input `{name}`: mode 9 has no source for it"):
                rumbo.export_policy(network)
