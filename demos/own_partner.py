# %% [markdown]
# # A body without a mesh
#
# A contact asks little of a body: where its surface lies opposite given points, and how its degrees of freedom move it
# there. So a body need not have a mesh. Here the upper strip of the groove, of height $h$, is known by its influence
# functions: a pressure $\cos kx$ on its face moves it by $c(k)\cos kx$ (plane strain, sides that keep their planes),
#
# $$c(k) = \frac{2(1-\nu^2)}{E k}\,\frac{\sinh kh\,\cosh kh + kh}{\sinh^2 kh - k^2h^2},$$
#
# which `cd.reference.surface_compliance` evaluates. Its degrees of freedom are the normal displacements at equidistant
# places of the face. Their cosine transform divided by $c(k)$ is the pressure, which makes the stiffness matrix; the
# wave number zero is the rigid motion, which costs nothing. The lower strip is meshed as usual.
#
# The pressures are compared with the semi-analytic solution of both strips: the error is that of the meshed strip alone
# and halves at least when the cells are halved.
# %%
import argparse
from pathlib import Path

import numpy as np

import contactdd as cd

LENGTH, HEIGHT, LOAD, E, NU = 4.0, 1.0, 10.0, 2.1e5, 0.3


class Strip(cd.MeshlessBody):
    """A strip on a face y = at, loaded evenly on its other side, by the influence functions of its face."""

    def __init__(self, name: str, at: float, places: int) -> None:
        super().__init__(name)
        self.at, self.x = at, np.linspace(0, LENGTH, places)
        self.weights = np.gradient(self.x)
        self.weights[[0, -1]] /= 2
        self.length = LENGTH

    @property
    def size(self) -> int:
        return len(self.x)

    def gap(self, x, direction):
        return (self.at - x[:, 1]) / direction[:, 1]

    def normal_displacement(self, x, direction):
        return np.column_stack([np.interp(x[:, 0], self.x, unit) for unit in np.eye(self.size)])

    def stiffness(self):
        k = np.pi / LENGTH * np.arange(self.size)
        waves = np.cos(np.outer(self.x, k))
        stiff = np.append(0, 1 / cd.reference.surface_compliance(k[1:], HEIGHT, E, NU))
        matrix = self.weights[:, None] * (waves * stiff) @ np.linalg.inv(waves)
        return (matrix + matrix.T) / 2

    def load(self):
        return LOAD * self.weights

    def rigid_motions(self):
        return np.ones((self.size, 1)), np.array([[0.0], [-1.0], [0.0]])  # outward, which is down

    def resultant(self, forces):
        return np.array([0.0, -forces.sum()])


# %%
def solve(cells: int, method: str = "auto") -> cd.Solution:
    mesh = cd.rectangle((0, 0), (LENGTH, 1), (cells, cells // 2))
    load, walls = [cd.Pressure("bottom", LOAD)], [cd.Symmetry("left", "right")]
    lower = cd.Body("lower", mesh, cd.Isotropic(E, NU), supports=walls, loads=load)
    upper, layer = Strip("upper", 1.0, cells + 1), cd.PowerLayer(4e-6, 1.1)
    contact = cd.Contact((lower, "top"), upper, layer, gap=lambda x: 5e-4 * np.maximum(1 - x[0] ** 2, 0) ** 1.5)
    return cd.solve(cd.Scene([lower, upper], [contact]), method)


def error(solution: cd.Solution) -> float:
    """The relative L2 error of the contact pressure."""
    result = solution.contact(degree=16)
    exact = cd.reference.groove().pressure(result.x[:, 0])
    return float(np.sqrt(result.weights @ (result.pressure - exact) ** 2 / (result.weights @ exact**2)))


def main() -> None:
    import matplotlib.pyplot as plt

    parser = argparse.ArgumentParser()
    parser.add_argument("--out", type=Path, default=Path(__file__).parent / "out" / "own_partner")
    out = parser.parse_args().out
    out.mkdir(parents=True, exist_ok=True)
    solutions = {cells: solve(cells) for cells in (16, 32, 64)}
    errors = {cells: error(solution) for cells, solution in solutions.items()}
    result = solutions[64].contact()
    order = np.argsort(result.x[:, 0])
    figure, axes = plt.subplots(figsize=(7, 4))
    axes.plot(result.x[order, 0], result.pressure[order], label="upper strip without a mesh")
    axes.plot(result.x[order, 0], cd.reference.groove().pressure(result.x[order, 0]), "--", label="semi-analytic")
    axes.set(xlabel="x, cm", ylabel="contact pressure, MPa", title="The groove, one strip by influence functions")
    axes.legend()
    figure.savefig(out / "pressure.png", dpi=150, bbox_inches="tight")
    print("cells, relative L2 error of the pressure:", ", ".join(f"{n}: {e:.1e}" for n, e in errors.items()))
    # Linear triangles: a quarter for half the cells, as far as the kink at the edge of contact lets them.
    assert errors[64] < 0.4 * errors[32] < 0.16 * errors[16]


if __name__ == "__main__":
    main()
