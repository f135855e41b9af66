"""Model solutions of notebook 6, semismooth Newton and the zones."""

import numpy as np


# 6.1  Contact first, then the size of the friction.
def answer_1(pressure, friction, bound):
    return np.where(pressure > 0, np.where(np.abs(friction) >= bound, 2, 1), 0)


# 6.2  The power differentiated where there is contact.
def answer_2(r, k, m):
    depth = np.maximum(r, 0)
    return np.where(r > 0, k * m * depth ** (m - 1), 0)


# 6.3  F and its generalised derivative.
def answer_3(r, g, d, c, k, m):
    F = r + g + c * k * np.maximum(r, 0) ** m - d
    return r - F / (1 + c * answer_2(r, k, m))


# 6.4  On the right set of closed points the equation is linear, and Newton's method solves linear equations in one step.
answer_4 = ("c", 2)
