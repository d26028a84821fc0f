"""What is at hand of a sketch under test: its serial ports, its pins, and claims about them."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Literal, overload

import numpy as np
from numpy.typing import NDArray

from . import _rumbo

#: The tick by which time goes on while something is waited for [s].
TICK_S = 0.01
#: What is shown of a port's output at most [characters].
SHOWN = 400

LineEnding = Literal["lf", "cr", "crlf", "none"]
_ENDINGS: dict[str, str] = {"lf": "\n", "cr": "\r", "crlf": "\r\n", "none": ""}


class ExpectationError(AssertionError):
    """What was expected did not come in time; its text says what came instead."""


def wait(batch: _rumbo.Batch, within_s: float, come: Callable[[], bool], missing: Callable[[], str]) -> None:
    """Advances the only robot tick by tick until `come` is true, at most for `within_s` [s].

    Raises:
        ExpectationError: It did not come true; with what `missing` says.
        ValueError: `within_s` is negative or not a number.
    """
    if not 0 <= within_s < 1e6:
        raise ValueError(f"within_s = {within_s}: must be 0 or more, in seconds")
    for _ in range(round(within_s / TICK_S)):
        if come():
            return
        if (end := _rumbo.ended(batch)) is not None:
            raise ExpectationError(f"{missing()}; the program had ended: {end}")
        batch.advance(1)
    if not come():
        raise ExpectationError(f"{missing()} within {within_s:g} s")


class Serial:
    """A serial port of an emulated board, as a terminal at its other end has it; made by `Sim`."""

    def __init__(self, batch: _rumbo.Batch, port: str, title: str) -> None:
        self._batch = batch
        self._port = port
        self._title = title
        self._read = 0

    def __repr__(self) -> str:
        return f"<{self._title}: {len(self.raw)} bytes>"

    @property
    def raw(self) -> bytes:
        """All that it has sent since the start; the first 16 MB of it."""
        return _rumbo.said(self._batch, self._port, 0)

    @property
    def text(self) -> str:
        """The same as text, without carriage returns; what is no UTF-8 is replaced."""
        return _text(self.raw)

    @property
    def lines(self) -> list[str]:
        """The whole lines of `text`."""
        return self.text.split("\n")[:-1]

    def read(self) -> str:
        """What it has sent since the last `read` or `expect`."""
        new = _rumbo.said(self._batch, self._port, self._read)
        self._read += len(new)
        return _text(new)

    def write(self, text: str | bytes, line_ending: LineEnding = "lf") -> None:
        """Sends text, with a line ending behind it, or bytes as they are, to the board."""
        if line_ending not in _ENDINGS:
            raise ValueError(f"line_ending = {line_ending!r}: must be one of {', '.join(_ENDINGS)}")
        content = text if isinstance(text, bytes) else (text + _ENDINGS[line_ending]).encode()
        _rumbo.type_in(self._batch, self._port, content)

    @overload
    def expect(self, pattern: str, within_s: float = 1.0) -> str: ...
    @overload
    def expect(self, pattern: re.Pattern[str], within_s: float = 1.0) -> re.Match[str]: ...
    def expect(self, pattern: str | re.Pattern[str], within_s: float = 1.0) -> str | re.Match[str]:
        """Waits until the board has sent this, in what was not yet read, and reads up to its end.

        Args:
            pattern: Text, or a compiled pattern of `re`.
            within_s: How long at most from now [s, simulated].

        Returns:
            The text, or the match.

        Raises:
            ExpectationError: It did not come; with what came instead.
        """
        found: list[tuple[str | re.Match[str], int]] = []

        def come() -> bool:
            # Byte for byte a character, so that its end is known.
            new = _rumbo.said(self._batch, self._port, self._read).decode("latin-1")
            if isinstance(pattern, str):
                at = new.find(pattern.encode().decode("latin-1"))
                if at >= 0:
                    found.append((pattern, at + len(pattern.encode())))
            elif match := pattern.search(new):
                found.append((match, match.end()))
            return bool(found)

        def missing() -> str:
            wanted = repr(pattern) if isinstance(pattern, str) else f"/{pattern.pattern}/"
            return f"{self._title} did not send {wanted}, but {_shown(self._unread())}"

        wait(self._batch, within_s, come, missing)
        result, end = found[0]
        self._read += end
        return result

    def _unread(self) -> str:
        return _text(_rumbo.said(self._batch, self._port, self._read))


class Pin:
    """A pin of an emulated board; made by `Sim.pin`. Times are since the start [s], exact to a cycle of 62.5 ns."""

    def __init__(self, batch: _rumbo.Batch, name: int | str) -> None:
        self._batch = batch
        self._name = name
        #: Its number on the board.
        self.number: int = _rumbo.pin(batch, str(name))

    def __repr__(self) -> str:
        return f"<pin {self._name}: {'high' if self.high else 'low'}>"

    @property
    def high(self) -> bool:
        """Its level now, whether the program or something outside makes it."""
        return _rumbo.is_high(self._batch, self.number)

    def pulses(self, since_s: float = 0.0) -> NDArray[np.float64]:
        """Its pulses, shape (pulses, 2): when each rose [s], and how long it was high [us].

        Only those that have both begun and ended since `since_s`.
        """
        return _rumbo.pulses(self._batch, self.number, since_s)

    def edges(self, since_s: float = 0.0) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
        """When it changed [s], and whether it rose; the latest 1,048,576 edges at most."""
        return _rumbo.edges(self._batch, self.number, since_s)

    def duty(self, since_s: float = 0.0) -> float:
        """The share of the time since `since_s` for which it was high, 0 to 1: of ``analogWrite(pin, 128)`` 0.502."""
        return _rumbo.share_high(self._batch, self.number, since_s)

    def expect(self, high: bool = True, within_s: float = 1.0) -> None:
        """Waits until it is high, or low, however shortly.

        Raises:
            ExpectationError: It was not, within `within_s` [s].
        """
        began_s = self._now_s()
        if self.high == high:
            return
        wait(
            self._batch,
            within_s,
            lambda: bool((self.edges(began_s)[1] == high).any()),
            lambda: f"pin {self._name} did not become {'high' if high else 'low'}",
        )

    def drive(self, high: bool) -> None:
        """Connects it to 5 V or to ground from outside, until `release`."""
        self.apply(5.0 if high else 0.0)

    def apply(self, volts: float) -> None:
        """Connects it to a voltage, 0 to 5 [V], which ``analogRead`` reads where the pin can, until `release`."""
        if not 0 <= volts <= 5:
            raise ValueError(f"pin {self._name}: {volts} V: must be 0 to 5")
        _rumbo.apply(self._batch, self.number, volts)

    def release(self) -> None:
        """Takes the connection away: the pin floats, or follows its pull-up."""
        _rumbo.apply(self._batch, self.number, None)

    def _now_s(self) -> float:
        known, truth = np.empty((1, len(_rumbo.OBSERVED)), np.float32), np.empty((1, len(_rumbo.TRUE)))
        self._batch.observe(known, truth)
        return float(truth[0, 0])


def _text(content: bytes) -> str:
    return content.decode(errors="replace").replace("\r", "")


def _shown(text: str) -> str:
    if not text:
        return "nothing"
    return repr(text) if len(text) <= SHOWN else f"(the last of it) {text[-SHOWN:]!r}"
