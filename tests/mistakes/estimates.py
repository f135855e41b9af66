"""Mistakes with estimates of errors, as in `mistakes`."""

from bodies import Pyramids
from mistakes import Disc
from ngsolve import BilinearForm, dx

from ngdgc import (LDG, Conforming, ContactProblem, Discretization, EstimateError, Foundation, HookeMaterial, InteriorPenalty,
                   NormalCompliance, Solve)
from ngdgc.estimates.residual import ResidualEstimate


class Symbolic(InteriorPenalty):
    """A method of a user's own, whose form has no blocks on facets."""

    def Form(self, problem, facets, space, order, assembly):
        return super().Form(problem, facets, space, order, "skeleton")


def _Unconverged():
    solution = Solve(Disc())
    solution.converged = False
    return solution


def Sprung():
    """A body with springs that were added as a form."""
    disc = Disc()
    u, v = disc.space.TnT()
    return Solve(disc.Add(BilinearForm(10 * u * v * dx)))


def _Pyramids():
    mesh = Pyramids()
    mesh.ngmesh.SetBCName(0, "bottom")
    for number in range(1, len(mesh.GetBoundaries())):
        mesh.ngmesh.SetBCName(number, "top")
    problem = ContactProblem(HookeMaterial(E=1, nu=0.3), Foundation("bottom", NormalCompliance(1)),
                             dirichlet={"top": (0, 0, -0.1)})
    return Solve(Discretization(problem, LDG(), mesh))


ESTIMATES = [
    (lambda _: EstimateError(Disc()), "solution is Discretization( | a ContactSolution | which Solve(disc) returns"),
    (lambda _: EstimateError(_Unconverged()), "the solution has not converged | in equilibrium | give one that has"),
    (lambda _: EstimateError(Solve(Disc(Conforming()))),
     "method H1 has no numerical flux | balances | take a discontinuous one"),
    (lambda _: EstimateError(Solve(Disc(Symbolic()))), "method IP has a form of its own | FacetForm | as all methods"),
    (lambda _: EstimateError(_Pyramids()), "the mesh has pyramids | no equilibrated stress | take another mesh"),
    (lambda _: EstimateError(Sprung()), "forms were added | the numerical flux | without them"),
    (lambda _: ResidualEstimate(Disc()), "solution is Discretization(IP | a ContactSolution, which Solve(disc) returns | give"),
    (lambda _: ResidualEstimate(Sprung()), "the solution has added forms | could be compared | estimate errors without them")]
