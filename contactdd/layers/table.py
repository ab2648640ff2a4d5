"""Measured laws: through the points of a table, smooth or straight from point to point, from a file or from arrays."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arrays import Floats
from ..base.checks import as_bool, as_floats, finite, positive
from .calculus import TINY, solve_by_newton
from .limited import LimitedLayer

#: An end slope that is less than this part of its chord's is zero but for rounding.
FLAT = 1e-8


@dataclass(frozen=True)
class TableLayer(LimitedLayer):
    """A measured law: a monotone cubic (PCHIP) or straight lines through the points, and straight beyond the last.

    Beyond the last point the law goes on with the slope that it has there: that is a guess, and a solution that has
    passed the point says so. The cubic is continuously differentiable; where it would end with slope 0, half the slope
    of the end chord replaces it, because g has to increase, eq. (7).

    Source: F. N. Fritsch, J. Butland, A method for constructing local monotone piecewise cubic interpolants, SIAM J.
    Sci. Stat. Comput. 5 (1984), 300-304.

    Args:
        compressions: The points' compressions (length), strictly increasing and >= 0; (0, 0) is added if missing.
        pressures: The points' pressures (stress), strictly increasing and >= 0.
        smooth: Whether the law is the monotone cubic, or straight from point to point.
        clearance: The distance of the surfaces at which the law begins (length, 0 by default); see `Layer`.

    Raises:
        TypeError: `smooth` is not True or False, or `clearance` is no number.
        ValueError: The points are not finite, of equal number, strictly increasing and >= 0; the row is named. For
            data with plateaus and noise see `from_measurement` and `from_csv`.

    Example:
        >>> layer = TableLayer(compressions=[1.0, 2.0, 3.0], pressures=[1.0, 4.0, 9.0])
        >>> layer.compression([0.0, -4.0, -9.0])
        array([-0., -2., -3.])
    """

    compressions: Sequence[float]
    pressures: Sequence[float]
    smooth: bool = True
    clearance: float = 0.0
    _knots: Floats = field(init=False, repr=False, compare=False)
    _table: Floats = field(init=False, repr=False, compare=False)
    _pieces: Floats = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "smooth", as_bool("smooth", self.smooth))
        object.__setattr__(self, "clearance", finite("clearance", self.clearance))
        c, p = _column("compressions", self.compressions), _column("pressures", self.pressures)
        c, p = _with_origin(c, p)
        for name, values in (("compressions", c), ("pressures", p)):
            if not np.all(np.diff(values) > 0):
                row = int(np.argmin(np.diff(values) > 0)) + 1
                raise ValueError(
                    f"{name} = {values.tolist()}: expected strictly increasing values >= 0; {values[row]:g} comes "
                    f"after {values[row - 1]:g}; cd.TableLayer.from_measurement takes data with plateaus and noise"
                )
        object.__setattr__(self, "compressions", _plain(c))
        object.__setattr__(self, "pressures", _plain(p))
        object.__setattr__(self, "_knots", c)
        object.__setattr__(self, "_table", p)
        object.__setattr__(self, "_pieces", _cubics(c, p) if self.smooth else _lines(c, p))

    @classmethod
    def from_measurement(
        cls, compressions: ArrayLike, pressures: ArrayLike, *, noise: float = 0.0, smooth: bool = True
    ) -> TableLayer:
        """The layer of a measured loading curve as it comes: a start without pressure, plateaus, noise.

        Rows are sorted by compression. The law begins at the last row before the pressures rise above the noise: what
        that row's compression is, is its clearance (negative where the fixture had play). From there on neighbouring
        rows that don't increase are replaced by their mean, the least-squares increasing fit, if that moves no pressure
        by more than `noise`; equal compressions are averaged likewise.

        Args:
            compressions: (n,) The measured compressions (length), from any origin.
            pressures: (n,) The measured pressures (stress).
            noise: The largest error of a pressure (stress), 0 by default: then only rows of equal pressure are put
                together.
            smooth: As of the class.

        Returns:
            A table whose `clearance` is where the curve begins.

        Raises:
            ValueError: Values are not finite or of equal number; a pressure falls by more than the noise accounts
                for (the row is named, counted from 1); nothing is left.

        Example:
            >>> layer = TableLayer.from_measurement([0, 0.05, 0.1, 0.2, 0.3], [0, 0, 1.2, 5.0, 5.0])
            >>> layer.clearance, layer.compressions, layer.pressures
            (-0.05, (0.0, 0.05, 0.2), (0.0, 1.2, 5.0))
        """
        c, p = _column("compressions", compressions), _column("pressures", pressures)
        if c.size != p.size:
            raise ValueError(f"pressures: {p.size} values, expected {c.size}, one for each of compressions")
        allowed = float(noise) if noise == 0 else positive("noise", noise)
        rows = np.argsort(c, kind="stable")
        c, p = c[rows], p[rows]
        rising = np.flatnonzero(p > allowed)
        if rising.size == 0:
            raise ValueError(f"pressures: none is above the noise of {allowed:g}; expected a curve that rises")
        first = max(int(rising[0]) - 1, 0)
        if rising[0] == 0:
            raise ValueError(
                f"pressures: {p[0]:g} at the least compression {c[0]:g}, row {rows[0] + 1}; expected a first row "
                "without pressure, which tells where the law begins"
            )
        origin, after = c[first], slice(first + 1, None)
        c, p = _increasing(c[after] - origin, p[after], rows[after] + 1, allowed)
        return cls(_plain(c), _plain(p), smooth, -float(origin) + 0.0)

    @classmethod
    def from_csv(
        cls,
        path: str | Path,
        compression: str,
        pressure: str,
        *,
        length_unit: float = 1.0,
        stress_unit: float = 1.0,
        noise: float = 0.0,
        smooth: bool = True,
        delimiter: str = ",",
    ) -> TableLayer:
        """The layer of a measured loading curve in a text file with a line of column names.

        Args:
            path: The file; lines that are empty or begin with # are skipped.
            compression: The name of its column of compressions.
            pressure: The name of its column of pressures.
            length_unit: The file's unit of length in yours, such as 1e-3 for µm where you use mm.
            stress_unit: The file's unit of stress in yours.
            noise: As of `from_measurement`, in your unit of stress.
            smooth: As of the class.
            delimiter: The text between columns; ";" also reads decimal commas.

        Raises:
            ValueError: A column is missing (those there are named), a row has no number in it (its line is named),
                or as `from_measurement` does.
            OSError: The file can't be read.
        """
        columns = _read_columns(Path(path), (compression, pressure), delimiter)
        c, p = columns[0] * positive("length_unit", length_unit), columns[1] * positive("stress_unit", stress_unit)
        try:
            return cls.from_measurement(c, p, noise=noise, smooth=smooth)
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from None

    @property
    def compression_limit(self) -> float:
        return float(self._knots[-1])

    def _known_pressure(self, c: Floats) -> Floats:
        piece, t = self._place(c)
        return self._table[piece] + t * self._rise(piece, t) * self._widths[piece]

    def _known_slope(self, c: Floats) -> Floats:
        piece, t = self._place(c)
        linear, quadratic, cubic = self._pieces[:, piece]
        return linear + t * (2 * quadratic + t * 3 * cubic)

    def _known_energy(self, c: Floats) -> Floats:
        piece, t = self._place(c)
        return self._stored[piece] + self._piece_energy(piece, t)

    def _known_secant(self, deep: Floats, shallow: Floats) -> Floats:
        # Summed from knot to knot every term is positive, so nothing cancels.
        first, last = self._piece(shallow), self._piece(deep)
        same = first == last
        end = np.where(same, deep, self._knots[first + 1])
        start_secant = self._secant_in_piece(first, end, shallow)
        end_rise = self._secant_in_piece(last, deep, self._knots[last]) * (deep - self._knots[last])
        between = self._table[last] - self._table[np.minimum(first + 1, last)]
        rise = start_secant * (end - shallow) + between + end_rise
        return np.divide(rise, deep - shallow, out=start_secant, where=~same)

    def _known_depth(self, p: Floats) -> Floats:
        piece = np.clip(np.searchsorted(self._table, p, side="right") - 1, 0, self._table.size - 2)
        linear, quadratic, cubic = pieces = self._pieces[:, piece]
        rise = (p - self._table[piece]) / self._widths[piece]
        wanted = np.where(rise > 0, rise, 1.0)
        start = np.minimum(wanted / pieces.sum(axis=0), 1.0)

        def rise_and_slope(t: Floats) -> tuple[Floats, Floats]:
            chord, bend = quadratic + t * cubic, quadratic + 2 * t * cubic
            return t * (linear + t * chord), linear + t * (chord + bend)

        t = solve_by_newton(rise_and_slope, wanted, np.full(p.shape, TINY), start, np.ones(p.shape))
        return self._knots[piece] + np.where(rise > 0, t, rise) * self._widths[piece]

    @cached_property
    def _widths(self) -> Floats:
        return np.diff(self._knots)

    @cached_property
    def _stored(self) -> Floats:
        """The energy at every knot."""
        pieces = np.arange(len(self._widths))
        return np.concatenate([[0.0], np.cumsum(self._piece_energy(pieces, np.ones(len(pieces))))])

    def _piece(self, c: Floats) -> NDArray[np.intp]:
        """The index of the piece that c lies in."""
        return np.clip(np.searchsorted(self._knots, c, side="right") - 1, 0, self._knots.size - 2)

    def _place(self, c: Floats) -> tuple[NDArray[np.intp], Floats]:
        """The piece that c lies in, and where in it, from 0 to 1."""
        piece = self._piece(c)
        return piece, (c - self._knots[piece]) / self._widths[piece]

    def _rise(self, piece: NDArray[np.intp], t: Floats) -> Floats:
        """The chord's slope from the beginning of a piece to t."""
        linear, quadratic, cubic = self._pieces[:, piece]
        return linear + t * (quadratic + t * cubic)

    def _piece_energy(self, piece: NDArray[np.intp], t: Floats) -> Floats:
        """The energy from the beginning of a piece to t."""
        linear, quadratic, cubic = self._pieces[:, piece]
        width = self._widths[piece]
        return width * t * (self._table[piece] + width * t * (linear / 2 + t * (quadratic / 3 + t * cubic / 4)))

    def _secant_in_piece(self, piece: NDArray[np.intp], deep: Floats, shallow: Floats) -> Floats:
        """The secant between points of one piece, by its coefficients: no division."""
        s, t = ((c - self._knots[piece]) / self._widths[piece] for c in (deep, shallow))
        linear, quadratic, cubic = self._pieces[:, piece]
        return linear + quadratic * (s + t) + cubic * (s * s + s * t + t * t)


def _column(name: str, values: ArrayLike) -> Floats:
    """`values` as a one-dimensional array of finite numbers; ValueError if they aren't."""
    try:
        column = as_floats(name, values, "a non-empty sequence of finite numbers")
    except (TypeError, ValueError):
        column = np.empty(0)
    if column.ndim != 1 or column.size == 0 or not np.all(np.isfinite(column)):
        raise ValueError(f"{name} = {values!r}: expected a non-empty sequence of finite numbers")
    return column


def _plain(column: Floats) -> tuple[float, ...]:
    """A column as numbers of Python's own."""
    return tuple(map(float, column))


def _with_origin(c: Floats, p: Floats) -> tuple[Floats, Floats]:
    """The points of a table that begins with (0, 0); ValueError if too few or not in pairs."""
    if c.size != p.size:
        raise ValueError(f"pressures: {p.size} values, expected {c.size}, one for each of compressions")
    if c[0] != 0 or p[0] != 0:
        c, p = np.append(0.0, c), np.append(0.0, p)
    if c.size < 2:
        raise ValueError(f"compressions = {c.tolist()}: expected a point beside (0, 0)")
    return c, p


def _lines(c: Floats, p: Floats) -> Floats:
    """Slope, quadratic and cubic part of straight pieces, (3, pieces)."""
    chords = np.diff(p) / np.diff(c)
    return np.vstack([chords, np.zeros((2, len(chords)))])


def _cubics(c: Floats, p: Floats) -> Floats:
    """The same of the monotone cubic, in t from 0 to 1 on every piece: p' = linear + 2 quadratic t + 3 cubic t²."""
    chords = np.diff(p) / np.diff(c)
    slopes = _monotone_slopes(np.diff(c), chords)
    before, after = slopes[:-1], slopes[1:]
    return np.vstack([before, 3 * chords - 2 * before - after, before + after - 2 * chords])


def _monotone_slopes(h: Floats, chords: Floats) -> Floats:
    """The slopes at the knots that keep the cubic increasing; none is zero."""
    if len(h) == 1:
        return np.repeat(chords, 2)
    left, right = 2 * h[1:] + h[:-1], h[1:] + 2 * h[:-1]
    middle = (left + right) / (left / chords[:-1] + right / chords[1:])
    start = ((2 * h[0] + h[1]) * chords[0] - h[0] * chords[1]) / (h[0] + h[1])
    end = ((2 * h[-1] + h[-2]) * chords[-1] - h[-1] * chords[-2]) / (h[-1] + h[-2])
    return np.concatenate([[_end_slope(start, chords[0])], middle, [_end_slope(end, chords[-1])]])


def _end_slope(slope: float, chord: float) -> float:
    """The slope at an end, or half the chord's where it is zero or below but for rounding."""
    return slope if slope > FLAT * chord else chord / 2


def _increasing(c: Floats, p: Floats, rows: NDArray[np.intp], noise: float) -> tuple[Floats, Floats]:
    """The least-squares increasing fit: rows that don't increase are put together, by pooling adjacent violators.

    rows: the rows' numbers for the reader; noise: how much a pressure may be moved.
    """
    blocks: list[list[int]] = []
    for row in range(len(c)):
        blocks.append([row])
        while len(blocks) > 1 and not (
            c[blocks[-1]].mean() > c[blocks[-2]].mean() and p[blocks[-1]].mean() > p[blocks[-2]].mean()
        ):
            blocks[-2:] = [blocks[-2] + blocks[-1]]
    means = [(c[block].mean(), p[block].mean()) for block in blocks]
    for block, (_, mean) in zip(blocks, means, strict=True):
        off = np.abs(p[block] - mean)
        if off.max() > noise + 1e-12 * abs(mean):
            worst = block[int(np.argmax(off))]
            raise ValueError(
                f"pressures: {p[worst]:g} in row {rows[worst]} is {off.max():.3g} off any increasing curve; expected "
                f"noise of {noise:g} at most, or a noise that allows it"
            )
    good = [(x, y) for x, y in means if x > 0 and y > 0]
    return np.array([x for x, _ in good]), np.array([y for _, y in good])


def _read_columns(path: Path, names: tuple[str, str], delimiter: str) -> list[Floats]:
    """Two columns of a text file, by their names in its first line."""
    with path.open(newline="", encoding="utf-8-sig") as file:
        lines = [(n, line) for n, line in enumerate(file, 1) if line.strip() and not line.lstrip().startswith("#")]
    rows = list(csv.reader([line for _, line in lines], delimiter=delimiter))
    header = [name.strip() for name in rows[0]] if rows else []
    for name in names:
        if header.count(name) != 1:
            raise ValueError(f"{path}: column {name!r}: expected one of {', '.join(map(repr, header)) or 'a header'}")
    numbered = [(line, row) for (line, _), row in zip(lines[1:], rows[1:], strict=True)]
    columns = [header.index(name) for name in names]
    return [np.array([_number(path, line, row, column, delimiter) for line, row in numbered]) for column in columns]


def _number(path: Path, line: int, row: list[str], column: int, delimiter: str) -> float:
    """The number in a column of a row."""
    text = row[column].strip() if column < len(row) else ""
    try:
        return float(text.replace(",", ".") if delimiter == ";" else text)
    except ValueError:
        raise ValueError(f"{path}, line {line}: {text!r}: expected a number") from None
