"""Many runs of one scenario: over its parameters, and of variants against each other."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from . import _display, _rumbo
from ._cluster import Cluster, Row, connected, run_on
from ._progress import counted
from ._run import Runs, run
from ._setup import Parameters, Program, Source, make_seeds, make_setup, pack_setup

#: Values of a parameter: each of them, ``"FROM:TO:COUNT"``, ``"FROM:TO:COUNT:log"``, or where points are drawn
#: ``"FROM:TO"`` and ``"FROM:TO:log"``; of a switch or a choice names, ``["straight", "pure_pursuit"]``.
Values: TypeAlias = "str | Sequence[float | str] | NDArray[Any]"


@dataclass(frozen=True)
class Sweep:
    """The runs of a sweep as columns, in the order of the points and, within a point, of the seeds."""

    #: The values at each point, an array of shape (points,) for each parameter: numbers, or the names of a switch's or
    #: a choice's values.
    points: dict[str, NDArray[Any]]
    #: Number of each run's point, shape (runs,).
    point: NDArray[np.int64]
    #: Seed of each run, shape (runs,).
    seeds: NDArray[np.uint64]
    #: Whether each run passed, shape (runs,).
    passed: NDArray[np.bool_]
    #: An array of shape (runs,) for each metric; NaN where what is measured did not happen.
    metrics: dict[str, NDArray[np.float64]]
    #: Of what was to be run, on which model: the sweeps with the same one have the same runs.
    fingerprint: str

    def __len__(self) -> int:
        return len(self.seeds)

    def __repr__(self) -> str:
        names = ", ".join(self.points)
        return f"<{len(self)} runs over {names}: {int(self.passed.sum())} passed>"

    def _repr_html_(self) -> str:
        return _display.columns(repr(self), self.to_dict())

    def to_dict(self) -> dict[str, NDArray[Any]]:
        """Columns as `pandas.DataFrame` and `pyarrow.table` take them: ``point``, ``seed``, each parameter, ``passed``,
        each metric; as in the tables of ``rumbo sweep``."""
        values = {name: column[self.point] for name, column in self.points.items()}
        return {"point": self.point, "seed": self.seeds, **values, "passed": self.passed, **self.metrics}


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a sweep."""

    def __init__(self, done: Sweep) -> None:
        super().__init__(f"{len(done)} runs are done; they are in `done`, and `sweep` goes on with `resume=`")
        #: The runs that are done. It can be pickled.
        self.done = done


def sweep(
    scenario: Source,
    axes: Mapping[str, Values],
    *,
    design: Literal["grid", "random", "sobol"] = "grid",
    points: int | None = None,
    seeds: int | Iterable[int] = range(1, 11),
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
    cluster: str | Cluster | None = None,
    resume: Sweep | None = None,
    progress: bool | Callable[[int, int], object] = False,
) -> Sweep:
    """Runs a scenario at many values of its parameters, each point with the same seeds, as ``rumbo sweep`` does.

    Args:
        scenario: As for `run`, like everything not named here.
        axes: Parameters (`rumbo.names("parameter")`) and their values.
        design: Every combination, or as many points as asked for: drawn independently, or of a Sobol sequence.
        points: How many are drawn; for a grid none.
        seeds: As for `run`, the same at each point. The first one draws the points, too.
        cluster: Where it runs in place of the threads of this process: ``"local"`` for worker processes on this machine
            (``threads=`` of them), the address of a Ray cluster, or a `rumbo.ray.Cluster`. It needs the extra ``ray``,
            and does not change the numbers.
        resume: What is done of the same sweep (`Interrupted.done`): the other runs are added.

    Raises:
        ValueError: An unknown parameter, with the near ones; none at all; values without sense or out of range. Nothing
            has run then.
        Interrupted: Ctrl-C, as soon as the runs under way are over; a ``KeyboardInterrupt`` that has what is done.
        ModuleNotFoundError: A cluster, and Ray is not installed.
    """
    if (points is None) != (design == "grid"):
        raise ValueError(
            f"points = {points}: a number of points is for drawn ones, and needed for them; design = {design!r}"
        )
    if points is not None and points < 1:
        raise ValueError(f"points = {points}: must be at least 1")
    if not axes:
        raise ValueError("axes is empty: give at least one parameter and its values")
    numbers = make_seeds(seeds)
    runs = len(numbers)
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
    names = list(axes)
    words = [f"{name}={_text(name, values)}" for name, values in axes.items()]
    places = _rumbo.plan(setup, words, design=design, count=points or 0, seed=numbers[0], runs=runs)
    table = _Table(names, np.array(places, dtype=np.float64).reshape(len(places), len(names)), numbers, setup)
    if resume is not None:
        table.add(resume)
    missing = [index for index in range(len(places) * runs) if index not in table.rows]
    jobs = [(places[index // runs], numbers[index % runs]) for index in missing]
    try:
        with counted(progress, len(places) * runs, len(table.rows)) as show:

            def keep(number: int, row: Row) -> None:
                table.rows[missing[number]] = row
                if show is not None:
                    show(len(table.rows))

            if cluster is None:
                order = iter(range(len(jobs)))
                _rumbo.run_jobs(
                    setup, names, jobs, threads=threads, handle=lambda passed, found: keep(next(order), (passed, found))
                )
            else:
                with connected(cluster, threads) as workers:
                    run_on(workers, setup, names, jobs, keep)
    except KeyboardInterrupt:
        raise Interrupted(table.sweep()) from None
    return table.sweep()


@dataclass
class _Table:
    """The runs of a sweep by their number: those of the first point, then those of the second."""

    names: list[str]
    #: Shape (points, axes).
    values: NDArray[np.float64]
    #: Of the runs of each point.
    seeds: list[int]
    setup: _rumbo.Setup
    rows: dict[int, Row] = field(default_factory=dict)

    def fingerprint(self) -> str:
        model = (_rumbo.VERSION, _rumbo.MODEL)
        what = (model, pack_setup(self.setup), self.names, self.values.tolist(), self.seeds)
        return hashlib.sha256(repr(what).encode()).hexdigest()

    def add(self, done: Sweep) -> None:
        if done.fingerprint != self.fingerprint():
            raise ValueError("resume: is of another sweep; give the same arguments, or leave it out")
        places = {seed: place for place, seed in enumerate(self.seeds)}
        for row, (point, seed) in enumerate(zip(done.point.tolist(), done.seeds.tolist())):
            metrics = {name: float(column[row]) for name, column in done.metrics.items()}
            self.rows[point * len(self.seeds) + places[seed]] = (bool(done.passed[row]), metrics)

    def sweep(self) -> Sweep:
        indices = sorted(self.rows)
        rows = [self.rows[index] for index in indices]
        metrics = sorted({name for _, found in rows for name in found})
        return Sweep(
            points={name: _named(name, self.values[:, axis]) for axis, name in enumerate(self.names)},
            point=np.array([index // len(self.seeds) for index in indices], dtype=np.int64),
            seeds=np.array([self.seeds[index % len(self.seeds)] for index in indices], dtype=np.uint64),
            passed=np.array([passed for passed, _ in rows], dtype=np.bool_),
            metrics={name: np.array([found.get(name, np.nan) for _, found in rows]) for name in metrics},
            fingerprint=self.fingerprint(),
        )


def _text(name: str, values: Values) -> str:
    if isinstance(values, str):
        return values
    try:
        return ",".join(value if isinstance(value, str) else repr(float(value)) for value in values)
    except (TypeError, ValueError):
        raise ValueError(f"{name} = {values!r}: must be numbers, names of a choice, or text") from None


def _named(name: str, values: NDArray[np.float64]) -> NDArray[Any]:
    """The values of a parameter, a switch's or a choice's by name."""
    names = _rumbo.value_names(name)
    return np.array(names)[np.rint(values).astype(np.int64)] if names else values.copy()


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

    def __repr__(self) -> str:
        passed = ", ".join(f"{name} {int(runs.passed.sum())}" for name, runs in self.runs.items())
        runs = len(next(iter(self.runs.values())))
        return f"<{len(self.runs)} variants, {runs} runs of each: passed {passed}>"

    def _repr_html_(self) -> str:
        return _display.comparison(self)


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
        seeds: As for `run`, two or more.
        progress: As for `run`, of the runs of all variants.

    Raises:
        ValueError: As for `run`; fewer than two variants or seeds.
    """
    numbers = make_seeds(seeds)
    if len(variants) < 2 or len(numbers) < 2:
        raise ValueError(f"{len(variants)} variants, {len(numbers)} seeds: a comparison needs two of each")
    done: dict[str, Runs] = {}
    with counted(progress, len(variants) * len(numbers)) as show:
        for name, settings in variants.items():
            before = len(done) * len(numbers)

            def of_all(finished: int, _: int, before: int = before) -> None:
                if show is not None:
                    show(before + finished)

            done[name] = run(scenario, seeds=numbers, threads=threads, progress=of_all, **settings)
    first, *others = done
    metrics = {name: [one.metrics for one in runs] for name, runs in done.items()}
    found = {
        other: {one["metric"]: Difference(**one) for one in _rumbo.differences(metrics[first], metrics[other])}
        for other in others
    }
    return Comparison(runs=done, differences=found)
