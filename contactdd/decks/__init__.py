"""Scenes from decks of CalculiX and Abaqus: materials, contacts, supports and loads, beside the mesh."""

from .scene import read_scene

__all__ = ["read_scene"]
