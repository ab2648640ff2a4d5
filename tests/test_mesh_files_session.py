"""A gmsh session of the user's own is left as it was, also by a file that is refused."""

from __future__ import annotations

import gmsh
import pytest

import contactdd as cd

HEAD = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
ELEMENTS = "$Elements\n1\n1 2 2 1 1 1 2 3\n$EndElements\n"


def triangle(size: float) -> str:
    nodes = f"$Nodes\n3\n1 0 0 0\n2 {size} 0 0\n3 0 {size} 0\n$EndNodes\n"
    return HEAD + nodes + ELEMENTS


@pytest.fixture
def mine(tmp_path):
    """A user's session with a model of size 7."""
    path = tmp_path / "mine.msh"
    path.write_text(triangle(7))
    gmsh.initialize(["tests", "-v", "0"], interruptible=False)
    gmsh.open(str(path))
    yield path
    gmsh.finalize()


def refused_by_us(path):
    with pytest.raises(ValueError, match="gmsh cannot read it"):
        cd.read_gmsh(path)


def refused_before(path):
    current = gmsh.model.getCurrent()
    with pytest.raises(Exception, match="Error loading"):
        gmsh.open(str(path))
    gmsh.model.remove()
    gmsh.model.setCurrent(current)


@pytest.mark.parametrize("refused", [refused_by_us, refused_before])
def test_a_good_file_is_read_after_a_bad_one(mine, tmp_path, refused):
    """After an open that has failed, gmsh's open does nothing: the user's model must not be taken for the file's."""
    bad, good = tmp_path / "bad.msh", tmp_path / "good.msh"
    bad.write_text(HEAD + "$Nodes\n3\n1 0 0 0\n2 1 0 zero\n")
    good.write_text(triangle(1))
    refused(bad)
    assert cd.read_gmsh(good).domain.geometry.x.max() == 1
    assert gmsh.model.list() == ["mine"]
    assert gmsh.model.mesh.getNodes()[1].max() == 7


def test_the_user_can_open_files_after_one_was_refused(mine, tmp_path):
    bad = tmp_path / "bad.msh"
    bad.write_text(HEAD + "$Nodes\n3\n1 0 0 0\n2 1 0 zero\n")
    refused_by_us(bad)
    gmsh.model.add("next")
    gmsh.open(str(mine))
    assert len(gmsh.model.mesh.getNodes()[0]) == 3
