"""Model solutions of notebook 8, from normal compliance to Signorini."""

import numpy as np


# 8.1  As it stands.
def answer_1(r, p, gamma):
    return p - np.maximum(p + gamma * r, 0)


# 8.2  log e = log c - alpha log k.
def answer_2(errors, stiffnesses):
    return np.log(errors[:-1] / errors[1:]) / np.log(stiffnesses[1:] / stiffnesses[:-1])


# 8.3  q = p + gamma p/k in contact; q <= 0 without.
def answer_3(q, k, gamma):
    return np.maximum(q, 0) / (1 + gamma / k)


# 8.4  O(h) + O(1/k).
answer_4 = ("a", 1)


# 8.5  Each point stands for a ring, 2 pi r long.
def answer_5(p, r, weights):
    return 2 * np.pi * np.sum(weights * r * p)
