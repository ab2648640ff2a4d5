"""contactdd: contact of many elastic bodies through nonlinear Winkler layers by Robin-type domain decomposition.

    import contactdd as cd

The way of the data: mesh and material → body → contact → scene → solve → solution → picture.
"""

import warnings
from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.2.0"

from .base import compat
from .body import Body
from .body_result import BodyResult
from .contact import Contact
from .contact_result import ContactResult
from .contact_sides import ContactSides
from .error_estimate import ContactErrorEstimate, ErrorEstimate, Estimated, error_estimate
from .errors import (
    CheckpointError,
    ContactError,
    ContactWarning,
    LargeStrainWarning,
    LayerRangeWarning,
    LooseBodyError,
    MeshMismatchError,
    NoEquilibriumError,
    NotConvergedError,
)
from .hard_contact import HardContact
from .history import History, Record
from .layer import Layer, LinearLayer, PowerLayer
from .load import BodyForce, BodyLoad, Pressure, Resultant, Traction
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
from .relaxation import Correction
from .scene import Scene
from .scheme import SCHEMES, Scheme, one_point
from .solution import Solution
from .solve import solve
from .support import Displacement, Fixed, PointDisplacement, Spring, Symmetry
from .surface_result import SurfaceResult

if TYPE_CHECKING:
    from . import reference
    from .adaptation import Adaptation, Round, adapt
    from .decks import read_scene
    from .dual.bound import EnergyBound, energy_bound
    from .eigenstrain import Eigenstrain, ThermalStrain
    from .files import from_gmsh, read_bodies, read_geometry, read_gmsh, read_mesh
    from .layers.bonded import BondedLayer
    from .layers.custom import CustomLayer
    from .layers.exponential import ExponentialLayer, OverclosureLayer
    from .layers.gasket import GasketLayer
    from .layers.hyperbolic import HyperbolicLayer
    from .layers.logarithmic import LogarithmicLayer
    from .layers.rough import GreenwoodWilliamsonLayer
    from .layers.series import SeriesLayer
    from .layers.table import TableLayer
    from .layers.varying import VaryingLayer
    from .linear_form import LinearForm
    from .partners.half_plane import HalfPlane
    from .partners.half_space import AxisymmetricHalfSpace, HalfSpace
    from .partners.mirror_plane import MirrorPlane
    from .partners.periodic import ElasticStrip, PeriodicHalfPlane
    from .partners.periodic_half_space import PeriodicHalfSpace
    from .partners.rigid_body import RigidBody
    from .point_force import PointForce
    from .saved import SavedSolution, load_solution
    from .scene_file import SceneFile, SceneFileError, read_scene_file
    from .shapes import Cone, Cylinder, FlatPunch, LevelSet, Plane, Profile, Shape, Sphere
    from .shapes.faceted import FacetedSurface
    from .surface_heights import SurfaceHeights

#: Where that is which most scenes don't use, imported when first asked for: layer laws, bodies without a mesh and their
#: shapes, files, saved solutions, adaptation.
_LATER = {
    "Adaptation": "adaptation",
    "AxisymmetricHalfSpace": "partners.half_space",
    "BondedLayer": "layers.bonded",
    "Cone": "shapes",
    "CustomLayer": "layers.custom",
    "Cylinder": "shapes",
    "Eigenstrain": "eigenstrain",
    "ElasticStrip": "partners.periodic",
    "EnergyBound": "dual.bound",
    "ExponentialLayer": "layers.exponential",
    "FacetedSurface": "shapes.faceted",
    "FlatPunch": "shapes",
    "GasketLayer": "layers.gasket",
    "GreenwoodWilliamsonLayer": "layers.rough",
    "HalfPlane": "partners.half_plane",
    "HalfSpace": "partners.half_space",
    "HyperbolicLayer": "layers.hyperbolic",
    "LevelSet": "shapes",
    "LinearForm": "linear_form",
    "LogarithmicLayer": "layers.logarithmic",
    "MirrorPlane": "partners.mirror_plane",
    "OverclosureLayer": "layers.exponential",
    "PeriodicHalfPlane": "partners.periodic",
    "PeriodicHalfSpace": "partners.periodic_half_space",
    "Plane": "shapes",
    "PointForce": "point_force",
    "Profile": "shapes",
    "RigidBody": "partners.rigid_body",
    "Round": "adaptation",
    "SavedSolution": "saved",
    "SceneFile": "scene_file",
    "SceneFileError": "scene_file",
    "SeriesLayer": "layers.series",
    "Shape": "shapes",
    "Sphere": "shapes",
    "SurfaceHeights": "surface_heights",
    "TableLayer": "layers.table",
    "ThermalStrain": "eigenstrain",
    "VaryingLayer": "layers.varying",
    "adapt": "adaptation",
    "energy_bound": "dual.bound",
    "from_gmsh": "files",
    "load_solution": "saved",
    "read_bodies": "files",
    "read_geometry": "files",
    "read_gmsh": "files",
    "read_mesh": "files",
    "read_scene": "decks",
    "read_scene_file": "scene_file",
}

__all__ = [
    "LOCAL_SOLVERS",
    "SCHEMES",
    "Adaptation",
    "Anisotropic",
    "AxisymmetricHalfSpace",
    "Body",
    "BodyForce",
    "BodyLoad",
    "BodyResult",
    "BondedLayer",
    "CheckpointError",
    "Cone",
    "Contact",
    "ContactError",
    "ContactErrorEstimate",
    "ContactResult",
    "ContactSides",
    "ContactTrace",
    "ContactWarning",
    "Correction",
    "CustomLayer",
    "Cylinder",
    "DenseSystem",
    "Displacement",
    "Eigenstrain",
    "ElasticStrip",
    "EnergyBound",
    "ErrorEstimate",
    "Estimated",
    "ExponentialLayer",
    "FacetedSurface",
    "Fields",
    "Fixed",
    "FlatPunch",
    "GasketLayer",
    "GreenwoodWilliamsonLayer",
    "HalfPlane",
    "HalfSpace",
    "HardContact",
    "History",
    "HyperbolicLayer",
    "Isotropic",
    "LargeStrainWarning",
    "Layer",
    "LayerRangeWarning",
    "LevelSet",
    "LinearForm",
    "LinearLayer",
    "LoadPath",
    "LocalProblem",
    "LocalTask",
    "LogarithmicLayer",
    "LooseBodyError",
    "Material",
    "Mesh",
    "MeshMismatchError",
    "MeshlessBody",
    "MirrorPlane",
    "NoEquilibriumError",
    "NotConvergedError",
    "Orthotropic",
    "OverclosureLayer",
    "Parameter",
    "PeriodicHalfPlane",
    "PeriodicHalfSpace",
    "Plane",
    "PointDisplacement",
    "PointForce",
    "PowerLayer",
    "Pressure",
    "Profile",
    "Record",
    "ReducedProblem",
    "Resultant",
    "RigidBody",
    "Round",
    "SavedSolution",
    "Scene",
    "SceneFile",
    "SceneFileError",
    "Scheme",
    "SeriesLayer",
    "Shape",
    "Solution",
    "Sphere",
    "Spring",
    "StepFailedError",
    "SurfaceHeights",
    "SurfaceResult",
    "Symmetry",
    "TableLayer",
    "ThermalStrain",
    "Traction",
    "VaryingLayer",
    "adapt",
    "box",
    "compat",
    "energy_bound",
    "error_estimate",
    "from_dolfinx",
    "from_gmsh",
    "load_solution",
    "one_point",
    "programme",
    "read_bodies",
    "read_geometry",
    "read_gmsh",
    "read_mesh",
    "read_scene",
    "read_scene_file",
    "rectangle",
    "reference",
    "register_local_solver",
    "solve",
]


def __getattr__(name: str) -> Any:
    """The module `reference` and the names in `_LATER`, imported when first asked for; old names."""
    if name == "reference":
        return import_module(".reference", __name__)
    if name in _LATER:
        return getattr(import_module(f".{_LATER[name]}", __name__), name)
    if name == "Path":
        warnings.warn("cd.Path is now called cd.LoadPath", DeprecationWarning, stacklevel=2)
        return LoadPath
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """The public names, also of what isn't imported yet."""
    return sorted({*globals(), *__all__})
