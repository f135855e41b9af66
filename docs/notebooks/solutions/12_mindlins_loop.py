"""Model solutions of notebook 12, Mindlin's loop."""

import numpy as np


# 12.1  Cattaneo and Mindlin: full slip minus the same in a smaller contact, whose half width is c.
def answer_1(Q, P, mu):
    return np.sqrt(1 - Q / (mu * P))


# 12.2  Masing: on the way back friction changes by twice the bound, so all is as on the first way, twice as large.
def answer_2(s, largest, limit, slide):
    def First(way):
        return limit * (1 - (1 - way / slide) ** 1.5)
    return First(largest) - 2 * First((largest - s) / 2)


# 12.3  Friction at the end of an increment, against the slip in it.
def answer_3(sigma, u, weights):
    return -np.sum(weights * sigma[1:] * (u[1:] - u[:-1]))


# 12.4  The edges have slipped back and pull the other way; the middle, still sheared, does not outweigh them.
answer_4 = ("b", 2)
