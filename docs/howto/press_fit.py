# %% [markdown]
# # A press fit with a coated shaft
#
# A hub is shrunk on a hollow shaft that is too large by $\delta$ (of the radius). What is the pressure in the joint,
# and how much of it does a soft coating on the shaft, of thickness $h$, take away?
#
# The interference is a negative gap, the coating an elastic foundation $p = M c/h$ with
# $M = E_c(1-\nu_c)/((1+\nu_c)(1-2\nu_c))$: it is bonded, thin, and cannot bulge sideways. Lamé's rings (free ends,
# plane stress) with inner, common and outer radius $i, c, o$ give
#
# $$ \frac{\delta}{p} = \frac{c}{E} \left[ \frac{o^2 + c^2}{o^2 - c^2} + \frac{c^2 + i^2}{c^2 - i^2} \right]
#   + \frac{h}{M} . $$

# %%
import contactdd as cd

i, c, o, length, delta = 10.0, 20.0, 30.0, 10.0, 0.01  # mm
steel = cd.Isotropic(E=2.1e5, nu=0.3)  # MPa
thicknesses = [0.02, 0.05, 0.1, 0.2]  # mm
coatings = [cd.LinearLayer.elastic_foundation(E=3e3, nu=0.35, thickness=h) for h in thicknesses]


def ring(name, inner, outer, rows):
    """A ring whose lower end is a plane of symmetry, and whose upper one is free."""
    mesh = cd.rectangle((inner, 0), (outer, length), (10, rows), shape="quadrilateral")
    return cd.Body(name, mesh, steel, supports=[cd.Symmetry("bottom")], degree=2, kinematics="axisymmetric")


shaft, hub = ring("shaft", i, c, 10), ring("hub", c, o, 14)  # their meshes need not match
contact = cd.Contact((shaft, "right"), (hub, "left"), coatings[0], gap=-delta, name="fit")
scene = cd.Scene([shaft, hub], [contact])
rings = c / steel.E * ((o**2 + c**2) / (o**2 - c**2) + (c**2 + i**2) / (c**2 - i**2))

# %% [markdown]
# `scene.with_layer` shares all but the layer: nothing is assembled or factored again.

# %%
for h, coating in zip(thicknesses, coatings, strict=True):
    solution = cd.solve(scene.with_layer(coating))
    fit, lame = solution.contact("fit"), delta / (rings + 1 / coating.stiffness)
    print(f"h = {h:4.2f} mm: p = {fit.mean_pressure:6.2f} MPa (Lamé {lame:6.2f}), force {fit.force:8.0f} N")
    assert abs(fit.mean_pressure / lame - 1) < 1e-3  # the meshes' error at degree 2

# %% [markdown]
# The radial stress, continuous across the joint; swept through three quarters of a turn:

# %%
solution.plot_bodies(component="xx", sweep=270, unit="MPa", path="rings.png")
