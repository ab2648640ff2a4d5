"""What does a file hold? Nodes, cells and named groups, read into arrays and checked before dolfinx gets them."""

from .gmsh import from_gmsh, mesh_cache
from .read import read_bodies, read_geometry, read_gmsh, read_mesh

__all__ = ["from_gmsh", "mesh_cache", "read_bodies", "read_geometry", "read_gmsh", "read_mesh"]
