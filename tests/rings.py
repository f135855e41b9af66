"""Bodies of revolution whose solution is known, for tests."""

from ngsolve import CF, cos, exp, x, y

from ngdgc import ContactProblem, Foundation, HookeMaterial, NormalCompliance, TrescaFriction
from ngdgc.exact import ExactStrain

STIFFNESS = 50.0


def Smooth():
    """(problem, displacement): a field with all strains that reaches the axis, its loads, and slip with friction on z = 0."""
    hoop = 0.1 * cos(x) * (1 + y * y / 2)        # u_r/r
    u = CF((x * hoop, -0.3 * y - 0.05 * (1 + y) * cos(1.5 * x) - 0.02 * exp(y)))
    material, plane = HookeMaterial(E=1, nu=0.3), ExactStrain(u)
    stress = material.Stress(CF((plane[0, 0], plane[0, 1], 0, plane[1, 0], plane[1, 1], 0, 0, 0, hoop), dims=(3, 3)))
    bodyforce = CF((-(stress[0, 0].Diff(x) + stress[0, 1].Diff(y) + 2 * material.mu * hoop.Diff(x)),
                    -(stress[1, 0].Diff(x) + stress[1, 1].Diff(y) + stress[1, 0] / x)))
    foundation = Foundation("bottom", NormalCompliance(STIFFNESS), gap=-u[1] + stress[1, 1] / STIFFNESS,
                            friction=TrescaFriction(stress[0, 1]))
    return ContactProblem(material, foundation, dirichlet={"top|right": u}, bodyforce=bodyforce, axisymmetric=True), u
