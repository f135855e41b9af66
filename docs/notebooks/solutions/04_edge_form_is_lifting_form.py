"""Model solutions of notebook 4, edge form and lifting form."""

import numpy as np
import scipy.sparse as sp
from ngsolve import CF

from ngdgc import BassiEtAl, ContactProblem, Discretization, Foundation, HookeMaterial, NormalCompliance
from ngdgc.meshes import RectangleMesh


# 4.1  For constant q: area r:q = -length jump:q/2.
def answer_1(jump, length, area):
    return -jump * length[:, None, None] / (2 * area[:, None, None])


# 4.2  The strain has the degree k - 1 on triangles; on parallelograms a derivative keeps the degree in the other variable.
answer_2 = [2, 3]

# 4.3  Bisection: the smallest eigenvalue grows with eta.
problem = ContactProblem(HookeMaterial(E=2000, nu=0.3), Foundation("bottom", NormalCompliance(300)),
                         dirichlet={"top": CF((0, 0))})
mesh = RectangleMesh(4)


def Smallest(eta):
    matrix = Discretization(problem, BassiEtAl(penalty=eta), mesh, order=1).form.Matrix()
    return np.linalg.eigvalsh(sp.csr_matrix(matrix.CSR(), shape=(matrix.height, matrix.width), copy=True).toarray())[0]


low, high = 0.1, 3.0
while high - low > 0.002:
    middle = (low + high) / 2
    low, high = (low, middle) if Smallest(middle) > 0 else (middle, high)
answer_3 = high

# 4.4  With constants r_e sees the mean of a jump only.
answer_4 = ("b", 1)
