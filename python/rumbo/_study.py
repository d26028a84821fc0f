"""Many runs of one scenario: over its parameters, and of variants against each other."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from . import _rumbo
from ._run import Runs, make_progress, run
from ._setup import Program, Source, make_setup

#: Values of a parameter: each of them, ``"FROM:TO:COUNT"``, ``"FROM:TO:COUNT:log"``, or where points are drawn
#: ``"FROM:TO"`` and ``"FROM:TO:log"``; names of a choice, ``"straight,pure_pursuit"``.
Values: TypeAlias = "str | Sequence[float] | NDArray[Any]"


@dataclass(frozen=True)
class Sweep:
    """The runs of a sweep as columns, in the order of the points and, within a point, of the seeds."""

    #: The values at each point, an array of shape (points,) for each parameter.
    points: dict[str, NDArray[np.float64]]
    #: Number of each run's point, shape (runs,).
    point: NDArray[np.int64]
    #: Seed of each run, shape (runs,).
    seeds: NDArray[np.uint64]
    #: Whether each run passed, shape (runs,).
    passed: NDArray[np.bool_]
    #: An array of shape (runs,) for each metric; NaN where what is measured did not happen.
    metrics: dict[str, NDArray[np.float64]]

    def __len__(self) -> int:
        return len(self.seeds)

    def __repr__(self) -> str:
        names = ", ".join(self.points)
        return f"<{len(self)} runs over {names}: {int(self.passed.sum())} passed>"

    def to_dict(self) -> dict[str, NDArray[Any]]:
        """Columns as `pandas.DataFrame` and `pyarrow.table` take them: ``point``, ``seed``, each parameter, ``passed``,
        each metric; as in the tables of ``rumbo sweep``."""
        values = {name: column[self.point] for name, column in self.points.items()}
        return {"point": self.point, "seed": self.seeds, **values, "passed": self.passed, **self.metrics}


def sweep(
    scenario: Source,
    axes: Mapping[str, Values],
    *,
    design: Literal["grid", "random", "sobol"] = "grid",
    points: int | None = None,
    runs: int = 10,
    seed: int = 1,
    parameters: Mapping[str, float] | None = None,
    robot: Source | None = None,
    world: Source | None = None,
    rig: str | None = None,
    program: Program = "rumbo",
    firmware: str | os.PathLike[str] | None = None,
    randomize: bool | None = None,
    threads: int | None = None,
    progress: bool | Callable[[int, int], object] = False,
) -> Sweep:
    """Runs a scenario at many values of its parameters, each point with the same seeds, as ``rumbo sweep`` does.

    Args:
        scenario: As for `run`, like everything not named here.
        axes: Parameters (`rumbo.names("parameter")`) and their values.
        design: Every combination, or as many points as asked for: drawn independently, or of a Sobol sequence.
        points: How many are drawn; for a grid none.
        runs: Of each point, 1 or more.
        seed: The first one; run i of every point has ``seed + i``. It draws the points, too.

    Raises:
        ValueError: An unknown parameter, with the near ones; values without sense or out of range. Nothing has run.
        KeyboardInterrupt: Ctrl-C, as soon as the runs under way are over.
    """
    if (points is None) != (design == "grid"):
        raise ValueError(
            f"points = {points}: a number of points is for drawn ones, and needed for them; design = {design!r}"
        )
    if runs < 1 or (points is not None and points < 1):
        raise ValueError(f"runs = {runs}, points = {points}: must be at least 1")
    setup = make_setup(
        scenario,
        robot=robot,
        world=world,
        rig=rig,
        parameters=parameters,
        program=program,
        firmware=firmware,
        randomize=randomize,
    )
    names = list(axes)
    places, rows = _rumbo.sweep(
        setup,
        [f"{name}={_text(values)}" for name, values in axes.items()],
        design=design,
        count=points or 0,
        seed=seed,
        runs=runs,
        threads=threads,
        progress=make_progress(progress, None if points is None else points * runs),
    )
    values = np.array(places, dtype=np.float64).reshape(len(places), len(names))
    metrics = {name: None for _, _, _, metrics in rows for name in metrics}
    return Sweep(
        points={name: values[:, index].copy() for index, name in enumerate(names)},
        point=np.array([point for point, _, _, _ in rows], dtype=np.int64),
        seeds=np.array([number for _, number, _, _ in rows], dtype=np.uint64),
        passed=np.array([passed for _, _, passed, _ in rows], dtype=np.bool_),
        metrics={name: np.array([found.get(name, np.nan) for _, _, _, found in rows]) for name in metrics},
    )


def _text(values: Values) -> str:
    if isinstance(values, str):
        return values
    return ",".join(repr(float(value)) for value in values)


@dataclass(frozen=True)
class Difference:
    """A metric of two variants, pair by pair: second minus first."""

    #: Name of the metric.
    metric: str
    #: Pairs in which both have a value.
    pairs: int
    #: Runs of the first and of the second in which what is measured never happened.
    never: tuple[int, int]
    #: Medians of the first and of the second over the pairs.
    medians: tuple[float, float]
    #: Mean of second minus first.
    mean: float
    #: Its 95 % confidence interval (Student's t of the pairs); NaN for fewer than two pairs.
    interval: tuple[float, float]
    #: The mean over the standard deviation of the differences; NaN where they are all the same.
    effect: float
    #: Share of the pairs in which the second is better, and in which it is worse.
    better: float
    worse: float


@dataclass(frozen=True)
class Comparison:
    """Variants that were run with the same seeds."""

    #: The runs of each variant.
    runs: dict[str, Runs]
    #: Each later variant against the first, by metric.
    differences: dict[str, dict[str, Difference]]


def compare(
    scenario: Source,
    variants: Mapping[str, Mapping[str, Any]],
    *,
    seeds: int | Iterable[int] = range(1, 51),
    threads: int | None = None,
    progress: bool | Callable[[int, int], object] = False,
) -> Comparison:
    """Runs variants of a scenario with the same seeds and compares them pair by pair: each pair is of one robot with
    itself.

    Args:
        scenario: As for `run`.
        variants: Two or more: by name, arguments of `run` such as ``{"parameters": {"front_kp": 5}}``,
            ``{"program": "baseline"}`` or ``{}``.
        seeds: Two or more.

    Raises:
        ValueError: As for `run`; fewer than two variants or seeds.
    """
    numbers = [seeds] if isinstance(seeds, int) else list(seeds)
    if len(variants) < 2 or len(numbers) < 2:
        raise ValueError(f"{len(variants)} variants, {len(numbers)} seeds: a comparison needs two of each")
    done = {
        name: run(scenario, seeds=numbers, threads=threads, progress=progress, **settings)
        for name, settings in variants.items()
    }
    first, *others = done
    metrics = {name: [one.metrics for one in runs] for name, runs in done.items()}
    found = {
        other: {one["metric"]: Difference(**one) for one in _rumbo.differences(metrics[first], metrics[other])}
        for other in others
    }
    return Comparison(runs=done, differences=found)
