"""What every other part may use: arrays, checks, facets of meshes, versions of dolfinx, MPI ranks."""
