import numpy as np

import contactdd as cd

steel = cd.Isotropic(E=2.1e5, nu=0.3)  # MPa; lengths in cm
sides = [cd.Symmetry("left", "right")]
mesh = cd.rectangle((0, 0), (4, 1), (32, 16))
lower = cd.Body("lower", mesh, steel, supports=sides, loads=[cd.Pressure("bottom", 10)])
mesh = cd.rectangle((0, 1), (4, 2), (32, 16))
upper = cd.Body("upper", mesh, steel, supports=sides, loads=[cd.Pressure("top", 10)])


def groove(x):
    return 5e-4 * np.maximum(1 - x[0] ** 2, 0) ** 1.5


layer = cd.PowerLayer(B=4e-6, a=1.1)
contact = cd.Contact((lower, "top"), (upper, "bottom"), layer, gap=groove)
solution = cd.solve(cd.Scene([lower, upper], [contact]))
print(solution)
solution.plot_contact(path="contact.png")
solution.plot_bodies(component="yy", path="bodies.png")
