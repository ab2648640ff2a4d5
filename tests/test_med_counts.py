"""MED files whose tables have not the length that their cells need."""

from __future__ import annotations

import numpy as np
import pytest

import contactdd as cd

h5py = pytest.importorskip("h5py", reason="h5py, which reads MED files, is not installed")


@pytest.mark.parametrize(("nodes", "families"), [(5, 2), (6, 1)])
def test_tables_of_another_length_are_refused(tmp_path, nodes, families):
    path = tmp_path / "square.med"
    with h5py.File(path, "w") as file:
        mesh = file.create_group("ENS_MAA/square")
        file.create_group("FAS/square")
        x = mesh.create_dataset("NOE/COO", data=[0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0])
        x.attrs["NBR"] = 4
        mesh.create_dataset("MAI/TR3/NOD", data=np.array([1, 1, 2, 3, 3, 4])[:nodes])
        mesh.create_dataset("MAI/TR3/FAM", data=np.zeros(families, dtype=int))
    with pytest.raises(ValueError, match=f"square.med.* has {nodes} nodes and {families} families of the 3-node tri"):
        cd.read_mesh(path)
