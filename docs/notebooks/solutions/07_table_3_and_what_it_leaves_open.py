"""Model solutions of notebook 7, Table 3."""

import numpy as np

from ngdgc.studies.table3 import PUBLISHED


# 7.1  From sigma_zz = lam (tr(eps) + eps_zz) + 2 mu eps_zz = 0.
def answer_1(E, nu):
    return E * nu / (1 - nu**2)


# 7.2  The meshes are halved.
errors = np.array(PUBLISHED["4.2"])
answer_2 = list(np.log2(errors[:-1] / errors[1:]))

# 7.3  The integral of 200 (5 - y) from 0.05 to 1.05 is that of its value in the middle.
answer_3 = 1 / (200 * (5 - 0.55))

# 7.4  A program without friction reproduces the table.
answer_4 = ("b", 1)
