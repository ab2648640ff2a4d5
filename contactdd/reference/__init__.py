"""Known answers: closed-form and semi-analytic contact solutions to test against.

Lengths and stresses are in the user's own consistent set of units. Plane problems are plane strain,
with forces and energies per unit thickness. Pressures are positive in compression. Arguments out of
range are refused with a TypeError or ValueError that names them.
"""

from .columns import (
    ColumnStack,
    ParabolaOnLayer,
    UniformCompression,
    column_stack,
    rigid_parabola_on_layer,
    uniform_compression,
)
from .dimple import Dimple, dimple
from .groove import Groove, groove, surface_compliance
from .half_plane import HalfPlaneGroove, groove_half_planes
from .hertz import HertzCylinder, HertzSphere, hertz_cylinder, hertz_sphere

__all__ = [
    "ColumnStack",
    "Dimple",
    "Groove",
    "HalfPlaneGroove",
    "HertzCylinder",
    "HertzSphere",
    "ParabolaOnLayer",
    "UniformCompression",
    "column_stack",
    "dimple",
    "groove",
    "groove_half_planes",
    "hertz_cylinder",
    "hertz_sphere",
    "rigid_parabola_on_layer",
    "surface_compliance",
    "uniform_compression",
]
