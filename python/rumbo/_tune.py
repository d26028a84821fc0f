"""Values of control parameters that serve an aim on many drawn robots."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from . import _rumbo
from ._progress import shown
from ._setup import Parameters, Source, make_seeds, make_setup
from ._study import Difference


@dataclass(frozen=True)
class Tuning:
    """What a search found, and what it bought on robots that it had not seen."""

    #: The values found, by parameter: they can be the ``parameters=`` of `run`, or go into a robot's ``"parameters"``.
    values: dict[str, float]
    #: Those of the start.
    now: dict[str, float]
    #: Runs of the search.
    runs: int
    #: Seeds of the robots that the search has not seen, shape (robots,).
    seeds: NDArray[np.uint64]
    #: How many of them pass and keep the limits of the aims, with the values of the start and with those found.
    passed_now: int
    passed: int
    #: What the values found change on them, by metric: found minus start, pair by pair.
    differences: dict[str, Difference]

    def __repr__(self) -> str:
        values = ", ".join(f"{name} = {value:g}" for name, value in self.values.items())
        return f"<{values}: {self.passed} of {len(self.seeds)} passed, {self.passed_now} before>"


def tune(
    scenario: Source,
    over: str | Iterable[str],
    aims: str | None = None,
    *,
    runs: int | None = None,
    seeds: int | Iterable[int] = range(1_000_001, 1_000_101),
    parameters: Parameters | None = None,
    robot: Source | None = None,
    world: Source | None = None,
    rig: str | None = None,
    threads: int | None = None,
    progress: bool | Callable[[float], object] = False,
) -> Tuning:
    """Searches for values of control parameters that serve an aim on many drawn robots, as ``rumbo tune`` does.

    Args:
        scenario: As for `run`, like everything not named here.
        over: Parameters of the control core: ``"front_kp"`` is searched from an eighth of its value to eight times it,
            ``"front_kp=1:20"`` within a range. Several in a list, or with commas between them.
        aims: Metrics that become small (large, where more is better), and limits besides the scenario's own:
            ``"settling_s, overshoot_m < 0.01"``. Without it all limits are kept with as much room as possible.
        runs: Most runs of the search, 2,000 or more; 500,000 s of driving by default.
        seeds: As for `run`: two or more robots that are driven with the values of the start and with those found. The
            search drives others, of the million seeds before the first of these. The result depends on the arguments
            alone, not on threads or time.
        progress: ``True`` shows the share of the runs that are used on stderr, and the time left; a function is called
            with it, 0 to 1.

    Raises:
        ValueError: A parameter or metric that does not exist, with the near ones; a range out of its parameter's
            limits; a parameter that the scenario sets itself; seeds that the search drives. Nothing has been searched.
        KeyboardInterrupt: Ctrl-C, as soon as the runs under way are over.
    """
    numbers = make_seeds(seeds)
    if len(numbers) < 2:
        raise ValueError(f"{len(numbers)} seeds: a check needs two or more")
    setup = make_setup(scenario, robot=robot, world=world, rig=rig, parameters=parameters)
    with shown(progress, " of the runs, at most") as show:
        found = _rumbo.tune(
            setup,
            over.split(",") if isinstance(over, str) else list(over),
            aims=aims,
            runs=runs,
            held_out=numbers,
            threads=threads,
            progress=show,
        )
    passed_now, passed = found["passed"]
    differences = [Difference(**one) for one in _rumbo.differences(*found["metrics"])]
    return Tuning(
        values={name: value for name, _, value in found["values"]},
        now={name: value for name, value, _ in found["values"]},
        runs=found["runs"],
        seeds=np.array(found["seeds"], dtype=np.uint64),
        passed_now=passed_now,
        passed=passed,
        differences={one.metric: one for one in differences},
    )
