"""Mistakes with estimates of errors, as in `mistakes`."""

from unittest.mock import patch

from bodies import Pyramids, Ring
from mistakes import Disc, Giving, Jointed
from ngsolve import BilinearForm, GridFunction, VectorH1, dx
from problems import Example

from ngdgc import (LDG, Conforming, ContactProblem, Discretization, EstimateError, EstimateForce, Foundation, HookeMaterial,
                   NormalCompliance, Solve, SolveAdaptive, SolveDivided)
from ngdgc.estimates import measures
from ngdgc.estimates.residual import ResidualEstimate
from ngdgc.exact import AffinePatch
from ngdgc.meshes import BoxMesh, RectangleMesh


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


def Adapted(mesh=None, *, problem=None, tol=0.3, **options):
    return SolveAdaptive(problem or Example(), LDG(), mesh or RectangleMesh(2), tol=tol, **options)


class Ended:
    """A callback that stops a run when its first mesh is done, or on its second."""

    def __init__(self, within):
        self.within, self.meshes = within, 0

    def __call__(self, step):
        if self.within and self.meshes:
            raise KeyboardInterrupt

    def Reached(self, level):
        self.meshes += 1
        if not self.within:
            raise KeyboardInterrupt


def Unestimated():
    """Ctrl-C while the error on the first mesh is estimated."""
    with patch.object(measures, "EstimateError", side_effect=KeyboardInterrupt):
        Adapted()


def Deformed():
    mesh = RectangleMesh(2)
    mesh.SetDeformation(GridFunction(VectorH1(mesh)))
    return mesh


def SecondOrder():
    mesh = RectangleMesh(2)
    mesh.ngmesh.SecondOrder()
    return type(mesh)(mesh.ngmesh)


RING = ContactProblem(HookeMaterial(E=1, nu=0.3), Foundation("inner", NormalCompliance(1)), dirichlet={"outer": (0, 0.1)})


ESTIMATES = [
    (lambda _: EstimateError(Disc()), "solution is Discretization( | a ContactSolution | which Solve(disc) returns"),
    (lambda _: EstimateError(_Unconverged()), "the solution has not converged | in equilibrium | give one that has"),
    (lambda _: EstimateError(Solve(Disc(Conforming()))),
     "method H1 has no numerical flux | balances | take a discontinuous one"),
    (lambda _: EstimateError(Solve(Disc(Giving()))), "method IP has a form of its own | FacetForm | as all methods"),
    (lambda _: EstimateError(_Pyramids()), "the mesh has pyramids | no equilibrated stress | take another mesh"),
    (lambda _: EstimateError(Solve(Disc(spring={"top": 3}))), "the problem has springs | the energy norm | take EstimateForce"),
    (lambda _: EstimateError(Solve(Jointed())), "joint 'interface' | against foundations alone | compare with a finer mesh"),
    (lambda _: ResidualEstimate(Solve(Disc(spring={"top": 3}))), "problem has springs | the energy norm | take EstimateForce"),
    (lambda _: EstimateError(Sprung()), "forms were added | the numerical flux | without them"),
    (lambda _: EstimateForce(Disc()), "solution is Discretization( | a ContactSolution | which Solve(disc) returns"),
    (lambda _: EstimateForce(_Unconverged()), "the solution has not converged | of its iteration | give one that has"),
    (lambda _: EstimateForce(Solve(Disc(n=1, order=8))), "the solution is of order 8 | the highest one | take order 7"),
    (lambda _: EstimateForce(Sprung()), "forms were added | the next order | without them"),
    (lambda _: EstimateForce(Solve(Disc()), "energy"), "goal is 'energy' | 'force', ('pressure', region) | give"),
    (lambda _: EstimateForce(Solve(Disc()), ("pressure", "top")),
     "goal is ('pressure', 'top') | no foundation of this region | give one"),
    (lambda _: EstimateForce(Solve(Disc()), ("displacement", (9, 9))),
     "point (9.0, 9.0) lies in no element | from (0.0, 0.0) to (1.0, 1.0) | give a point of"),
    (lambda _: SolveDivided(Solve(Disc(Conforming()))), "the solution is of H1 | contact points are nodes | take a discontin"),
    (lambda _: SolveDivided(_Unconverged()), "the solution has not converged | its zones end elsewhere | give one that has"),
    (lambda _: ResidualEstimate(Disc()), "solution is Discretization(IP | a ContactSolution, which Solve(disc) returns | give"),
    (lambda _: ResidualEstimate(Sprung()), "the solution has added forms | could be compared | estimate errors without them"),
    # Adaptive runs.
    (lambda _: Adapted(tol=2), "tol is 2 | the relative error that is wanted | a number between 0 and 1"),
    (lambda _: Adapted(most=0), "most is 0 | the largest number of unknowns | give"),
    (lambda _: Adapted(goal="forces"), "goal is 'forces' | 'energy', 'force', ('pressure', region) | choose"),
    (lambda _: Adapted(callback=3), "callback is 3 | a function of a Step | give"),
    (lambda _: Adapted(BoxMesh(1, cells="prism"), problem=AffinePatch("slip", dim=3).problem),
     "the mesh has prisms | Netgen does not bisect in all directions | take tetrahedra"),
    (lambda _: Adapted(Deformed()), "the mesh has a deformation | a refined mesh has not | make a mesh of the deformed body"),
    (lambda _: Adapted(SecondOrder()), "the mesh has elements of second order | not refined | take one of first order"),
    (lambda _: Adapted(Ring(2, 0.5), problem=RING), "the SplineGeometry of the mesh is gone | would be curved | keep it"),
    (lambda _: Adapted(tol=0.01, most=100), "tol=0.01 was not reached | more than most=100 | give a larger most"),
    (lambda _: Adapted(RectangleMesh(1), problem=AffinePatch("slip").problem, tol=1e-15),
     "tol=1e-15 was not reached | round-off | give a larger tol"),
    (lambda _: Adapted(problem=Example(dirichlet={"right": (0, 0), "top": (0, -0.1)}), tol=1e-3),
     "tol=0.001 was not reached | the displacements of 'right' and 'top' differ by 0.1 at | let them agree there"),
    (lambda _: Adapted(tol=0.01, callback=Ended(False)), "interrupted | after | the last iterate is its attribute solution"),
    (lambda _: Adapted(tol=0.01, callback=Ended(True)), "interrupted | after | the last iterate is its attribute solution"),
    (lambda _: Unestimated(), "interrupted | after | the last iterate is its attribute solution")]
