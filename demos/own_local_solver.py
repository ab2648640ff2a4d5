# %% [markdown]
# # A local solver of your own
#
# The methods ask of a body no more than a local problem: how its unknowns answer a Robin condition on its contacts,
#
# $$a(\tilde u, v) + \int \varphi\,\tilde u_n v_n = l(v) + \int (\varphi\,u_n + g^-(z))\,v_n .$$
#
# How it is solved is the body's own affair. Here the upper body of the groove is solved by Ritz's method: its
# displacements are combinations of harmonics along the contact, which fade away from it, instead of the thousands of
# nodal values of its mesh. The lower body stays with finite elements.
#
# A harmonic of wave number $k$ dies out like $e^{-ky}(1 + cy)$, $y$ the distance from the face that it starts from. The
# upper body gets these for both of its faces, a uniform compression, and its rigid motions.
# %%
import argparse
from pathlib import Path

import numpy as np

import contactdd as cd

STEEL, WALLS = cd.Isotropic(E=2.1e5, nu=0.3), [cd.Symmetry("left", "right")]


def harmonics(task: cd.LocalTask) -> cd.ReducedProblem:
    """The local solver: from a body with its contacts to its local problem."""
    x, y, _ = task.body.space.tabulate_dof_coordinates().T
    y, zero = y - 1, 0 * x
    shapes = [np.column_stack([zero, y])]
    for k in np.pi / 4 * np.arange(1, 25):
        for fading in (np.exp(-k * y), y * np.exp(-k * y), np.exp(k * (y - 1)), (1 - y) * np.exp(k * (y - 1))):
            shapes += [np.column_stack([np.sin(k * x) * fading, zero]), np.column_stack([zero, np.cos(k * x) * fading])]
    return cd.ReducedProblem(task, np.column_stack([task.body.rigid_modes(), *(shape.ravel() for shape in shapes)]))


def pressure(local_solver=None) -> cd.ContactResult:
    meshes = [cd.rectangle((0, y), (4, y + 1), (64, 16)) for y in (0, 1)]
    lower = cd.Body("lower", meshes[0], STEEL, supports=WALLS, loads=[cd.Pressure("bottom", 10)])
    load = [cd.Pressure("top", 10)]
    upper = cd.Body("upper", meshes[1], STEEL, supports=WALLS, loads=load, local_solver=local_solver)
    contact = cd.Contact((lower, "top"), (upper, "bottom"), cd.PowerLayer(4e-6, 1.1), gap=groove)
    return cd.solve(cd.Scene([lower, upper], [contact])).contact()


def groove(x):
    return 5e-4 * np.maximum(1 - x[0] ** 2, 0) ** 1.5


# %% [markdown]
# Every method of the package takes such a body, decomposed or coupled, and it may stand beside any other.
# %%
def main() -> None:
    import matplotlib.pyplot as plt

    parser = argparse.ArgumentParser()
    parser.add_argument("--out", type=Path, default=Path(__file__).parent / "out" / "own_local_solver")
    out = parser.parse_args().out
    out.mkdir(parents=True, exist_ok=True)
    ours, theirs = pressure(harmonics), pressure()
    error = np.sqrt(theirs.weights @ (ours.pressure - theirs.pressure) ** 2 / (theirs.weights @ theirs.pressure**2))
    figure, axes = plt.subplots(figsize=(7, 4))
    for result, style, name in ((theirs, "-", "finite elements"), (ours, "--", "harmonics")):
        order = np.argsort(result.x[:, 0])
        axes.plot(result.x[order, 0], result.pressure[order], style, label=f"upper body by {name}")
    axes.set(xlabel="x, cm", ylabel="contact pressure, MPa", title="The groove, its upper body solved in two ways")
    axes.legend()
    figure.savefig(out / "pressure.png", dpi=150, bbox_inches="tight")
    print(f"difference of the pressures, relative L2: {error:.1e}")
    assert error < 1e-3  # 24 harmonics; 48 leave a tenth of it


if __name__ == "__main__":
    main()
