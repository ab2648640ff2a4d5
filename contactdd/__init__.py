"""contactdd: contact of many elastic bodies through nonlinear Winkler layers by Robin-type domain decomposition.

    import contactdd as cd

The way of the data: mesh and material → body → contact → scene → solve → solution → picture.
"""

__version__ = "0.1.0"

from . import reference
from .body import Body
from .contact import Contact
from .errors import (
    CheckpointError,
    ContactError,
    LooseBodyError,
    MeshMismatchError,
    NoEquilibriumError,
    NotConvergedError,
)
from .history import History, Record
from .layer import CustomLayer, Layer, LinearLayer, PowerLayer, TableLayer
from .load import BodyForce, Pressure, Traction
from .material import Isotropic
from .mesh import Mesh, box, from_dolfinx, from_gmsh, read_gmsh, rectangle
from .scene import Scene
from .scheme import SCHEMES, Scheme, one_point
from .solution import ContactResult, Solution
from .solve import solve
from .support import Displacement, Fixed, Symmetry

__all__ = [
    "SCHEMES",
    "Body",
    "BodyForce",
    "CheckpointError",
    "Contact",
    "ContactError",
    "ContactResult",
    "CustomLayer",
    "Displacement",
    "Fixed",
    "History",
    "Isotropic",
    "Layer",
    "LinearLayer",
    "LooseBodyError",
    "Mesh",
    "MeshMismatchError",
    "NoEquilibriumError",
    "NotConvergedError",
    "PowerLayer",
    "Pressure",
    "Record",
    "Scene",
    "Scheme",
    "Solution",
    "Symmetry",
    "TableLayer",
    "Traction",
    "box",
    "from_dolfinx",
    "from_gmsh",
    "one_point",
    "read_gmsh",
    "rectangle",
    "reference",
    "solve",
]
