# %% [markdown]
# # A glued lap joint under tension
#
# Two plates overlap over a length $L$ and are glued there. One is pulled to the left,
# the other to the right: the glue hands the force on, by shear, and does most of it at
# the two ends of the overlap. Half of a double lap joint is modelled, the thick middle
# plate by half, so that the pair stays straight in the middle.
#
# ## The layer
#
# The glue line is far thinner than the plates, so it is no body but a layer, one that
# carries tension. With $E_a$, $\nu_a$ and the thickness $h$ of the adhesive, across
# and along the joint,
#
# $$\sigma_n = k\,z, \qquad k = \frac{E_a (1-\nu_a)}{(1+\nu_a)(1-2\nu_a)\,h}, \qquad
#   \tau = -k_t\,s, \qquad k_t = \frac{G_a}{h} = \frac{E_a}{2(1+\nu_a)\,h} .$$
#
# $z$ is the opening, $s$ the tangential displacement of one plate relative to the
# other. Both energies are quadratic, $F_1$ stays convex, and in the decomposed methods
# each plate has the Robin term $\int k_t\,\tilde u_t \cdot v_t$ beside the normal one.
#
# ## Known beforehand
#
# Volkersen (1938) takes the plates as rods, of the stiffness $E' t$ with
# $E' = E/(1-\nu^2)$ in plane strain, which nothing bends. For two equal ones under the
# force $F$ (per unit of width)
#
# $$\tau = \frac FL\,\frac\omega2\,\frac{\cosh\,(\omega x / L)}{\sinh\,(\omega/2)}, \qquad
#   \omega^2 = k_t L^2\,\frac{2}{E' t}, \qquad -\tfrac L2 < x < \tfrac L2 .$$
#
# His rods do not shear. In plates the shear stress falls from $\tau$ at the glue to
# zero at the other face, and their faces lag behind by $\tau t/(3G)$ each. Tsai,
# Oplinger and Morton (1998) put that in series with the glue,
#
# $$\frac1{k_t'} = \frac1{k_t} + \frac{2t}{3G} .$$

# %%
from dataclasses import replace
from itertools import pairwise

import matplotlib.pyplot as plt
import numpy as np
from studies.results import Report

import contactdd as cd

report = Report("lap_joint", "A glued lap joint under tension against the shear-lag closed forms")
E, NU, T, L, GRIP, FORCE = 70e3, 0.33, 1.5, 25.0, 60.0, 100.0  # MPa, mm, N/mm
ALUMINIUM, G = cd.Isotropic(E, NU), E / (2 * (1 + NU))
GLUE = cd.BondedLayer.adhesive(E=2500.0, nu=0.35, thickness=0.2)


def shear_lag(x: np.ndarray, glue: cd.BondedLayer, plates_shear: bool) -> np.ndarray:
    """τ at the distances x from the middle of the overlap, by Volkersen, or with the plates' shear."""
    stiffness = 1 / (1 / glue.shear_stiffness + plates_shear * 2 * T / (3 * G))
    omega = L * np.sqrt(2 * stiffness * (1 - NU**2) / (E * T))
    return FORCE / L * omega / 2 * np.cosh(omega * x / L) / np.sinh(omega / 2)


# %% [markdown]
# ## The scene
#
# Plates longer than the overlap, on cells that get smaller towards its ends, down to
# 0.1 mm: there the glue's stress changes within $L/\omega \approx 4$ mm. Nothing says
# where the overlap is: it is where the two surfaces lie opposite each other. Each plate
# is longer than that, and the rest has no partner.
#
# The middle plate ends at its plane of symmetry below. The outer plate is free, as in
# a real joint; or guided, kept straight by rollers on its upper face, as in Volkersen's
# theory, where nothing bends. Guided it cannot get thinner either: so the glue is
# under tension there, which has no part in the shear.


# %%
steps = np.concatenate([[0.0], np.cumsum(np.geomspace(0.1, 1.5, 14))])
half = steps * (0.5 * L / steps[-1])
overlap = np.concatenate([half, (L - half[::-1])[1:]])
grip = np.cumsum(np.geomspace(half[1], 6.0, 20))
grip *= GRIP / grip[-1]
thickness = np.linspace(0, T, 7)


def joint(guided: bool, glue: cd.BondedLayer = GLUE) -> cd.Scene:
    long, longer = np.concatenate([-grip[::-1], overlap]), np.concatenate([overlap, L + grip])
    low = cd.rectangle((-GRIP, 0), (L, T), (long, thickness), shape="quadrilateral")
    high = cd.rectangle((0, T), (L + GRIP, 2 * T), (longer, thickness + T), shape="quadrilateral")
    middle = cd.Body("middle", low, ALUMINIUM, degree=2, supports=[cd.Symmetry("bottom", "left")])
    rollers, pull = [cd.Symmetry("top")] if guided else [], cd.Traction("right", (FORCE / T, 0))
    outer = cd.Body("outer", high, ALUMINIUM, degree=2, supports=rollers, loads=[pull])
    return cd.Scene([middle, outer], [cd.Contact((middle, "top"), (outer, "bottom"), glue)])


# %% [markdown]
# ## Shear along the joint
#
# `result.shear` is the traction on the first body, `result.slip` the displacement that
# causes it, and a negative pressure is tension. The force that crosses the joint is
# the load, whatever the distribution.

# %%
results, rows = {}, {}
for name, guided in (("guided", True), ("free", False)):
    scene = joint(guided)
    solution = cd.solve(scene)
    result = results[name] = solution.contact().sorted()
    x, tau, weights = result.x[:, 0] - L / 2, result.shear[:, 0], result.weights
    row = rows[name] = {"force": float(result.force_vector[0]) / FORCE, "imbalance": solution.imbalance}
    row |= {"peel": result.peak_tension, "peak": float(tau.max() * L / FORCE), "iterations": solution.iterations}
    for theory, plates_shear in (("volkersen", False), ("with the plates' shear", True)):
        known = shear_lag(x, GLUE, plates_shear)
        error = np.sqrt(weights @ (tau - known) ** 2 / (weights @ known**2))
        row[theory] = {"error": float(error), "peak": float(known.max() * L / FORCE)}
        peaks = f"{row['peak']:.3f} and {row[theory]['peak']:.3f}"
        print(f"{name:7} {theory:23} error of tau {error:.4f}, peak over mean {peaks}")

# %% [markdown]
# Reading: guided plates differ from Volkersen by five percent, and all but one of
# these is the plates' own shear, which he leaves out. What is left is the plates'
# Poisson effect and what two dimensions do at the ends.
#
# The free outer plate bends, as its force leaves it at its lower face. That takes from
# the shear, most where the pulled plate enters the overlap, and lifts its own end off:
# there the glue is peeled by a tension as large as the shear, which no shear-lag theory
# has. Joints break from there.
#
# ## Thin glue, thick glue
#
# The thicker the layer, the softer: its shear evens out, and the plates' own shear
# matters less. So Volkersen gets right in the limit of soft glue. A sweep over layers
# shares all bodies and factorisations (`scene.with_layer`).

# %%
scene, sweep = joint(guided=True), []
for h in (0.1, 0.2, 0.4, 0.8, 1.6):
    glue = cd.BondedLayer.adhesive(E=2500.0, nu=0.35, thickness=h)
    found = cd.solve(scene.with_layer(glue)).contact()
    known = shear_lag(found.x[:, 0] - L / 2, glue, plates_shear=False)
    error = float(np.sqrt(found.weights @ (found.shear[:, 0] - known) ** 2 / (found.weights @ known**2)))
    sweep.append({"thickness": h, "peak": float(found.shear[:, 0].max() * L / FORCE), "volkersen": error})
    print(f"h = {h:.1f} mm: peak over mean {sweep[-1]['peak']:.2f}, Volkersen off by {error:.4f}")

# %% [markdown]
# And without its shear stiffness the glue still keeps the plates together, but lets
# them slide: nothing holds the outer one, and the solve says so.

# %%
slippery = scene.with_layer(replace(GLUE, shear_stiffness=0.0))
try:
    cd.solve(slippery)
    held = True
except cd.NoEquilibriumError as error:
    held = False
    print("\nwithout the shear stiffness:", error)

# %% [markdown]
# ## Pictures
#
# Left the shear along the overlap, in units of the mean: dots are computed, the grey
# line is Volkersen's, the black one has the plates' shear. Right the peel, the stress
# across the glue: tension at the free plate's own end, pressure beside it.

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.6), layout="constrained")
place = np.linspace(-L / 2, L / 2, 401)
left.plot(place, shear_lag(place, GLUE, False) * L / FORCE, color="0.6", label="Volkersen")
left.plot(place, shear_lag(place, GLUE, True) * L / FORCE, color="k", linewidth=0.9, label="with the plates' shear")
for name, colour in (("guided", "C0"), ("free", "C3")):
    result = results[name]
    left.plot(result.x[:, 0] - L / 2, result.shear[:, 0] * L / FORCE, ".", color=colour, markersize=4, label=name)
right.plot(results["free"].x[:, 0] - L / 2, -results["free"].pressure * L / FORCE, color="C3")
right.axhline(0.0, color="0.6", linewidth=0.8)
left.set(xlabel="x (mm)", ylabel="shear over its mean", ylim=(0, None))
right.set(xlabel="x (mm)", ylabel="peel over the mean shear (free plate)")
left.legend(frameon=False)
figure.savefig(report.path("shear.png"), dpi=150)
solution.plot_bodies(component="xx", zoom=2.5, path=report.path("bodies.png"))
report.summary({"cases": rows, "sweep": sweep, "held without shear": held})

# %% [markdown]
# ## What must hold
#
# The joint carries the load to the residual. Guided plates follow the shear lag with
# the plates' own shear within 1.5 %, Volkersen's within 6 %, and that difference
# shrinks as the glue gets softer. Bending takes a tenth from the shear where the free
# plate is pulled, and the peel at its own end is as large as the shear.

# %%
for row in rows.values():
    assert abs(row["force"] - 1) < 1e-8
    assert row["imbalance"] < 1e-9
assert rows["guided"]["with the plates' shear"]["error"] < 0.015
assert 0.03 < rows["guided"]["volkersen"]["error"] < 0.06
assert all(softer["volkersen"] < stiffer["volkersen"] for stiffer, softer in pairwise(sweep))
assert rows["free"]["peel"] > 0.9 * rows["free"]["peak"] * FORCE / L
assert not held
