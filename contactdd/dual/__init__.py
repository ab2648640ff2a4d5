"""How far is the energy from its least value? Stresses and pressures in equilibrium, and the dual energy."""
