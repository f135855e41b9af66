"""Model solutions of notebook 5, Uzawa's iteration."""

import numpy as np


# 5.1  u_n = d - c p, r = u_n - g, and the law with its positive part.
def answer_1(p, d, g, k, c):
    return k * np.maximum(d - c * p - g, 0)


# 5.2  q^i <= tol, that is i >= log(tol)/log(q); both logarithms are negative.
def answer_2(q, tol):
    return np.ceil(np.log(tol) / np.log(q))


# 5.3  Divide by the length where that exceeds 1.
def answer_3(multiplier):
    length = np.linalg.norm(multiplier, axis=1, keepdims=True)
    return np.where(length > 1, multiplier / np.maximum(length, 1), multiplier)


# 5.4  The positive part bounds the pressure, and with it everything else.
answer_4 = ("c", 2)
