"""div sigma_h in the elements, by way of polynomials: NGSolve's own second derivatives take four times as long."""

from __future__ import annotations

from typing import Any

from ngsolve import CF, TET, TRIG, CoefficientFunction, Grad, GridFunction, L2, Sym, VectorValued, x

from ..discrete.problem import DiscreteProblem
from ..mesh.facets import Curved, Projected
from ..problem.frames import CYLINDRICAL

SMOOTH = 2      # degrees beyond k of the polynomials that a stress which is none is taken for


def Divergence(disc: DiscreteProblem, u: GridFunction) -> CoefficientFunction:
    """div C eps(u), (d,) [stress/length], of a displacement in V_h.

    Of a body of revolution the stress in the plane is P + T u_r/r, P and T polynomials: with q = u_r/r

        div_i = d_j P_ij + (d_j T_ij) q + T_ij d_j q + (sigma_ir - delta_ir sigma_tt)/r,      r grad q = grad u_r - (q, 0)
    """
    frame, material = disc.problem.frame, disc.problem.material
    inside = _Rows(_Polynomial(disc, frame.InPlane(material).Stress(Sym(Grad(u)))))
    if not frame.revolved:
        return inside
    hoop, _ = CYLINDRICAL.Around(material)
    q, slope = u[0] / x, Grad(u)
    change = CF(((slope[0, 0] - q) / x, slope[0, 1] / x))
    if material.bonus:
        inside += _Rows(_Polynomial(disc, hoop)) * q
    stress = material.Stress(frame.Strain(u))
    return inside + hoop * change + CF(((stress[0, 0] - stress[2, 2]) / x, stress[1, 0] / x))


def _Polynomial(disc: DiscreteProblem, stress: CoefficientFunction) -> GridFunction:
    """A tensor (d, d) in the elements, as a function (d d,) that has derivatives."""
    mesh, dim, order = disc.mesh, disc.mesh.dim, disc.order
    exact = disc.problem.material.bonus == 0 and not Curved(mesh) and all(
        element.type in (TRIG, TET) for element in mesh.Elements())
    space = VectorValued(L2(mesh, order=order - 1 if exact else order + SMOOTH), dim * dim)
    function = GridFunction(space)
    function.vec.FV().NumPy()[:] = Projected(space, stress)
    return function


def _Rows(tensor: GridFunction) -> Any:
    """The divergences of the rows, (d,)."""
    dim = tensor.space.mesh.dim
    slopes = Grad(tensor)
    return CF(tuple(sum(slopes[dim * i + j, j] for j in range(dim)) for i in range(dim)))
