# %% [markdown]
# # A coated roller
#
# Rollers of printers and laminating machines are silicone rubber on a steel core, with
# a skin of a hard polymer, a tenth of a millimetre thick and some hundred times as
# stiff, that lets paper and toner go. The pressure in the nip, where the roller is
# pressed on a stiff plate, is what fixes the toner: how high is it, how wide, and what
# does the skin do to it?
#
# ## Known beforehand
#
# Without its skin the roller is a cylinder of the radius $R$ under the force $F$ (per
# unit of length), whose nip is far narrower than the rubber is thick. Hertz found
#
# $$a^2 = \frac{4 F R}{\pi E^*}, \qquad p(x) = \frac{2F}{\pi a}\sqrt{1 - x^2/a^2}, \qquad E^* = \frac{E}{1-\nu^2} .$$
#
# The skin is a beam on the rubber, of the bending stiffness $D = E_s^* t^3/12$. Where it
# lies flat on the plate its curvature has changed by $1/R$ everywhere: its moment $D/R$
# is even, and an even moment needs no load. So inside of the nip the pressure stays
# Hertz'. But where the skin leaves the plate its moment has to fall to zero, over the
# length
#
# $$\ell = t\,\Big(\frac{E_s^*}{6\,E^*}\Big)^{1/3}$$
#
# that its stiffness against the rubber's sets, and that takes a force at the edge of the
# nip, of the order of $D/(R\,\ell)$: the pressure has a peak there, and the rubber
# beside it is held off, so that the nip is narrower.

# %%
import contactdd as cd  # first: it finds the libraries of dolfinx' wheel, where that is installed

# isort: split
import dolfinx
import matplotlib.pyplot as plt
import numpy as np
from mpi4py import MPI
from studies.results import Report

report = Report("coated_roller", "A silicone roller with a thin stiff coating on a rigid plate")
RADIUS, CORE, SKIN = 20.0, 8.0, 0.1  # mm
RUBBER, SOFT, HARD, FORCE = (2.0, 0.48), (40.0, 0.4), (400.0, 0.4), 0.4  # E in MPa and ν; N/mm
EFFECTIVE = RUBBER[0] / (1 - RUBBER[1] ** 2)
HALF_WIDTH = np.sqrt(4 * FORCE * RADIUS / (np.pi * EFFECTIVE))

# %% [markdown]
# ## The mesh
#
# Half of the roller, which is symmetric about the vertical line through the nip. A
# rectangle of quadrilaterals is bent to a ring: angles from 0, at the nip, to $\pi$,
# radii from the core to the skin. Cells are small where the nip may end, a fifth of the
# skin's thickness, of which there are three across it. Rubber is nearly incompressible:
# quadratic elements do not lock there, linear ones would.
#
# Facets are straight, the roller is round: the gap to the plate is that of the smooth
# surface behind the facets, which the contact finds from the nodes.


# %%
def graded(first: float, end: float, ratio: float = 1.15) -> np.ndarray:
    """Steps from 0 to `end` that grow by `ratio`, the first about `first`."""
    count = int(np.ceil(np.log(1 + end / first * (ratio - 1)) / np.log(ratio)))
    steps = np.cumsum(ratio ** np.arange(count))
    return np.concatenate([[0.0], steps * end / steps[-1]])


edge = np.array([0.65, 1.15]) * HALF_WIDTH / RADIUS  # where the nip may end
step = (edge[1] - edge[0]) / 48
inside = edge[0] - graded(step, edge[0], 1.06)[::-1]
angles = np.concatenate([inside, np.linspace(*edge, 49)[1:], edge[1] + graded(step, np.pi - edge[1])[1:]])
depths = np.concatenate([np.linspace(0, SKIN, 4)[:-1], SKIN + graded(SKIN / 3, RADIUS - SKIN - CORE, 1.3)])
shape = (len(angles) - 1, len(depths) - 1)
domain = dolfinx.mesh.create_rectangle(MPI.COMM_SELF, [(0, 0), shape], shape, dolfinx.mesh.CellType.quadrilateral)
index = np.rint(domain.geometry.x[:, :2]).astype(int)
angle, r = angles[index[:, 0]], RADIUS - depths[index[:, 1]]
domain.geometry.x[:, 0], domain.geometry.x[:, 1] = r * np.sin(angle), RADIUS - r * np.cos(angle)


def radius(x: np.ndarray) -> np.ndarray:
    return np.hypot(x[0], x[1] - RADIUS)


mesh = cd.from_dolfinx(
    domain,
    tread=lambda x: (radius(x) > RADIUS - 1e-6) & (x[1] < 0.5 * RADIUS),
    core=lambda x: radius(x) < CORE + 1e-6,
    middle=lambda x: np.abs(x[0]) < 1e-9,
)

# %% [markdown]
# ## The scene
#
# The skin is no layer of the contact but a part of the body, for it carries loads along
# itself, as a Winkler layer never does: the material is a function of the coordinates.
# Between roller and plate there is no layer at all, `cd.HardContact()`: $p \ge 0$,
# $z \ge 0$, $p\,z = 0$. The plate is rigid and has no mesh; it is pressed upwards by the
# force, of which half belongs to this half, and the core is held.


# %%
def roller(skin: tuple[float, float]) -> cd.Scene:
    def constant(index: int):
        return lambda x: np.where(radius(x) > RADIUS - SKIN, skin[index], RUBBER[index])

    supports = [cd.Fixed("core"), cd.Symmetry("middle")]
    body = cd.Body("roller", mesh, cd.Isotropic(constant(0), constant(1)), supports=supports, degree=2)
    plate = cd.RigidBody("plate", cd.Plane((0, 0), (0, 1)), displacement=(0, None), force=(0, 0.5 * FORCE))
    return cd.Scene([body, plate], [cd.Contact((body, "tread"), plate, cd.HardContact())])


results, rows = {}, {}
for name, skin in (("rubber alone", RUBBER), ("soft skin", SOFT), ("hard skin", HARD)):
    scene = roller(skin)
    solution = cd.solve(scene)
    result = results[name] = solution.contact().sorted()
    row = rows[name] = {"force": 2 * float(result.force_vector[1]), "half_width": result.area}
    row |= {"middle": float(result.pressure[0]), "peak": result.peak_pressure}
    row |= {"peak_at": float(result.x[np.argmax(result.pressure), 0]), "imbalance": solution.imbalance}
    row["bending"] = SKIN * (skin[0] / (1 - skin[1] ** 2) / (6 * EFFECTIVE)) ** (1 / 3)
    print(f"{name:13}", ", ".join(f"{key} {value:.4g}" for key, value in row.items()))
hertz = 2 * FORCE / (np.pi * HALF_WIDTH)
print(f"Hertz         half_width {HALF_WIDTH:.4g}, peak {hertz:.4g}")

# %% [markdown]
# Reading (N, mm, MPa): rubber alone is Hertz' cylinder to about one percent, though it
# is held by the core twelve millimetres below. A hard skin leaves the middle of the nip
# as it was, to half a percent, and makes a peak at its edge that is four fifths higher
# than the middle; the nip is a sixth narrower. A skin of a tenth of that modulus takes
# a third of that from the nip, with a low peak. Paper is pressed most at the edges of
# the nip, then.
#
# Whoever takes the skin for a softening layer between roller and plate gets neither:
# a Winkler layer has no bending.
#
# ## Pictures
#
# The pressure in the nip, Hertz' as a line.

# %%
figure, axes = plt.subplots(figsize=(6, 3.8), layout="constrained")
place = np.linspace(-1.6, 1.6, 801) * HALF_WIDTH
axes.plot(place, hertz * np.sqrt(np.maximum(1 - (place / HALF_WIDTH) ** 2, 0)), "k", linewidth=0.9, label="Hertz")
for colour, (name, result) in zip(("C0", "C1", "C3"), results.items(), strict=True):
    x = np.concatenate([-result.x[::-1, 0], result.x[:, 0]])
    p = np.concatenate([result.pressure[::-1], result.pressure])
    axes.plot(x, p, ".-", color=colour, markersize=3, label=name)
axes.set(xlabel="x (mm)", ylabel="pressure (MPa)", xlim=(place[0], place[-1]), ylim=(0, None))
axes.legend(frameon=False)
figure.savefig(report.path("nip.png"), dpi=150)
report.summary(rows | {"hertz": {"peak": hertz, "half_width": HALF_WIDTH}})

# %% [markdown]
# ## What must hold
#
# The force is the load, to what hard contact settles to. Rubber alone has Hertz' peak
# within two percent and his half width within a cell. Under a hard skin the middle is the
# same, the peak lies within a bending length of the edge, and the nip is narrower.

# %%
for row in rows.values():
    assert abs(row["force"] / FORCE - 1) < 1e-5
    assert row["imbalance"] < 1e-8
alone, hard = rows["rubber alone"], rows["hard skin"]
assert abs(alone["peak"] / hertz - 1) < 0.02
assert abs(alone["half_width"] / HALF_WIDTH - 1) < 1 / 24
assert abs(hard["middle"] / alone["middle"] - 1) < 0.01
assert hard["half_width"] - hard["bending"] < hard["peak_at"] < hard["half_width"]
assert hard["half_width"] < rows["soft skin"]["half_width"] < alone["half_width"]
