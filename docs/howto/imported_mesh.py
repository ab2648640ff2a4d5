# %% [markdown]
# # A mesh from a file
#
# A part drawn and meshed elsewhere comes as a file, with names on its groups: here a gmsh script, whose physical
# groups `pad`, `foot` and `seat` become surfaces. A `.msh` file, a deck of Abaqus or CalculiX (`.inp`) or a universal
# file (`.unv`) is read in the same way, by `cd.read_mesh`. Curved cells (`order=2`) follow arcs.
#
# The part is a clamp with a round pad; it presses on a block that is made here. The meshes do not match, and need not:
# the contact is integrated over the common refinement of both.

# %%
from pathlib import Path

import contactdd as cd

Path("clamp.geo").write_text("""
    size = 1; DefineConstant[ fine = {0.1, Name "Parameters/fine"} ];
    Point(1) = {-3, 0.233, 0, size}; Point(2) = {0, 0, 0, fine}; Point(3) = {3, 0.233, 0, size};
    Point(4) = {3, 4, 0, size}; Point(5) = {10, 4, 0, size}; Point(6) = {10, 8, 0, size};
    Point(7) = {-3, 8, 0, size}; Point(9) = {0, 19.43, 0, size};
    Circle(1) = {1, 9, 2}; Circle(2) = {2, 9, 3}; Line(3) = {3, 4}; Line(4) = {4, 5};
    Line(5) = {5, 6}; Line(6) = {6, 7}; Line(7) = {7, 1};
    Curve Loop(1) = {1:7}; Plane Surface(1) = {1};
    Physical Surface("clamp") = {1}; Physical Curve("pad") = {1, 2};
    Physical Curve("foot") = {5}; Physical Curve("seat") = {6};
""")
mesh = cd.read_gmsh("clamp.geo", order=2, fine=0.05)
print(mesh)

# %%
steel, brass = cd.Isotropic(E=2.1e5, nu=0.3), cd.Isotropic(E=1.0e5, nu=0.35)
clamp = cd.Body("clamp", mesh, steel, supports=[cd.Symmetry("foot")], loads=[cd.Pressure("seat", 20.0)], degree=2)
block = cd.Body("block", cd.rectangle((-8, -6), (8, 0), (160, 30)), brass, supports=[cd.Fixed("bottom")], degree=2)
contact = cd.Contact((clamp, "pad"), (block, "top"), cd.LinearLayer(1e6), name="pad")
solution = cd.solve(cd.Scene([clamp, block], [contact]))
print(solution)
pad = solution.contact("pad")
print(f"force {pad.force:.2f} N/mm, peak {pad.peak_pressure:.0f} MPa at x = {pad.centre_of_pressure[0]:.3f} mm")
solution.plot_bodies(component="von Mises", unit="MPa", edges=True, path="clamp.png")

# %%
solution.plot_contact("pad", along="x", path="pad.png", stress_unit="MPa", length_unit="mm")

# %% [markdown]
# The results go the same way back: `solution.export(folder)` writes bodies and contact surfaces for ParaView.
#
# The load on the seat, 20 MPa over 13 mm, is carried by the pad alone, as the foot only guides:

# %%
assert abs(pad.force_vector[1] / (20.0 * 13) - 1) < 1e-6
assert len(solution.export("results")) >= 5
