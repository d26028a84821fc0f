"""Rumbo's simulator of a small differential-drive robot.

`run` repeats a scenario with many seeds, `sweep` over its parameters, `compare` as variants, `tune` searches for
values, `Sim` and `Batch` step robots by hand, `Sim` also one that an Arduino sketch drives, with its pins and ports;
`read_log` reads what was recorded, `identify` finds a robot's parameters in it; `rumbo.envs` has environments
for Gymnasium and PettingZoo, `rumbo.ray` clusters for sweeps, `rumbo.pytest_plugin` a fixture for tests of sketches.
Units are SI and stand in the names: ``range_m``, ``speed_rad_s``. x is forward, y to the left, angles
counter-clockwise.
"""

from __future__ import annotations

import json
from typing import Any, Literal

from . import _rumbo
from ._board import ExpectationError, Pin, Serial
from ._identify import Identification, Identified, identify
from ._log import Log, read_log
from ._policy import Policy, export_policy
from ._rumbo import Snapshot
from ._run import Run, Runs, run
from ._setup import Source, compile_sketch
from ._sim import OBSERVED, TRUE, Batch, Sim
from ._study import Comparison, Difference, Interrupted, Sweep, compare, sweep
from ._tune import Tuning, tune

__version__: str = _rumbo.VERSION
#: Number of the model: runs are comparable bit for bit only within one.
MODEL: int = _rumbo.MODEL
#: A fault in words, by the number that the column and the info ``fault`` have.
FAULTS: dict[int, str] = dict(_rumbo.FAULTS)
#: Largest range that the robot's program uses [m]: what it takes a clear range for.
REACH_M: float = _rumbo.REACH_M
#: Fastest wheel speed that a robot is commanded, either way [rad/s].
MAX_WHEEL_RAD_S: float = _rumbo.MAX_WHEEL_RAD_S

__all__ = [
    "FAULTS",
    "MAX_WHEEL_RAD_S",
    "MODEL",
    "OBSERVED",
    "REACH_M",
    "TRUE",
    "Batch",
    "Comparison",
    "Difference",
    "ExpectationError",
    "Identification",
    "Identified",
    "Interrupted",
    "Log",
    "Pin",
    "Policy",
    "Run",
    "Runs",
    "Serial",
    "Sim",
    "Snapshot",
    "Source",
    "Sweep",
    "Tuning",
    "__version__",
    "compare",
    "compile_sketch",
    "export_policy",
    "identify",
    "load",
    "names",
    "read_log",
    "run",
    "sweep",
    "tune",
]


def names(kind: Literal["robot", "world", "scenario", "policy", "parameter"]) -> list[str]:
    """Names of the built-in robots, worlds, scenarios or policies, or of all parameters."""
    return _rumbo.names(kind)


def load(kind: Literal["robot", "world", "scenario", "policy"], name_or_path: str) -> dict[str, Any]:
    """The content of a robot, world, scenario or policy file, checked, to be changed and given to `run` and others.

    Raises:
        ValueError: An unknown name, with the near ones, or whatever is wrong with the file.
        FileNotFoundError, OSError: A file that is not there, or cannot be read.
    """
    content: dict[str, Any] = json.loads(_rumbo.load(kind, name_or_path))
    return content
