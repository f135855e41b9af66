"""Model solutions of notebook 1, the Winkler column."""

from ngdgc import HookeMaterial

# 1.1  The pad crosses the gap, penetrates the soil by P/k, and is compressed by P H/(lam + 2 mu) because it cannot bulge.
pad = HookeMaterial(E=5, nu=0.45)
modulus = pad.lam + 2 * pad.mu
answer_1 = 0.5 + 0.3 / 0.2 + 0.3 * 40 / modulus


# 1.2  The law turned around.  Without a load the column just touches: u_n = g, although any u_n <= g would do.
def answer_2(P, k, m, g):
    return g + (P / k) ** (1 / m)


# 1.3  P/k = P H/(lam + 2 mu): the pad is a spring of the stiffness (lam + 2 mu)/H.
answer_3 = modulus / 40

# 1.4  Equilibrium alone fixes the pressure, and with it the penetration.
answer_4 = ("b", 2)
