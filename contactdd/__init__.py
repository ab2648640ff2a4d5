"""contactdd: contact of many elastic bodies through nonlinear Winkler layers by Robin-type domain decomposition.

    import contactdd as cd

The way of the data: mesh and material → body → contact → scene → solve → solution → picture.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

from .base import compat
from .body import Body
from .contact import Contact
from .errors import (
    CheckpointError,
    ContactError,
    LayerRangeWarning,
    LooseBodyError,
    MeshMismatchError,
    NoEquilibriumError,
    NotConvergedError,
)
from .history import History, Record
from .layer import Layer, LinearLayer, PowerLayer
from .load import BodyForce, Pressure, Resultant, Traction
from .material import Anisotropic, Isotropic, Material, Orthotropic
from .mesh import Mesh, box, from_dolfinx, from_gmsh, read_gmsh, rectangle
from .parameter import Parameter
from .programme import Path, StepFailedError, programme
from .scene import Scene
from .scheme import SCHEMES, Scheme, one_point
from .solution import ContactResult, Solution
from .solve import solve
from .support import Displacement, Fixed, Spring, Symmetry

if TYPE_CHECKING:
    from . import reference
    from .layers.custom import CustomLayer
    from .layers.exponential import ExponentialLayer, OverclosureLayer
    from .layers.hyperbolic import HyperbolicLayer
    from .layers.logarithmic import LogarithmicLayer
    from .layers.rough import GreenwoodWilliamsonLayer
    from .layers.series import SeriesLayer
    from .layers.table import TableLayer
    from .layers.varying import VaryingLayer

#: Where the layer laws are that most scenes don't use: imported when first asked for.
_LAWS = {
    "CustomLayer": "custom",
    "ExponentialLayer": "exponential",
    "GreenwoodWilliamsonLayer": "rough",
    "HyperbolicLayer": "hyperbolic",
    "LogarithmicLayer": "logarithmic",
    "OverclosureLayer": "exponential",
    "SeriesLayer": "series",
    "TableLayer": "table",
    "VaryingLayer": "varying",
}

__all__ = [
    "SCHEMES",
    "Anisotropic",
    "Body",
    "BodyForce",
    "CheckpointError",
    "Contact",
    "ContactError",
    "ContactResult",
    "CustomLayer",
    "Displacement",
    "ExponentialLayer",
    "Fixed",
    "GreenwoodWilliamsonLayer",
    "History",
    "HyperbolicLayer",
    "Isotropic",
    "Layer",
    "LayerRangeWarning",
    "LinearLayer",
    "LogarithmicLayer",
    "LooseBodyError",
    "Material",
    "Mesh",
    "MeshMismatchError",
    "NoEquilibriumError",
    "NotConvergedError",
    "Orthotropic",
    "OverclosureLayer",
    "Parameter",
    "Path",
    "PowerLayer",
    "Pressure",
    "Record",
    "Resultant",
    "Scene",
    "Scheme",
    "SeriesLayer",
    "Solution",
    "Spring",
    "StepFailedError",
    "Symmetry",
    "TableLayer",
    "Traction",
    "VaryingLayer",
    "box",
    "compat",
    "from_dolfinx",
    "from_gmsh",
    "one_point",
    "programme",
    "read_gmsh",
    "rectangle",
    "reference",
    "solve",
]


def __getattr__(name: str) -> Any:
    """The module `reference` or a layer law, imported when first asked for: solving needs none of what they import."""
    if name == "reference":
        return import_module(".reference", __name__)
    if name in _LAWS:
        return getattr(import_module(f".layers.{_LAWS[name]}", __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """The public names, also of what isn't imported yet."""
    return sorted({*globals(), *__all__})
