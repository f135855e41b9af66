"""Model solutions of notebook 3, the four fluxes by hand: the notebook's matrices, and what the exercises ask for."""

import numpy as np
import scipy.sparse as sp
from ngsolve import (CF, L2, BilinearForm, FacetFESpace, Grad, GridFunction, Id, InnerProduct, MatrixValued, Sym, Trace,
                     VectorL2, ds, dx, specialcf)

from ngdgc import ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty, Lifting, NormalCompliance
from ngdgc.meshes import RectangleMesh

mesh, n = RectangleMesh(2), specialcf.normal(2)
material = HookeMaterial(E=2000, nu=0.3)
mu, lam = material.mu, material.lam
V = VectorL2(mesh, order=1, dgjumps=True)
Q = MatrixValued(L2(mesh, order=1, dgjumps=True), symmetric=True)
(u, v), (s, q) = V.TnT(), Q.TnT()
inner, clamped = dx(skeleton=True), ds(skeleton=True, definedon=mesh.Boundaries("top"))


def C(strain):
    return 2 * mu * strain + lam * Trace(strain) * Id(2)


def Stress(u):
    return C(Sym(Grad(u)))


def Jump(u):
    return u - u.Other()


def Matrix(space, *terms):
    form = BilinearForm(space)
    for term in terms:
        form += term
    form.Assemble()
    return sp.csr_matrix(form.mat.CSR(), shape=(space.ndof, space.ndof), copy=True)


h = GridFunction(FacetFESpace(mesh, order=0))
for edge in mesh.edges:
    start, end = (np.array(mesh[vertex].point) for vertex in edge.vertices)
    h.vec[h.space.GetDofNrs(edge)[0]] = np.linalg.norm(end - start)

eta = 30 * mu
K = Matrix(V, InnerProduct(Stress(u), Sym(Grad(v))) * dx)
X = Matrix(V, -(0.5 * (Stress(u) + Stress(u.Other())) * n * Jump(v)) * inner, -(Stress(u) * n * v) * clamped)


def Double(w, z):
    return 0.5 * (w * z + (w * n) * (z * n))


alpha = Matrix(V, eta / h * Double(Jump(u), Jump(v)) * inner, eta / h * Double(u, v) * clamped)

# 3.1  X has -<[v],{C eps(u)}>, its transpose -<[u],{C eps(v)}>, which NIPG takes with the other sign.
answer_1 = K + X - X.T + alpha

# 3.2  The product of the vectors, on interior facets and on Gamma_D.
answer_2 = Matrix(V, eta / h * (Jump(u) * Jump(v)) * inner, eta / h * (u * v) * clamped)


# 3.3  [u] n = (w (n.n) + n (w.n))/2.
def answer_3(mean, w, n, ratio):
    return mean - ratio[:, None] * (w + np.sum(w * n, axis=1)[:, None] * n) / 2


# 3.4  r_0 is the sum of all r_e; the matrices of both come from the library here.
problem = ContactProblem(material, Foundation("bottom", NormalCompliance(300)), dirichlet={"top": CF((0, -0.1))})
lifting = Lifting(Discretization(problem, InteriorPenalty(), mesh, order=1))
MC = Matrix(Q, InnerProduct(C(s), q) * dx)
local = [lifting.Matrix(facet) for facet in range(mesh.nedge)]
r0 = sum(local)
answer_4 = K + X + X.T + r0.T @ MC @ r0 + 2 * sum(r.T @ MC @ r for r in local)
