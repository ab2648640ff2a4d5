"""The memory that a factorisation will take, estimated in advance."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..body import Body


#: Unknowns of a body up to which memory need not be estimated.
ALWAYS_FACTORED = 20_000


def refuse_if_too_large(body: Body) -> None:
    """Raise MemoryError before a factorisation that cannot fit is begun."""
    if _is_small(body):
        return
    wanted, there = factor_bytes(body.mesh.dim, body.dofs), available_bytes()
    if wanted > there:
        raise MemoryError(
            f"body {body.name!r}: factoring its {body.dofs} unknowns takes about {wanted / 2**30:.1f} GiB, "
            f"{there / 2**30:.1f} GiB are available; use local_solver='multigrid'"
        )


def _is_small(body: Body) -> bool:
    """Whether a body is so small that memory need not be estimated; mostly the number of cells decides."""
    return body.mesh.cells * body.elements.element.dim <= ALWAYS_FACTORED or body.dofs <= ALWAYS_FACTORED


def factor_bytes(dim: int, unknowns: int) -> float:
    """An estimate of the memory of a sparse Cholesky factorisation.

    Nested dissection leaves O(n log n) entries in the plane and O(n^{4/3}) in space; the factors in front were measured
    with Debian's MUMPS, which orders without METIS; along a dissection of the cells it is a third less in space.
    """
    n = float(max(unknowns, 2))
    if dim == 2:
        return 8.0 * 16.0 * n * math.log2(n)
    return 8.0 * 35.0 * n ** (4.0 / 3.0)


def available_bytes() -> float:
    """The free memory of the machine in bytes, infinity where it is unknown."""
    try:
        lines = Path("/proc/meminfo").read_text().splitlines()
    except OSError:
        return float("inf")
    for line in lines:
        if line.startswith("MemAvailable:"):
            return 1024.0 * float(line.split()[1])
    return float("inf")
