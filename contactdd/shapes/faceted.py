"""A shape given by facets: of an STL file, or of a surface of a mesh."""

from __future__ import annotations

import os
import re
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.arrays import Floats
from ..base.checks import as_floats
from ..base.facets import facet_corners, surface_points
from ..mesh import Mesh
from .shape import Shape, dot

#: How many pairs of a ray and a facet are looked at together.
PAIRS = 1_000_000

#: How far outside of a facet, in parts of it, a ray may pass: none slips through between two.
SEAM = 1e-9

#: The bytes of a binary STL file: a header, the number of triangles, and of each the normal, three corners and a word.
HEADER, TRIANGLE = 84, np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("word", "<u2")])


class FacetedSurface(Shape):
    """The body behind flat facets: triangles in space, line segments in the plane and of bodies of revolution.

    Facets of a curved body leave their own gaps, h²/(8 R) for facets h long: a layer should be softer than that.

    Args:
        corners: (facets, dim, dim) the corners of each (length).
        outward: (facets, dim) vectors on whose side of each facet the body is not; by default those that the right-hand
            rule gives triangles (STL) and a walk with the body on the left gives segments.
        centre: (dim,) the point about which it turns, by default the middle of all corners (length).

    Raises:
        TypeError, ValueError: An argument is none of these, or a facet has no area.

    Example:
        >>> roof = FacetedSurface([[[-1, 1], [0, 0]], [[0, 0], [1, 1]]])
        >>> print(roof.distance(np.array([[0.5, -1.0], [2.0, 0.0]]), np.array([[0.0, 1.0], [0.0, 1.0]])))
        [1.5 inf]
    """

    def __init__(self, corners: ArrayLike, outward: ArrayLike | None = None, centre: ArrayLike | None = None) -> None:
        array = as_floats("corners", corners, "finite numbers (facets, dim, dim)")
        if array.ndim != 3 or array.shape[1:] not in ((2, 2), (3, 3)) or len(array) == 0:
            raise ValueError(f"corners of shape {array.shape}: expected (facets, 2, 2) or (facets, 3, 3)")
        if not np.all(np.isfinite(array)):
            raise ValueError("corners: expected finite numbers")
        self.dim = array.shape[2]
        normal = _normals(array)
        size = np.linalg.norm(normal, axis=1)
        flat = np.flatnonzero(size <= 1e-14 * np.ptp(array, axis=1).max(axis=1) ** (self.dim - 1))
        if len(flat):
            raise ValueError(f"corners[{flat[0]}] = {array[flat[0]].tolist()}: this facet has no area")
        if outward is not None:
            given = as_floats("outward", outward, f"vectors ({len(array)}, {self.dim})")
            if given.shape != normal.shape:
                raise ValueError(f"outward of shape {given.shape}: expected {normal.shape}")
            normal = np.where(dot(normal, given)[:, None] < 0, -normal, normal)
        self.corners, self.normals = array, normal / size[:, None]
        middle = array.reshape(-1, self.dim).mean(axis=0) if centre is None else centre
        self.centre = as_floats("centre", middle, f"{self.dim} numbers")
        if self.centre.shape != (self.dim,):
            raise ValueError(f"centre = {centre!r}: expected {self.dim} numbers")

    @classmethod
    def from_stl(cls, path: str | os.PathLike[str]) -> FacetedSurface:
        """The shape of an STL file, text or binary.

        Args:
            path: The path of the file.

        Raises:
            FileNotFoundError: There is no such file.
            ValueError: It is no STL file, or holds no triangle.
        """
        data = Path(path).read_bytes()
        corners = _binary(data)
        corners = _text(data) if corners is None else corners
        if corners is None or len(corners) == 0 or not np.all(np.isfinite(corners)):
            raise ValueError(f"path = {str(path)!r}: expected an STL file with triangles, whole and of finite numbers")
        area = np.linalg.norm(_normals(corners), axis=1)  # what programs write has some without any
        return cls(corners[area > 1e-14 * np.ptp(corners, axis=1).max(axis=1) ** 2])

    @classmethod
    def from_mesh(cls, mesh: Mesh, surface: str) -> FacetedSurface:
        """The shape of a named surface of a mesh, such as gmsh makes, with straight facets.

        Args:
            mesh: The mesh.
            surface: The name of the surface.

        Raises:
            ValueError: The mesh has no such surface.
        """
        entities = mesh.entities(surface)
        corners = facet_corners(mesh.domain, entities)
        middle = np.full((1, mesh.dim - 1), 0.5 if mesh.dim == 2 else 0.25)
        outward = surface_points(mesh.domain, entities, middle).normal
        if corners.shape[1] > mesh.dim:  # quadrilaterals: each is two triangles
            corners = np.concatenate([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]])
            outward = np.concatenate([outward, outward])
        return cls(corners, outward)

    def __repr__(self) -> str:
        return f"FacetedSurface({len(self.corners)} facets, dim={self.dim})"

    def distance(self, x: Floats, direction: Floats) -> Floats:
        found = np.full(len(x), np.inf)
        step = max(PAIRS // len(self.corners), 1)
        for start in range(0, len(x), step):
            part = slice(start, start + step)
            found[part] = self._nearest(x[part], direction[part])
        return found

    def _nearest(self, x: Floats, direction: Floats) -> Floats:
        """Of the facets that rays enter, the one next to each point."""
        ray, facet = self._near(x, direction)
        edges = self.corners[facet, 1:] - self.corners[facet, :1]
        system = np.concatenate([edges, -direction[ray, None]], axis=1).swapaxes(1, 2)
        shares = np.linalg.solve(system, (x[ray] - self.corners[facet, 0])[:, :, None])[:, :, 0]
        inside = np.all(shares[:, :-1] >= -SEAM, axis=1) & (shares[:, :-1].sum(axis=1) <= 1 + SEAM)
        ray, t = ray[inside], shares[inside, -1]
        order = np.lexsort((np.abs(t), ray))
        first, at = np.unique(ray[order], return_index=True)
        found = np.full(len(x), np.inf)
        found[first] = t[order][at]
        return found

    def _near(self, x: Floats, direction: Floats) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """The pairs of rays and facets that face them, whose enclosing spheres they pass through."""
        middle = self.corners.mean(axis=1)
        radius = np.linalg.norm(self.corners - middle[:, None], axis=2).max(axis=1)
        along = direction @ middle.T - dot(x, direction)[:, None]
        squared = dot(x, x)[:, None] + dot(middle, middle) - 2 * x @ middle.T - along**2
        slack = 1e-12 * (dot(x, x).max() + dot(middle, middle).max())
        passing = squared <= (radius * (1 + 1e-6)) ** 2 + slack
        against = direction @ self.normals.T < -1e-12
        ray, facet = np.nonzero(passing & against)
        return ray, facet


def _normals(corners: Floats) -> Floats:
    """Normals of facets (facets, dim, dim), as long as their areas, twice of triangles."""
    edges = corners[:, 1:] - corners[:, :1]
    if corners.shape[2] == 3:
        return np.asarray(np.cross(edges[:, 0], edges[:, 1]), dtype=float)
    return np.stack([edges[:, 0, 1], -edges[:, 0, 0]], axis=1)


def _binary(data: bytes) -> Floats | None:
    """The corners (triangles, 3, 3) in a binary STL file; None if it is none."""
    if len(data) < HEADER:
        return None
    count = int.from_bytes(data[HEADER - 4 : HEADER], "little")
    if len(data) != HEADER + count * TRIANGLE.itemsize:
        return None
    return np.frombuffer(data, TRIANGLE, count, HEADER)["corners"].astype(float)


def _text(data: bytes) -> Floats | None:
    """The corners in an STL file as text; None if it is none."""
    text = data.decode("ascii", errors="replace")
    lower = text.strip().lower()
    if not lower.startswith("solid") or "endsolid" not in lower.rpartition("\n")[2]:  # one that is cut off has no end
        return None
    numbers = re.findall(r"^\s*vertex\s+(\S+)\s+(\S+)\s+(\S+)\s*$", text, re.MULTILINE | re.IGNORECASE)
    try:
        corners = np.array(numbers, dtype=float)
    except ValueError:
        return None
    return corners.reshape(-1, 3, 3) if len(corners) % 3 == 0 else None
