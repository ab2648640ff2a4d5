"""Physical names of .msh files are checked before gmsh sees them; here their text alone, without gmsh."""

from __future__ import annotations

import pytest

from contactdd.files.gmsh import check_physical_names


def section(*lines: str) -> str:
    return "\n".join(["$MeshFormat", "$PhysicalNames", str(len(lines)), *lines, "$EndPhysicalNames", ""])


@pytest.mark.parametrize("dim", ["4", "12", "-1"])
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_names_of_no_dimension_are_refused(dim, end):
    text = section('1 7 "joint"', f'{dim} 1 "low part"').replace("\n", end)
    with pytest.raises(
        ValueError, match=rf'the file has the physical name "low part" of the dimension {dim}; expected'
    ):
        check_physical_names("the file", text)


def test_good_names_and_no_names_are_not():
    check_physical_names("the file", section('0 1 "corner"', '1 7 "9 1 joint"', '3 2 "block"'))
    check_physical_names("the file", "$Nodes\n1\n9 1 0\n$EndNodes\n")
