"""Runs of a scenario from start to end."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from . import _display, _rumbo
from ._progress import counted
from ._setup import Parameters, Program, Source, make_seeds, make_setup


@dataclass(frozen=True)
class Run:
    """One run, judged against the limits of its scenario."""

    #: Name of the scenario.
    scenario: str
    #: The seed: of the robot that was drawn, of a random world, and of all noise.
    seed: int
    #: No limit is missed, and the robot refused nothing and reported no fault.
    passed: bool
    #: Metrics by name, units in the names; NaN where what is measured did not happen.
    metrics: dict[str, float]
    #: Why it did not pass.
    failures: tuple[str, ...]
    #: Notes for the reader.
    notes: tuple[str, ...]
    #: Ground truth every 10 ms, an array for each signal; ``None`` unless `run` was called with ``trace=True``.
    #: ``t_s`` [s], ``x_m``, ``y_m`` [m], ``heading_rad`` [rad, turns add up], ``left_rad_s``, ``right_rad_s`` [rad/s],
    #: ``range_left_m``, ``range_right_m``, ``range_front_m`` [m, inf where nothing is within reach, NaN without such a
    #: sonar], ``servo_rad``
    #: [rad], ``battery_v`` [V], ``left_duty``, ``right_duty`` [PWM, -255 to 255], ``touching``.
    #: Of several robots each has its own.
    trace: dict[str, NDArray[Any]] | None = None
    #: The runs of the robots, if there are several, each by its name and without limits.
    robots: tuple[Run, ...] = ()

    def __repr__(self) -> str:
        verdict = "passed" if self.passed else f"not passed: {'; '.join(self.failures)}"
        return f"<run of {self.scenario}, seed {self.seed}: {verdict}>"

    def _repr_html_(self) -> str:
        return _display.run(self)


class Runs(Sequence[Run]):
    """Runs in the order of their seeds, also as columns."""

    def __init__(self, runs: Iterable[Run]) -> None:
        self._runs = tuple(runs)

    @overload
    def __getitem__(self, index: int) -> Run: ...
    @overload
    def __getitem__(self, index: slice) -> Runs: ...
    def __getitem__(self, index: int | slice) -> Run | Runs:
        if isinstance(index, slice):
            return Runs(self._runs[index])
        return self._runs[index]

    def __len__(self) -> int:
        return len(self._runs)

    def __iter__(self) -> Iterator[Run]:
        return iter(self._runs)

    def __repr__(self) -> str:
        passed = sum(run.passed for run in self)
        names = ", ".join(sorted({run.scenario for run in self}))
        return f"<{len(self)} runs of {names}: {passed} passed>"

    def _repr_html_(self) -> str:
        return _display.columns(repr(self), self.to_dict())

    @property
    def seeds(self) -> NDArray[np.uint64]:
        """The seeds, shape (runs,)."""
        return np.array([run.seed for run in self], dtype=np.uint64)

    @property
    def passed(self) -> NDArray[np.bool_]:
        """Whether each run passed, shape (runs,)."""
        return np.array([run.passed for run in self], dtype=np.bool_)

    @property
    def metrics(self) -> dict[str, NDArray[np.float64]]:
        """An array of shape (runs,) for each metric that any run has; NaN where a run lacks it."""
        names = {name: None for run in self for name in run.metrics}
        return {name: np.array([run.metrics.get(name, np.nan) for run in self]) for name in names}

    def to_dict(self) -> dict[str, NDArray[Any]]:
        """Columns as `pandas.DataFrame` and `pyarrow.table` take them: ``seed``, ``passed``, then each metric."""
        return {"seed": self.seeds, "passed": self.passed, **self.metrics}


def run(
    scenario: Source,
    *,
    seeds: int | Iterable[int] = 1,
    parameters: Parameters | None = None,
    robot: Source | None = None,
    world: Source | None = None,
    policy: Source | None = None,
    rig: str | None = None,
    program: Program = "rumbo",
    firmware: str | os.PathLike[str] | None = None,
    sketch: str | os.PathLike[str] | None = None,
    libraries: Iterable[str | os.PathLike[str]] = (),
    randomize: bool | None = None,
    threads: int | None = None,
    trace: bool = False,
    progress: bool | Callable[[int, int], object] = False,
) -> Runs:
    """Runs a scenario once for each seed; the numbers are those of ``rumbo run --json``, bit for bit.

    Args:
        scenario: A name (`rumbo.names("scenario")`), a path, or the content of a scenario file as a dictionary, whose
            ``robot``, ``world`` and ``policy`` may be dictionaries.
        seeds: One seed, or any number of them: ``range(1, 101)``. 0 to 2**64 - 1.
        parameters: By name (`rumbo.names("parameter")`): those of the control core, such as ``front_kp``, and of the
            plant, such as ``battery.open_circuit_v``, which then holds for every robot drawn. Switches and choices by
            the names of their values: ``{"rig": "front_pair"}``.
        robot, world, policy: In place of the scenario's: names, paths or dictionaries.
        rig: Another sensor layout of the robot.
        program: ``"rumbo"``, or ``"baseline"`` for the report's program.
        firmware: An image for the emulated board in place of the program: path of an ELF or HEX file.
        sketch, libraries: An Arduino sketch in its place, and what it includes: as for `compile_sketch`.
        randomize: Whether each seed draws its own robot; as the scenario says by default.
        threads: At most this many; one on each core by default. It does not change the numbers.
        trace: Keep the ground truth of each run, about 10 KB for each second of simulated time; see `Run.trace`.
        progress: ``True`` counts the runs on stderr, with their rate and the time left; a function is called with the
            numbers of finished and of all runs.

    Raises:
        ValueError: An unknown name, with the near ones; a value out of range; whatever is wrong with a file, each
            problem on a line of its own. Nothing has run then.
        FileNotFoundError, OSError: A file that is not there, or cannot be read.
        KeyboardInterrupt: Ctrl-C, as soon as the runs under way are over.
    """
    setup = make_setup(
        scenario,
        robot=robot,
        world=world,
        policy=policy,
        rig=rig,
        parameters=parameters,
        program=program,
        firmware=firmware,
        sketch=sketch,
        libraries=libraries,
        randomize=randomize,
    )
    numbers = make_seeds(seeds)
    with counted(progress, len(numbers)) as show:
        results = _rumbo.run(setup, numbers, threads=threads, trace=trace, progress=show)
    return Runs(_run_of(result) for result in results)


def _run_of(result: dict[str, Any]) -> Run:
    return Run(
        scenario=result["scenario"],
        seed=result["seed"],
        passed=result["passed"],
        metrics=result["metrics"],
        failures=tuple(result["failures"]),
        notes=tuple(result["notes"]),
        trace=result.get("trace"),
        robots=tuple(_run_of(robot) for robot in result["robots"]),
    )
