"""Fields of a solution as files for ParaView."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from dolfinx import fem, io

if TYPE_CHECKING:
    from ..solution import Solution


def export(solution: Solution, folder: str | Path) -> list[Path]:
    """Write each body's displacement and six stresses as XDMF (with HDF5) into a folder, which is made if missing.

    XDMF holds functions of the mesh's own degree: displacements of higher degree are given at its nodes, stresses by
    cell.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for body in solution.scene.bodies:
        domain, dim = body.mesh.domain, body.mesh.dim
        degree = domain.ufl_domain().ufl_coordinate_element().embedded_superdegree
        displacement = fem.Function(fem.functionspace(domain, ("Lagrange", degree, (dim,))), name="displacement")
        displacement.interpolate(solution.displacement(body))
        stress = fem.Function(fem.functionspace(domain, ("Discontinuous Lagrange", 0, (6,))), name="stress")
        stress.interpolate(solution.stress(body))
        path = folder / f"{body.name}.xdmf"
        with io.XDMFFile(domain.comm, str(path), "w") as file:
            file.write_mesh(domain)
            file.write_function(displacement)
            file.write_function(stress)
        written.append(path)
    return written
