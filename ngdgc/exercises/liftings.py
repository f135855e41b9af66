"""Exercises of notebook 4, edge form and lifting form."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from ngsolve import CF

from ..contracts import Array
from ..discretization import Discretization
from ..mesh.facets import Csr
from ..meshes import RectangleMesh
from ..methods.rows import BassiEtAl
from ..problem.foundation import Foundation
from ..problem.laws import NormalCompliance
from ..problem.materials import HookeMaterial
from ..problem.problem import ContactProblem
from .checker import Choice, Function, Value

FACETS = 3      # of a triangle


def Jumps(rng: np.random.Generator) -> tuple[Any, ...]:
    jump = rng.standard_normal((12, 2, 2))
    return jump + np.swapaxes(jump, 1, 2), rng.uniform(0.1, 0.5, 12), rng.uniform(0.02, 0.2, 12)


def Lift(jump: Array, length: Array, area: Array, *, factor: float = -0.5) -> Array:
    return factor * jump * (length / area)[:, None, None]


@cache
def Threshold(*, n: int = 4, penalties: tuple[float, float] = (1.0, 2.0)) -> float:
    """eta from which on Bassi et al. is coercive: A_0 + eta beta >= 0, with A_0 and beta from two penalties.

    On functions without a lifting A_0 is the strain energy and, Gamma_D being clamped, positive; so the pencil
    beta x = s (A_0 + c beta) x with a coercive right side has s < 1/(c - eta) exactly for the coercive eta.
    """
    import scipy.linalg as la       # slow to import

    problem = ContactProblem(HookeMaterial(E=2000, nu=0.3), Foundation("bottom", NormalCompliance(300)),
                             dirichlet={"top": CF((0, 0))})
    mesh, (low, high) = RectangleMesh(n), penalties
    one, two = (Csr(Discretization(problem, BassiEtAl(penalty=eta), mesh, order=1).form.Matrix()).toarray()
                for eta in penalties)
    beta = (two - one) / (high - low)
    safe = two + (2 * FACETS - high) * beta
    return 2 * FACETS - 1 / la.eigvalsh(beta, safe)[-1]


EXERCISES = {
    "04.1": Function(
        Right=Lift, Data=Jumps, hint="Put the constant matrices q into the definition of r_e, with {q} on the right-hand side.",
        insight="Half the jump of the facet, spread over the element: as 1/h the larger, the smaller that is.",
        mistakes={
            "Wrong sign: look at the minus in the definition.": lambda *data: Lift(*data, factor=0.5),
            "On an interior facet {q} has a half: the other half goes to the neighbour.": lambda *data: Lift(*data, factor=-1),
            "The integral over the element gives its area, that over the facet its length; solve for r_e.":
                lambda jump, length, area: Lift(jump, area, length),
            "Is the length of the facet missing?": lambda jump, length, area: Lift(jump, np.ones_like(area), area)}),
    "04.2": Value(
        Right=lambda: [2, 3], tol=1e-6, hint="Of which degree is the strain of a function of degree 3, in each variable?",
        insight="k - 1 on simplices, k on parallelograms, where a derivative keeps the degree in the other variable.",
        mistakes={
            "l = k suffices for triangles, but less does, too.": lambda: [3, 3],
            "On a parallelogram d/dx of x^3 y^3 still has y^3.": lambda: [2, 2],
            "Triangles and parallelograms are interchanged.": lambda: [3, 2],
            "C eps(u) has the degree of a derivative of u; you went one too far.": lambda: [1, 2],
            "That suffices, but it is not the smallest.": lambda: [3, 4]}),
    "04.3": Value(
        Right=Threshold, tol=0.02,
        hint="Where does the smallest eigenvalue of Matrix(BassiEtAl(penalty=eta), mesh) become positive?",
        insight="Less than the number of facets, 3, which is what the theory can promise for every mesh of triangles.",
        mistakes={
            "That is the bound of the theory, the number of facets of a triangle; here less is enough.": lambda: FACETS,
            "That is the inverse of the number.": lambda: 1 / Threshold(),
            "On which mesh?  The notebook's has 4 x 4 squares.": lambda: Threshold(n=2)}),
    "04.4": Choice(
        right=("b", 1), choices={"a": "Look at the number of zero eigenvalues for eta = 10 000.",
                                 "c": "Look at the eigenvalues for l = 0 again; k was 1 there."},
        reasons={2: "That would cost accuracy; singular is a question of what the form cannot see.",
                 3: "For k = 1 and l = 0 on triangles the two forms agree."},
        insight="What r_e does not see no factor can make visible: turned triangles are free of charge.")}
