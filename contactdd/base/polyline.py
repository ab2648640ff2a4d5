"""A curve of straight segments in the plane: their order, and the arc length of points along it.

A contact surface of a plane body is such a curve, whose facets a mesh keeps in any order. Each connected piece is a
chain; it starts at the end with the smaller x (of equal ones, the smaller y), a closed one there and runs
counter-clockwise. So the arc length does not depend on the mesh's numbering.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .arrays import TINY, Floats, Indices

#: Ends of segments closer than this part of the curve's size are one.
SAME_END = 1e-9


@dataclass(frozen=True)
class Polyline:
    """Segments in order.

    starts, ends: (n, dim) of the segments; arc: (n,) the arc length at their starts; chain: (n,) the connected piece
    that each belongs to. The arc length goes on from one piece to the next without a jump.
    """

    starts: Floats
    ends: Floats
    arc: Floats
    chain: Indices

    @property
    def length(self) -> float:
        """The length of all segments."""
        return float(np.linalg.norm(self.ends - self.starts, axis=1).sum())

    def locate(self, points: Floats) -> tuple[Floats, Indices, Floats]:
        """The arc length of the nearest point of the curve, its chain, and how far it is: (m,) each."""
        from scipy.spatial import cKDTree

        middles = 0.5 * (self.starts + self.ends)
        near = cKDTree(middles).query(points, k=min(4, len(middles)))[1].reshape(len(points), -1)
        start, along = self.starts[near], (self.ends - self.starts)[near]
        length = np.linalg.norm(along, axis=2)
        part = np.clip(np.einsum("mki,mki->mk", points[:, None] - start, along) / length**2, 0.0, 1.0)
        away = np.linalg.norm(points[:, None] - start - part[:, :, None] * along, axis=2)
        best = (np.arange(len(points)), np.argmin(away, axis=1))
        segment = near[best]
        return self.arc[segment] + (part * length)[best], self.chain[segment], away[best]


def polyline(segments: Floats) -> Polyline:
    """The curve of segments (n, 2, dim) that are given in any order and direction."""
    from scipy.spatial import cKDTree

    flat = segments.reshape(-1, segments.shape[2])
    cell = SAME_END * max(float(np.ptp(flat, axis=0).max()), TINY)
    node = np.arange(len(flat))
    for one, other in sorted(cKDTree(flat).query_pairs(cell)):
        node[other] = min(node[other], node[one])
    pairs = node.reshape(-1, 2)
    chains = sorted(_chains(pairs, flat), key=lambda chain: tuple(flat[chain[0][0]]))
    ordered = np.array([step for chain in chains for step in chain])
    starts, ends = flat[ordered[:, 0]], flat[ordered[:, 1]]
    lengths = np.linalg.norm(ends - starts, axis=1)
    owner = np.repeat(np.arange(len(chains)), [len(chain) for chain in chains])
    return Polyline(starts, ends, np.concatenate([[0.0], np.cumsum(lengths)[:-1]]), owner)


def _chains(pairs: Indices, x: Floats) -> list[list[tuple[int, int]]]:
    """The connected pieces, each a list of (start, end) nodes along it."""
    touching: dict[int, list[int]] = {}
    for segment, pair in enumerate(pairs):
        for node in map(int, pair):
            touching.setdefault(node, []).append(segment)
    by_place = sorted(touching, key=lambda node: tuple(x[node]))
    free = [node for node in by_place if len(touching[node]) == 1]
    left, chains = set(range(len(pairs))), []
    for node in free + by_place:  # open pieces from their ends first, what is then left is closed
        while any(segment in left for segment in touching[node]):
            chain = _walk(node, pairs, touching, left)
            chains.append(chain if len(touching[node]) == 1 else _counter_clockwise(chain, x))
    return chains


def _walk(node: int, pairs: Indices, touching: dict[int, list[int]], left: set[int]) -> list[tuple[int, int]]:
    """The way from a node along segments that are left, which it uses up."""
    chain = []
    while following := [segment for segment in touching[node] if segment in left]:
        left.remove(following[0])
        one, other = pairs[following[0]]
        after = int(other if one == node else one)
        chain.append((node, after))
        node = after
    return chain


def _counter_clockwise(chain: list[tuple[int, int]], x: Floats) -> list[tuple[int, int]]:
    """A closed chain in the counter-clockwise sense."""
    start, end = (x[list(nodes)] for nodes in zip(*chain, strict=True))
    area = np.sum(start[:, 0] * end[:, 1] - end[:, 0] * start[:, 1])
    return chain if area >= 0.0 else [(end, start) for start, end in reversed(chain)]
