#!/usr/bin/env bash
# dolfinx 0.11.0: a rectangular matrix is wrong if a later part of its mixed trial space has oriented facets.
#
# Input:    stresses whose two rows are Raviart-Thomas elements, tested with two constants in each cell; the matrix of
#           the divergence, from both mixed spaces, on two triangles with the area 1/2. The stress whose rows are both
#           (x, y), with the divergence 2, lies in the space.
# Expected: matrix times stress is 1 in every cell for both rows, by hand. The linear form that has the stress as a
#           coefficient, the transpose of the matrix with both spaces swapped, and the same block cut out of a square
#           matrix over one space of all four parts say so too: a bilinear form's entries do not depend on how its
#           spaces are grouped, and the documentation of assemble_matrix restricts it to no kind of spaces.
# Seen:     right for the first row, wrong for the second, without an error. The signs of facets that two cells see in
#           opposite directions are put on columns that belong to other facets: a cell's matrix is passed to each part's
#           transformation from that part's first column on, as a shorter array, from which the length of a row is
#           then taken wrong. Square matrices are long enough that the length is rounded back to the right one. The
#           project has corrected it since (issue 4294); dolfinx 0.9 does the same.
# Exit:     0 if that is still so, 1 if the behaviour has changed.
#
# Python must be 3.12 or later (PYTHON names it), the system's glibc 2.34 or later, and a C compiler there.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"${PYTHON:-python3}" -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check \
  dolfinx-solver-real==0.11.0.post0 mpich==5.0.2 mpi4py==4.1.2 numpy==2.5.5
cd "$work"
XDG_CACHE_HOME=$work "$work/venv/bin/python" - <<'PYTHON'
import sys

import dolfinx_solver  # noqa: F401 # isort: skip - it makes the wheel's MPI and PETSc known to dolfinx
import basix.ufl
import dolfinx
import numpy as np
import ufl
from dolfinx import fem, mesh
from mpi4py import MPI

domain = mesh.create_unit_square(MPI.COMM_SELF, 1, 1)
row = basix.ufl.element("RT", "triangle", 1)
constant = basix.ufl.element("DG", "triangle", 0)
stresses = fem.functionspace(domain, basix.ufl.mixed_element([row, row]))
vectors = fem.functionspace(domain, basix.ufl.mixed_element([constant, constant]))
together = fem.functionspace(domain, basix.ufl.mixed_element([row, row, constant, constant]))


def divergence(rows, vector):
    return (ufl.div(rows[0]) * vector[0] + ufl.div(rows[1]) * vector[1]) * ufl.dx


def matrix(form):
    return fem.assemble_matrix(fem.form(form)).to_dense()


def fill(stress):
    for part in (0, 1):
        stress.sub(part).interpolate(lambda x: x[:2])
    return stress


def by_cell(values, space, parts):
    """For each cell: the values that belong to the first and to the second row."""
    return np.round(np.column_stack([values[space.sub(part).dofmap.list.ravel()] for part in parts]), 12).tolist()


stress = fill(fem.Function(stresses))
rectangular = matrix(divergence(ufl.TrialFunctions(stresses), ufl.TestFunctions(vectors)))
swapped = matrix(divergence(ufl.TestFunctions(stresses), ufl.TrialFunctions(vectors)))
vector = fem.assemble_vector(fem.form(divergence(ufl.split(stress), ufl.TestFunctions(vectors)))).array
square = matrix(divergence(ufl.TrialFunctions(together)[:2], ufl.TestFunctions(together)[2:]))

found = {
    "matrix of the two spaces": by_cell(rectangular @ stress.x.array, vectors, (0, 1)),
    "spaces swapped, transposed": by_cell(swapped.T @ stress.x.array, vectors, (0, 1)),
    "linear form": by_cell(vector, vectors, (0, 1)),
    "square matrix": by_cell(square @ fill(fem.Function(together)).x.array, together, (2, 3)),
}
print("dolfinx", dolfinx.__version__)
expected = [[1, 1], [1, 1]]
for name, values in found.items():
    print(f"{name}: expected {expected}, seen {values}")
wrong = found.pop("matrix of the two spaces")
same = all(values == expected for values in found.values())
same = same and all(first == 1 for first, _ in wrong) and any(second != 1 for _, second in wrong)
print("as described" if same else "CHANGED")
sys.exit(not same)
PYTHON
