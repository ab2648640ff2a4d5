"""contactdd: contact of many elastic bodies through nonlinear Winkler layers by Robin-type domain decomposition.

    import contactdd as cd

The way of the data: mesh and material → body → contact → scene → solve → solution → picture.
"""

from importlib import import_module
from types import ModuleType

__version__ = "0.1.0"

from .base import compat
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
from .hard_contact import HardContact
from .history import History, Record
from .layer import CustomLayer, Layer, LinearLayer, PowerLayer, TableLayer
from .load import BodyForce, Pressure, Resultant, Traction
from .local.choose import LOCAL_SOLVERS, register_local_solver
from .local.dense import DenseSystem
from .local.problem import ContactTrace, Fields, LocalProblem
from .local.reduced import ReducedProblem
from .local.task import LocalTask
from .material import Anisotropic, Isotropic, Material, Orthotropic
from .mesh import Mesh, box, from_dolfinx, from_gmsh, read_gmsh, rectangle
from .meshless import MeshlessBody
from .parameter import Parameter
from .programme import Path, StepFailedError, programme
from .scene import Scene
from .scheme import SCHEMES, Scheme, one_point
from .solution import ContactResult, Solution
from .solve import solve
from .support import Displacement, Fixed, Spring, Symmetry

__all__ = [
    "LOCAL_SOLVERS",
    "SCHEMES",
    "Anisotropic",
    "Body",
    "BodyForce",
    "CheckpointError",
    "Contact",
    "ContactError",
    "ContactResult",
    "ContactTrace",
    "CustomLayer",
    "DenseSystem",
    "Displacement",
    "Fields",
    "Fixed",
    "HardContact",
    "History",
    "Isotropic",
    "Layer",
    "LinearLayer",
    "LocalProblem",
    "LocalTask",
    "LooseBodyError",
    "Material",
    "Mesh",
    "MeshMismatchError",
    "MeshlessBody",
    "NoEquilibriumError",
    "NotConvergedError",
    "Orthotropic",
    "Parameter",
    "Path",
    "PowerLayer",
    "Pressure",
    "Record",
    "ReducedProblem",
    "Resultant",
    "Scene",
    "Scheme",
    "Solution",
    "Spring",
    "StepFailedError",
    "Symmetry",
    "TableLayer",
    "Traction",
    "box",
    "compat",
    "from_dolfinx",
    "from_gmsh",
    "one_point",
    "programme",
    "read_gmsh",
    "rectangle",
    "reference",
    "register_local_solver",
    "solve",
]


def __getattr__(name: str) -> ModuleType:
    """The module `reference`, imported when first asked for: solving needs none of what it imports."""
    if name == "reference":
        return import_module(".reference", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
