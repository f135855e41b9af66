"""Model solutions of notebook 2, H1 against DG."""

import numpy as np


# 2.1  2 n^2 triangles, (k+1)(k+2)/2 polynomials, 2 components; nothing is shared.
def answer_1(n, k):
    return 2 * n**2 * (k + 1) * (k + 2)


# 2.2  Continuous functions are given by their values on a lattice of n k + 1 points in each direction.
def answer_2(n, k):
    return 2 * (n * k + 1) ** 2


# 2.3  From e = c h^p: p = log(e_1/e_2)/log(h_1/h_2).
def answer_3(errors, sizes):
    return np.diff(np.log(errors)) / np.diff(np.log(sizes))


# 2.4  The space of H1 contains translations and rotations of the body (clamped parts give reactions), not of an element.
answer_4 = ("b", 1)
