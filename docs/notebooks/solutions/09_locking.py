"""Model solutions of notebook 9, locking."""

from ngdgc import Conforming
from ngdgc.studies import locking


# 9.1  lam = 2 mu nu/(1 - 2 nu), mu = E/(2 (1 + nu)).
def answer_1(E, nu):
    return E * nu / ((1 + nu) * (1 - 2 * nu))


# 9.2  Unknowns: 2 n^2, 12 n^2, 2 (2 n)^2; conditions: 2 n^2 triangles with 1, 1 and 3 coefficients of the divergence.
answer_2 = [2 / 2, 12 / 2, 8 / 6]

# 9.3  The error at lam = 1e4 by that at lam = 1.
answer_3 = locking.Study(Conforming(), order=2, n=4, lam=(1, 1e4)).factor

# 9.4  The discrete problem is solved well; it is the wrong problem.
answer_4 = ("b", 2)
