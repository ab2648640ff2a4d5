"""contactdd: contact of many elastic bodies through nonlinear Winkler layers by Robin-type domain decomposition.

    import contactdd as cd

The way of the data: mesh and material → body → contact → scene → solve → solution → picture.
"""

import warnings
from importlib import import_module
from types import ModuleType

__version__ = "0.2.0"

from .base import compat
from .body import Body
from .body_result import BodyResult
from .contact import Contact
from .contact_result import ContactResult
from .error_estimate import ContactErrorEstimate, ErrorEstimate, Estimated, error_estimate
from .errors import (
    CheckpointError,
    ContactError,
    ContactWarning,
    LargeStrainWarning,
    LooseBodyError,
    MeshMismatchError,
    NoEquilibriumError,
    NotConvergedError,
)
from .files import from_gmsh, read_bodies, read_gmsh, read_mesh
from .history import History, Record
from .layer import CustomLayer, Layer, LinearLayer, PowerLayer, TableLayer
from .load import BodyForce, Pressure, Resultant, Traction
from .local.choose import LOCAL_SOLVERS, register_local_solver
from .local.dense import DenseSystem
from .local.problem import ContactTrace, Fields, LocalProblem
from .local.reduced import ReducedProblem
from .local.task import LocalTask
from .material import Anisotropic, Isotropic, Material, Orthotropic
from .mesh import Mesh, box, from_dolfinx, rectangle
from .meshless import MeshlessBody
from .parameter import Parameter
from .programme import LoadPath, StepFailedError, programme
from .saved import SavedSolution, load_solution
from .scene import Scene
from .scheme import SCHEMES, Scheme, one_point
from .solution import Solution
from .solve import solve
from .support import Displacement, Fixed, Spring, Symmetry
from .surface_result import SurfaceResult

__all__ = [
    "LOCAL_SOLVERS",
    "SCHEMES",
    "Anisotropic",
    "Body",
    "BodyForce",
    "BodyResult",
    "CheckpointError",
    "Contact",
    "ContactError",
    "ContactErrorEstimate",
    "ContactResult",
    "ContactTrace",
    "ContactWarning",
    "CustomLayer",
    "DenseSystem",
    "Displacement",
    "ErrorEstimate",
    "Estimated",
    "Fields",
    "Fixed",
    "History",
    "Isotropic",
    "LargeStrainWarning",
    "Layer",
    "LinearLayer",
    "LoadPath",
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
    "PowerLayer",
    "Pressure",
    "Record",
    "ReducedProblem",
    "Resultant",
    "SavedSolution",
    "Scene",
    "Scheme",
    "Solution",
    "Spring",
    "StepFailedError",
    "SurfaceResult",
    "Symmetry",
    "TableLayer",
    "Traction",
    "box",
    "compat",
    "error_estimate",
    "from_dolfinx",
    "from_gmsh",
    "load_solution",
    "one_point",
    "programme",
    "read_bodies",
    "read_gmsh",
    "read_mesh",
    "rectangle",
    "reference",
    "register_local_solver",
    "solve",
]


def __getattr__(name: str) -> ModuleType | type:
    """The module `reference`, imported when first asked for: solving needs none of what it imports; and old names."""
    if name == "reference":
        return import_module(".reference", __name__)
    if name == "Path":
        warnings.warn("cd.Path is now called cd.LoadPath", DeprecationWarning, stacklevel=2)
        return LoadPath
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
