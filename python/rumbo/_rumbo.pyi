"""The Rust part of `rumbo`: called by the modules beside it, not by users."""

from collections.abc import Callable, Sequence
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "FAULTS",
    "MAX_WHEEL_RAD_S",
    "MODEL",
    "OBSERVED",
    "REACH_M",
    "TRUE",
    "VERSION",
    "Batch",
    "Policy",
    "Setup",
    "Snapshot",
    "apply",
    "compile",
    "differences",
    "edges",
    "ended",
    "identify",
    "is_high",
    "load",
    "names",
    "other_ranges",
    "parts",
    "pin",
    "plan",
    "probe",
    "pulses",
    "quantise",
    "read_log",
    "run",
    "run_jobs",
    "said",
    "share_high",
    "tune",
    "type_in",
    "value_names",
    "vcd",
]

VERSION: str
MODEL: int
OBSERVED: list[str]
TRUE: list[str]
FAULTS: list[tuple[int, str]]
REACH_M: float
MAX_WHEEL_RAD_S: float

@final
class Setup:
    def __new__(
        cls,
        scenario: str,
        *,
        held: Sequence[tuple[str, str, str]],
        robot: str | None,
        world: str | None,
        policy: str | None,
        rig: str | None,
        parameters: Sequence[tuple[str, float | str]],
        program: str,
        firmware: str | None,
        randomize: bool | None,
    ) -> Setup: ...
    @property
    def name(self) -> str: ...
    @property
    def robots(self) -> list[str]: ...
    @property
    def duration_s(self) -> float: ...
    def arguments(self) -> dict[str, Any]: ...
    def __deepcopy__(self, _memo: object) -> Setup: ...

@final
class Snapshot:
    def __len__(self) -> int: ...
    def parts(self) -> tuple[Setup, list[bool], list[int], list[list[bytes]]]: ...
    def __copy__(self) -> Snapshot: ...
    def __deepcopy__(self, _memo: object) -> Snapshot: ...

@final
class Batch:
    def __new__(
        cls,
        setup: Setup,
        seeds: Sequence[int],
        *,
        callers: Sequence[bool],
        threads: int | None,
        histories: Sequence[Sequence[bytes]] | None = None,
        progress: Callable[[float], object] | None = None,
    ) -> Batch: ...
    def __len__(self) -> int: ...
    def __deepcopy__(self, _memo: object) -> Batch: ...
    @property
    def threads(self) -> int: ...
    @property
    def callers(self) -> list[bool]: ...
    @property
    def setup(self) -> Setup: ...
    def seeds(self) -> NDArray[np.uint64]: ...
    def advance(self, ticks: int) -> None: ...
    def observe(self, known: NDArray[np.float32], truth: NDArray[np.float64]) -> None: ...
    def drive(
        self,
        actions: NDArray[np.float32],
        active: NDArray[np.bool_],
        ticks: int,
        known: NDArray[np.float32],
        truth: NDArray[np.float64],
        *,
        pwm: bool = False,
    ) -> None: ...
    def begin(self, indices: Sequence[int], ticks: int) -> None: ...
    def renew(self, indices: Sequence[int], seeds: Sequence[int]) -> None: ...
    def instruct(self, index: int, text: str) -> None: ...
    def aim(self, index: int, servo_rad: float | None) -> None: ...
    def record(self, index: int) -> None: ...
    def log(self, index: int) -> bytes: ...
    def obstacles(self, index: int) -> list[list[list[float]]]: ...
    def fault(self, index: int) -> str | None: ...
    def snapshot(self) -> Snapshot: ...
    def restore(self, snapshot: Snapshot) -> None: ...

@final
class Policy:
    def __new__(cls, name: str, held: Sequence[tuple[str, str, str]]) -> Policy: ...
    @property
    def title(self) -> str: ...
    @property
    def shape(self) -> str: ...
    def arguments(self) -> tuple[str, list[tuple[str, str, str]]]: ...
    def decide(self, observations: NDArray[np.float32], outputs: NDArray[np.int8]) -> None: ...

def compile(
    sketch: str,
    scenario: str,
    *,
    held: Sequence[tuple[str, str, str]],
    robot: str | None,
    libraries: Sequence[str],
) -> tuple[str, list[str]]: ...
def probe(batch: Batch) -> bool: ...
def pin(batch: Batch, name: str) -> int: ...
def parts(batch: Batch) -> dict[str, list[str]]: ...
def other_ranges(batch: Batch) -> list[tuple[str, float]]: ...
def is_high(batch: Batch, pin: int) -> bool: ...
def share_high(batch: Batch, pin: int, from_s: float) -> float: ...
def edges(batch: Batch, pin: int, from_s: float) -> tuple[NDArray[np.float64], NDArray[np.bool_]]: ...
def pulses(batch: Batch, pin: int, from_s: float) -> NDArray[np.float64]: ...
def apply(batch: Batch, pin: int, volts: float | None) -> None: ...
def type_in(batch: Batch, port: str, bytes: bytes) -> None: ...
def said(batch: Batch, port: str, start: int) -> bytes: ...
def ended(batch: Batch) -> str | None: ...
def vcd(batch: Batch) -> bytes: ...
def names(kind: str) -> list[str]: ...
def value_names(parameter: str) -> list[str]: ...
def load(kind: str, name_or_path: str) -> str: ...
def quantise(network: str, title: str) -> str: ...
def run(
    setup: Setup,
    seeds: Sequence[int],
    *,
    threads: int | None,
    trace: bool,
    progress: Callable[[int], object] | None,
) -> list[dict[str, Any]]: ...
def read_log(path: str) -> dict[str, Any]: ...
def plan(setup: Setup, axes: Sequence[str], *, design: str, count: int, seed: int, runs: int) -> list[list[float]]: ...
def run_jobs(
    setup: Setup,
    names: Sequence[str],
    jobs: Sequence[tuple[list[float], int]],
    *,
    threads: int | None,
    handle: Callable[[bool, dict[str, float]], object],
) -> None: ...
def identify(
    paths: Sequence[str],
    robot: str,
    *,
    held: Sequence[tuple[str, str, str]],
    fit: bool,
    date: str,
    threads: int | None,
    progress: Callable[[float], object] | None,
) -> str: ...
def tune(
    setup: Setup,
    over: Sequence[str],
    *,
    aims: str | None,
    runs: int | None,
    held_out: Sequence[int],
    threads: int | None,
    progress: Callable[[float], object] | None,
) -> dict[str, Any]: ...
def differences(first: Sequence[dict[str, float]], second: Sequence[dict[str, float]]) -> list[dict[str, Any]]: ...
