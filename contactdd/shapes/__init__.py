"""Where is a rigid body's surface? Shapes, seen along rays from the points of a contact."""

from .level_set import LevelSet
from .plane import FlatPunch, Plane
from .profile import Profile
from .round import Cone, Cylinder, Sphere
from .shape import Shape

__all__ = ["Cone", "Cylinder", "FlatPunch", "LevelSet", "Plane", "Profile", "Shape", "Sphere"]
