"""What a notebook shows: tables, and plots as SVG, without any other package."""

from __future__ import annotations

import html
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from ._log import Log
    from ._run import Run
    from ._study import Comparison

#: Most rows and columns of a table, and points of a curve.
ROWS, COLUMNS, POINTS = 10, 12, 400
#: A plot [pixels].
WIDTH, HEIGHT, MARGIN = 420, 190, 34

_INKS = ("#1f6fb4", "#c8501e", "#2c8a4b")


def number(value: Any) -> str:
    """A value as a reader wants it: four digits, a dash where there is none."""
    if isinstance(value, (bool, np.bool_)):
        return "yes" if value else "no"
    if isinstance(value, (float, np.floating)):
        return "-" if np.isnan(value) else f"{value:.4g}"
    return str(value)


def table(head: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """A table of values."""
    titles = "".join(f"<th>{html.escape(title)}</th>" for title in head)
    body = "".join(
        "<tr>" + "".join(f"<td>{html.escape(number(value))}</td>" for value in row) + "</tr>" for row in rows
    )
    return f"<table><thead><tr>{titles}</tr></thead><tbody>{body}</tbody></table>"


def titled(title: str, *parts: str) -> str:
    """Parts below a line of text."""
    return f"<div><p>{html.escape(title)}</p>{''.join(parts)}</div>"


def columns(title: str, of: Mapping[str, NDArray[Any]]) -> str:
    """The first rows and columns of a table of arrays."""
    names = list(of)[:COLUMNS]
    count = len(next(iter(of.values()))) if of else 0
    rows = [[of[name][row] for name in names] for row in range(min(count, ROWS))]
    left = [
        f"{more} more {what}" for more, what in ((count - len(rows), "rows"), (len(of) - len(names), "columns")) if more
    ]
    return titled(title.strip("<>"), table(names, rows), f"<p>{', '.join(left)}; to_dict() has all</p>" if left else "")


def run(of: Run) -> str:
    """A run: its metrics, and with a trace where it drove and how fast."""
    parts = [table(("metric", "value"), of.metrics.items())]
    if of.trace is not None:
        trace = of.trace
        parts.append(path({"": (trace["x_m"], trace["y_m"])}))
        parts.append(plot("s", "rad/s", trace["t_s"], {side: trace[f"{side}_rad_s"] for side in ("left", "right")}))
        ranges = {side: trace[f"range_{side}_m"] for side in ("left", "right", "front")}
        parts.append(plot("s", "m", trace["t_s"], ranges))
    parts += [run(robot) for robot in of.robots]
    return titled(repr(of).strip("<>"), *parts)


def comparison(of: Comparison) -> str:
    """The differences of each later variant from the first."""
    first = next(iter(of.runs))
    parts = []
    for name, differences in of.differences.items():
        rows = [
            (
                one.metric,
                *one.medians,
                one.mean,
                f"{number(one.interval[0])} to {number(one.interval[1])}",
                one.effect,
                f"{100 * one.better:.0f} %",
            )
            for one in differences.values()
        ]
        head = ("metric", f"{first}, median", f"{name}, median", "mean difference", "95 %", "effect", "better")
        parts.append(table(head, rows))
    return titled(repr(of).strip("<>"), *parts)


def log(of: Log) -> str:
    """A log: what it is of, and where the robot drove."""
    about: dict[str, Any] = {}
    for name in ("scenario", "robot", "world", "seed", "version"):
        value = (of.manifest or {}).get(name)
        if isinstance(value, (str, int)):
            about[name] = value
    about["signals"], about["events"], about["parameters"] = len(of.signals), len(of.events), len(of.parameters)
    if of.cut is not None:
        about["cut"] = of.cut
    ways = {}
    for name, prefix in (("odometry", ""), ("truth", "true_")):
        if f"{prefix}x_m" in of.signals:
            ways[name] = (of.signals[f"{prefix}x_m"], of.signals[f"{prefix}y_m"])
    return titled(repr(of).strip("<>"), table(("", ""), about.items()), path(ways) if ways else "")


def path(ways: Mapping[str, tuple[NDArray[Any], NDArray[Any]]]) -> str:
    """Where something drove, seen from above, both axes in one scale [m]."""
    lows = [min(_ends(way[axis])[0] for way in ways.values()) for axis in (0, 1)]
    highs = [max(_ends(way[axis])[1] for way in ways.values()) for axis in (0, 1)]
    across = max((highs[0] - lows[0]) / (WIDTH - 2 * MARGIN), (highs[1] - lows[1]) / (HEIGHT - 2 * MARGIN), 1e-3)
    spans = [across * (side - 2 * MARGIN) for side in (WIDTH, HEIGHT)]
    bounds = [(0.5 * (low + high - span), 0.5 * (low + high + span)) for low, high, span in zip(lows, highs, spans)]
    return _svg("x, m", "y, m", bounds[0], bounds[1], ways)


def plot(x_unit: str, y_unit: str, x: NDArray[Any], curves: Mapping[str, NDArray[Any]]) -> str:
    """Curves over time; nothing where a value is unknown or infinite."""
    ends = [_ends(curve) for curve in curves.values()]
    low, high = min(end[0] for end in ends), max(end[1] for end in ends)
    bounds = (low, high) if high > low else (low - 1.0, high + 1.0)
    return _svg(x_unit, y_unit, _ends(x), bounds, {name: (x, curve) for name, curve in curves.items()})


def _ends(values: NDArray[Any]) -> tuple[float, float]:
    known = np.asarray(values, float)
    known = known[np.isfinite(known)]
    return (float(known.min()), float(known.max())) if len(known) else (0.0, 1.0)


def _svg(
    x_name: str,
    y_name: str,
    x_ends: tuple[float, float],
    y_ends: tuple[float, float],
    curves: Mapping[str, tuple[NDArray[Any], NDArray[Any]]],
) -> str:
    def place(values: NDArray[Any], ends: tuple[float, float], pixels: tuple[int, int]) -> NDArray[np.float64]:
        share = (np.asarray(values, float) - ends[0]) / ((ends[1] - ends[0]) or 1.0)
        return np.asarray(pixels[0] + share * (pixels[1] - pixels[0]))

    inks = dict(zip(curves, _INKS))
    parts = []
    for name, (x, y) in curves.items():
        every = max(1, len(x) // POINTS)
        across = place(x[::every], x_ends, (MARGIN, WIDTH - MARGIN))
        up = place(y[::every], y_ends, (HEIGHT - MARGIN, MARGIN))
        # A piece for each stretch that is known.
        known = np.isfinite(across) & np.isfinite(up)
        for piece in np.split(np.arange(len(known)), np.flatnonzero(np.diff(known)) + 1):
            if len(piece) > 1 and known[piece[0]]:
                points = " ".join(f"{across[at]:.1f},{up[at]:.1f}" for at in piece)
                parts.append(f'<polyline points="{points}" fill="none" stroke="{inks[name]}" stroke-width="1.5"/>')
    texts = [
        (MARGIN, HEIGHT - 8, "start", "#666", f"{x_ends[0]:.3g}"),
        (WIDTH - MARGIN, HEIGHT - 8, "end", "#666", f"{x_ends[1]:.3g} {x_name}"),
        (4, HEIGHT - MARGIN, "start", "#666", f"{y_ends[0]:.3g}"),
        (4, MARGIN, "start", "#666", f"{y_ends[1]:.3g} {y_name}"),
    ]
    texts += [(MARGIN + 70 + 80 * at, 14, "start", inks[name], name) for at, name in enumerate(curves) if name]
    words = "".join(
        f'<text x="{x}" y="{y}" text-anchor="{anchor}" fill="{ink}">{html.escape(text)}</text>'
        for x, y, anchor, ink, text in texts
    )
    box = f'<rect x="{MARGIN}" y="{MARGIN}" width="{WIDTH - 2 * MARGIN}" height="{HEIGHT - 2 * MARGIN}"'
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" font-family="sans-serif"'
        f' font-size="11">{box} fill="none" stroke="#ccc"/>{"".join(parts)}{words}</svg>'
    )
