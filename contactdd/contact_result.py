"""Pressures and gaps of one contact at its points and their resultants, as plain arrays."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .base.arrays import TINY, Floats
from .base.checks import as_floats
from .base.polyline import Polyline, polyline
from .base.scattered import scattered
from .base.table import frame, html_table, vector_columns, write_csv


@dataclass(frozen=True)
class NodalPressure:
    """The contact pressure as a linear field on one surface: that of the softer body or else of the coarser facets.

    It is the law's pressure, L²-projected: all forces and moments are the same; near the edge of contact it may be a
    little below zero. With the quadrature "mortar" it is the pressure itself.

    Attributes:
        x: (m, dim) The nodes of the surface (length).
        values: (m,) The pressure there, linear in between (stress).
        at_points: (n,) The same at the points of the contact (stress).
        stiffness_ratio: k h/E, the layer's stiffness where it presses, relative to that of the softer body's facets.
    """

    x: Floats
    values: Floats
    at_points: Floats
    stiffness_ratio: float = 0.0

    def __repr__(self) -> str:
        low, high = self.values.min(), self.values.max()
        return f"NodalPressure({len(self.values)} nodes, {low:.6g} to {high:.6g}, k h/E = {self.stiffness_ratio:.3g})"


def closed_points(gap: Floats, pressure: Floats, hard: bool, bonded: bool) -> NDArray[np.bool_]:
    """Where a layer is compressed, a hard contact carries pressure, or a bond holds, (n,)."""
    return pressure > 0.0 if hard else (gap < 0.0) | bonded


@dataclass(frozen=True)
class ContactResult:
    """The gaps and pressures at the n points of a contact.

    Lengths, stresses and forces are in the user's own units. Integrals are per unit thickness in the plane and over
    the full ring between bodies of revolution.

    Attributes:
        x: (n, dim) The points, on the first body's surface (length).
        normal: (n, dim) The outward unit normals of the first body.
        weights: (n,) The area of each point, so that weights @ f is the integral of f (area).
        gap: (n,) The deformed gap z = d − u_αn − u_βn, eq. (14) (length).
        compression: (n,) The compression of the layer, w = min(z, 0); of a bonded layer z (length).
        pressure: (n,) The contact pressure −σ_n >= 0, negative where a bonded layer carries tension (stress).
        unpaired_area: The area of either surface that lies opposite nothing and is therefore outside the contact.
        initial_gap: (n,) The gap d before deformation (length).
        outline: The `corners`, or what finds them when they are first asked for; None where they are not known.
        ring: Whether the bodies are bodies of revolution, x[:, 0] the radius.
        pointwise_pressure: (n,) The law at the points, −g(w), whatever `pressure` is (stress).
        wavers: Whether the law's pressure wavers from point to point around the right mean, as under a layer much
            stiffer than the elements on meshes that do not match. `pressure` is the projected one then, and the repr
            says so.
        hard: Whether there is no layer; `compression` is then the remaining penetration.
        bonded: Whether the layer carries tension: all its points count as closed, and it has no edge.
        slip: (n, dim) The tangential displacement of the first surface relative to the second where a bond resists it
            (length); else None.
        shear: (n, dim) The traction on the first body that this causes (stress); else None.
        largest_closure: (n,) The largest closure that a gasket has seen so far, from its first touch (length); of other
            layers None.
        centres: (n, dim) The centres of what acts at each point, ∫ ψ x ds / ∫ ψ ds of a node's linear function ψ, as
            moments need them (length); None where they are the points.
        nodal: The pressure as a linear field on one surface, or what finds it when it is first asked for; None where it
            is not known.

    Example:
        >>> import contactdd as cd
        >>> gap, up = np.array([-0.2, 0.1]), np.array([[0.0, 1.0], [0.0, 1.0]])
        >>> pressure = -cd.LinearLayer(50.0).contact_stress(gap)
        >>> x, areas = np.array([[0.0, 1.0], [1.0, 1.0]]), np.ones(2)
        >>> result = cd.ContactResult(x, up, areas, gap, np.minimum(gap, 0.0), pressure)
        >>> result.force, result.area, result.force_vector
        (10.0, 1.0, array([  0., -10.]))
    """

    x: Floats
    normal: Floats
    weights: Floats
    gap: Floats
    compression: Floats
    pressure: Floats
    unpaired_area: tuple[float, float] = (0.0, 0.0)
    initial_gap: Floats | None = None
    outline: Floats | Callable[[], Floats] | None = field(default=None, repr=False, compare=False)
    ring: bool = False
    pointwise_pressure: Floats | None = None
    wavers: bool = False
    hard: bool = False
    nodal: NodalPressure | Callable[[], NodalPressure] | None = field(default=None, repr=False, compare=False)
    bonded: bool = False
    slip: Floats | None = None
    shear: Floats | None = None
    largest_closure: Floats | None = None
    centres: Floats | None = None

    @cached_property
    def corners(self) -> Floats | None:
        """The corners (facets, corners, dim) of the first body's contact surface, in order around each facet."""
        return self.outline() if callable(self.outline) else self.outline

    @cached_property
    def nodal_field(self) -> NodalPressure:
        """The pressure as a linear field on one surface.

        Raises:
            ValueError: It is not known.
        """
        if self.nodal is None:
            raise ValueError("nodal = None: the result was made without the pressure at nodes")
        return self.nodal() if callable(self.nodal) else self.nodal

    @property
    def projected_pressure(self) -> Floats:
        """The law's pressure at the points, (n,), projected onto the linear functions of one surface's nodes (stress).

        See `NodalPressure`.
        """
        return self.nodal_field.at_points

    @property
    def nodal_pressure(self) -> Floats:
        """The projected pressure at the nodes `node_x`, (m,), linear in between (stress)."""
        return self.nodal_field.values

    @property
    def node_x(self) -> Floats:
        """The nodes of the surface that carries the projected pressure, (m, dim) (length)."""
        return self.nodal_field.x

    @property
    def stiffness_ratio(self) -> float:
        """The ratio k h/E of the layer's stiffness, where it presses, to that of the softer body's facets."""
        return self.nodal_field.stiffness_ratio

    @property
    def unmatched(self) -> tuple[float, float]:
        """The old name of `unpaired_area`."""
        warnings.warn("ContactResult.unmatched is now called unpaired_area", DeprecationWarning, stacklevel=2)
        return self.unpaired_area

    @property
    def closed(self) -> NDArray[np.bool_]:
        """The mask (n,) of the points whose layer is compressed or a bond, or where a hard contact carries pressure."""
        return closed_points(self.gap, self.pressure, self.hard, self.bonded)

    @property
    def penetration(self) -> float:
        """The largest overlap of the surfaces (length): of the layer, or what is left of it in a hard contact."""
        return max(0.0, -float(self.gap.min()))

    @property
    def force(self) -> float:
        """The contact force ∫ p ds (force)."""
        return float(self.weights @ self.pressure)

    @property
    def force_vector(self) -> Floats:
        """The resultant −∫ p n ds of the contact pressure on the first body, and of a bond's shear, (dim,) (force).

        That on the second body is the opposite. Around a ring radial tractions sum to zero.
        """
        total = np.sum(self._forces, axis=0)
        return total * [0.0, 1.0] if self.ring else total

    @property
    def _forces(self) -> Floats:
        """The forces on the first body that the points carry, (n, dim)."""
        tractions = -self.pressure[:, None] * self.normal
        return self.weights[:, None] * (tractions if self.shear is None else tractions + self.shear)

    @property
    def _places(self) -> Floats:
        """Where the points' forces act, (n, dim)."""
        return self.x if self.centres is None else self.centres

    @property
    def area(self) -> float:
        """The real contact area, of the points that are `closed` (area)."""
        return float(self.weights[self.closed].sum())

    @property
    def nominal_area(self) -> float:
        """The area of the possible contact zone S_αβ (area)."""
        return float(self.weights.sum())

    @property
    def peak_pressure(self) -> float:
        """The largest contact pressure at the points (stress)."""
        return float(self.pressure.max())

    @property
    def peak_tension(self) -> float:
        """The largest tensile stress of a bonded layer at the points (stress); zero where there is none."""
        return max(0.0, -float(self.pressure.min()))

    @property
    def mean_pressure(self) -> float:
        """The contact force over the real contact area (stress); zero where nothing touches."""
        return self.force / self.area if self.area > 0.0 else 0.0

    @property
    def mean_approach(self) -> float:
        """The mean normal approach of the surfaces u_αn + u_βn = d − z over the nominal area (length)."""
        return float(self.weights @ self.approach / self.nominal_area)

    @property
    def approach(self) -> Floats:
        """The normal approach of the surfaces u_αn + u_βn at the points, (n,) (length)."""
        return self._known("initial_gap", self.initial_gap) - self.gap

    @property
    def centre_of_pressure(self) -> Floats:
        """The centre of pressure ∫ p x ds / ∫ p ds, (dim,) (length).

        It is on the axis for a ring, and not a number where nothing touches.
        """
        if self.force == 0.0:
            return np.full(self.x.shape[1], np.nan)
        centre = np.asarray((self.weights * self.pressure) @ self._places / self.force)
        return centre * np.array([0.0, 1.0]) if self.ring else centre

    def moment(self, about: ArrayLike = 0.0) -> float | Floats:
        """The moment −∫ (x − x₀) × n p ds of the contact pressure, and of a bond's shear, on the first body.

        Args:
            about: The point x₀, (dim,), or one number for all its coordinates (length).

        Returns:
            The moment about the axis z in the plane, (3,) in space (force · length); zero for a ring, whose pressures
            balance.
        """
        arms = self._places - as_floats("about", about, f"{self.x.shape[1]} numbers")
        forces = self._forces
        if self.x.shape[1] == 3:
            return np.cross(arms, forces).sum(axis=0)
        return 0.0 if self.ring else float(np.sum(arms[:, 0] * forces[:, 1] - arms[:, 1] * forces[:, 0]))

    @cached_property
    def arc_length(self) -> Floats:
        """The arc length of the points along the first body's surface, (n,) (length); in the plane only.

        It starts at the surface's end with the smaller x (of equal ones, the smaller y); closed surfaces start there
        too and run counter-clockwise. In a body of revolution it is that of the meridian.
        """
        return self._curve.locate(self.x)[0]

    def sorted(self) -> ContactResult:
        """The same result, its points in the order of `arc_length`; in space in that of x, y, z."""
        order = np.argsort(self.arc_length, kind="stable") if self.x.shape[1] == 2 else np.lexsort(self.x.T[::-1])
        names = ["x", "normal", "weights", "gap", "compression", "pressure", "initial_gap", "pointwise_pressure"]
        names += ["slip", "shear", "largest_closure", "centres"]
        parts = {name: getattr(self, name) for name in names}
        found = replace(self, **{name: part[order] for name, part in parts.items() if part is not None})
        if self.nodal is None:
            return found
        return replace(found, nodal=lambda: replace(self.nodal_field, at_points=self.projected_pressure[order]))

    @property
    def edge(self) -> Floats:
        """The points (k, dim) where contact begins and ends: the zeros of z between points; in the plane only.

        Contact that reaches the end of the surface has no edge there, and a bonded layer has none.
        """
        ordered = self.sorted()
        chain, z = self._curve.locate(ordered.x)[1], ordered._opening
        turns = np.flatnonzero((chain[1:] == chain[:-1]) & ((z[1:] < 0.0) != (z[:-1] < 0.0)))
        part = z[turns] / (z[turns] - z[turns + 1])
        return ordered.x[turns] + part[:, None] * (ordered.x[turns + 1] - ordered.x[turns])

    def at(self, points: ArrayLike) -> dict[str, Floats]:
        """The gap, the compression and the pressure at other points of the surface, interpolated linearly.

        Args:
            points: (m, dim) Points on or near the contact surface (length); the nearest point of it counts.

        Returns:
            {"gap", "compression", "pressure"}: (m,) each. Between the last point and the surface's end it is the
            last point's value.

        Raises:
            ValueError: Points are farther from the surface than its facets are large, or, in space, the surface bends
                back over itself, so that it has no single-valued projection onto a plane.
        """
        dim = self.x.shape[1]
        wanted = as_floats("points", points, f"coordinates of shape (m, {dim})")
        if wanted.ndim != 2 or wanted.shape[1] != dim or not np.all(np.isfinite(wanted)):
            raise ValueError(f"points of shape {wanted.shape}: expected finite coordinates of shape (m, {dim})")
        values = {"gap": self.gap, "compression": self.compression, "pressure": self.pressure}
        self._check_near(wanted)
        return self._along(wanted, values) if dim == 2 else self._across(wanted, values)

    def columns(self) -> dict[str, Any]:
        """The result as columns by name, in the order of `sorted`, those of `frame` and `to_csv`."""
        own = self.sorted() if self.x.shape[1] == 3 or self.corners is not None else self
        table = vector_columns("", own.x)
        if own.x.shape[1] == 2 and own.corners is not None:
            table["arc_length"] = own.arc_length
        table |= vector_columns("normal", own.normal) | {"weight": own.weights}
        if own.initial_gap is not None:
            table["initial_gap"] = own.initial_gap
        table |= {
            "gap": own.gap,
            "compression": own.compression,
            "pressure": own.pressure,
            "closed": own.closed.astype(int),
        }
        if own.slip is not None and own.shear is not None:
            table |= vector_columns("slip", own.slip) | vector_columns("shear", own.shear)
        if own.largest_closure is not None:
            table["largest_closure"] = own.largest_closure
        return table

    def frame(self) -> Any:
        """The result as a pandas DataFrame, one row per point.

        Raises:
            ImportError: pandas is not installed.
        """
        return frame(self.columns())

    def to_csv(self, path: str | os.PathLike[str]) -> Path:
        """The CSV file written, one line per point; the numbers read back are the same to the last digit.

        Args:
            path: The path of the file.
        """
        return write_csv(path, self.columns())

    def __repr__(self) -> str:
        alone = "".join(
            f", {area:.6g} of the {which} surface without a partner"
            for which, area in zip(("first", "second"), self.unpaired_area, strict=True)
            if area > 0.0
        )
        numbers = f"{len(self.x)} points, peak pressure {self.peak_pressure:.6g}, force {self.force:.6g}"
        numbers += f", peak tension {self.peak_tension:.6g}" if self.bonded else ""
        return f"ContactResult({numbers}{alone}{self._note})"

    @property
    def _note(self) -> str:
        """A remark on the accuracy of the result, for its text; empty if there is none."""
        if self.hard:
            return f", penetration {self.penetration:.3g}"
        if not self.wavers:
            return ""
        return (
            f"; the layer is {self.stiffness_ratio:.3g} times as stiff as the elements on meshes that do not match: "
            "the pressure is the projected one, as pointwise_pressure wavers; quadrature='mortar' does not"
        )

    @property
    def _opening(self) -> Floats:
        """A field (n,) with a change of sign at the edge of contact: the gap; in a hard contact less the pressure."""
        if self.bonded:
            return np.full(len(self.gap), -1.0)
        if not self.hard:
            return self.gap
        gap, pressure = np.where(self.closed, 0.0, np.maximum(self.gap, 0.0)), self.pressure
        return gap / max(float(gap.max()), TINY) - pressure / max(float(pressure.max()), TINY)

    @cached_property
    def _curve(self) -> Polyline:
        if self.x.shape[1] != 2:
            raise ValueError("the contact is a surface in space: it has no arc length and no edge of single points")
        return polyline(self._known("corners", self.corners))

    def _known(self, name: str, value: Floats | None) -> Floats:
        if value is None:
            raise ValueError(f"{name}: this result was made without it")
        return value

    def _check_near(self, points: Floats) -> None:
        """Refuse points that are not on the surface."""
        corners = self._known("corners", self.corners)
        size = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max()
        away = np.linalg.norm(points[:, None] - self.x[None], axis=2).min(axis=1)
        if np.any(away > 2.0 * size):
            worst = int(np.argmax(away))
            raise ValueError(
                f"points: {points[worst]} is {away[worst]:.3g} away from the contact; expected points on it"
            )

    def _along(self, points: Floats, values: dict[str, Floats]) -> dict[str, Floats]:
        """Values interpolated along the curve, each of its pieces by itself."""
        position, piece, _ = self._curve.locate(points)
        own, own_piece, _ = self._curve.locate(self.x)
        found: dict[str, Floats] = {name: np.zeros(len(points)) for name in values}
        for chain in np.unique(piece):
            order = np.flatnonzero(own_piece == chain)
            order = order[np.argsort(own[order], kind="stable")]
            for name, value in values.items():
                found[name][piece == chain] = np.interp(position[piece == chain], own[order], value[order])
        return found

    def _across(self, points: Floats, values: dict[str, Floats]) -> dict[str, Floats]:
        """Values interpolated over a surface in space, seen along its mean normal; the nearest beyond its points."""
        mean = self.weights @ self.normal
        mean /= max(float(np.linalg.norm(mean)), TINY)
        if np.min(self.normal @ mean) < 0.1:
            raise ValueError(
                "points: the contact surface bends back over itself; expected one that a plane shows whole"
            )
        axes = np.linalg.svd(mean[None])[2][1:]
        found = scattered(self.x @ axes.T, np.stack(list(values.values()), axis=1), points @ axes.T)
        return dict(zip(values, found.T, strict=True))


def solution_html(status: str, reason: str, method: str, contacts: Mapping[str, ContactResult]) -> str:
    """How a run ended, and the numbers of its contacts by name, in a notebook."""
    head = ("contact", "peak pressure", "force", "area in contact")
    rows = ((n, f"{r.peak_pressure:.6g}", f"{r.force:.6g}", f"{r.area:.6g}") for n, r in contacts.items())
    return f"<p><b>{escape(status)}</b>: {escape(reason)} ({escape(method)})</p>{html_table(head, rows)}"
