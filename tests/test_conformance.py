"""Our own classes keep their contracts, and a class that does not is told which member is missing or wrong."""

from types import SimpleNamespace

import numpy as np
import pytest
from broken import Disc, Refused, Wrong
from ngsolve import H1, VOL

from ngdgc import (LDG, Conforming, CoulombFriction, NestedNewtonSolver, NormalCompliance, PowerFriction,
                   SemismoothNewtonSolver, SlipWeakeningFriction, TrescaFriction, UzawaSolver)
from ngdgc.conformance import (CheckInverse, CheckLaw, CheckLinearProblem, CheckPreconditioner, CheckSolver,
                               CheckSpaceNumbering)
from ngdgc.linear.choice import INVERTERS, HasPardiso
from ngdgc.linear.factorisations import Operator
from ngdgc.linear.multigrid import VCycle
from ngdgc.mesh.facets import Csr, Native
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.solvers.newton.subspace import Subspace


@pytest.mark.parametrize("name", INVERTERS)
def test_inverses(name):
    if name == "pardisospd" and not HasPardiso():
        name = "sparsecholesky"
    CheckInverse(INVERTERS[name], Disc(mesh=BoxMesh(2)))
    if name != "iterative":
        CheckInverse(INVERTERS[name], Disc(Conforming()))


def Cholesky(matrix, free, disc):
    return Operator(matrix.Inverse(free, inverse="sparsecholesky"), disc.mesh)


def Changed(Change, **members):
    """Cholesky's inverse with something changed."""
    def Own(matrix, free, disc):
        inverse = Cholesky(matrix, free, disc)
        return SimpleNamespace(Solve=lambda load, **options: Change(inverse, load), **members)
    return Own


class Shared:
    """Keeps what belongs to one matrix in the class."""

    def __init__(self, matrix, free, disc):
        Shared.inverse = Cholesky(matrix, free, disc)

    def Solve(self, load):
        return self.inverse.Solve(load)


def InPlace(inverse, load):
    load[:] = inverse.Solve(load)
    return load


def test_inverses_that_are_none():
    disc, turn = Disc(), np.linspace(0, 0.1, 48)
    CheckInverse(Changed(lambda inverse, load: inverse.Solve(load)), disc)
    # One array for all solutions is no mistake.
    kept = np.zeros(disc.space.ndof)
    CheckInverse(Changed(lambda inverse, load: np.copyto(kept, inverse.Solve(load)) or kept), disc)
    Refused("Solve raises ZeroDivisionError", CheckInverse, Changed(lambda inverse, load: 1 / 0), disc)
    Refused("inverse=<lambda> raises ZeroDivisionError", CheckInverse, lambda *made: 1 / 0, disc)
    Refused("inverse 'splu' cannot be called", CheckInverse, "splu", disc)
    Refused("inverse=<lambda> makes 3, which has no Solve", CheckInverse, lambda *made: 3, disc)
    Refused("inverse=Own is not symmetric", CheckInverse, Changed(lambda inverse, load: (1 + turn) * inverse.Solve(load)), disc)
    Refused(r"\|A x - b\|", CheckInverse, Changed(lambda inverse, load: 1.01 * inverse.Solve(load)), disc)
    Refused("not finite", CheckInverse, Changed(lambda inverse, load: np.nan * load), disc)
    Refused("returns shape", CheckInverse, Changed(lambda inverse, load: load[:3]), disc)
    Refused("changes the load", CheckInverse, Changed(InPlace), disc)
    Refused(r"\|A x - b\|", CheckInverse, Shared, disc)
    lazy = Changed(lambda inverse, load: inverse.Solve(load), iterations=0)
    lazy.iterates = True
    Refused("takes 0 steps to 1e-2 and 0 to 1e-8", CheckInverse, lazy, disc)


def GaussSeidel(matrix, free, disc, *, back=True, sign=1.0):
    smoother = matrix.CreateSmoother(free)
    def Mult(b, x):
        x[:] = 0
        smoother.Smooth(x, b)
        if back:
            smoother.SmoothBack(x, b)
        x.data = sign * x
    return SimpleNamespace(Mult=Mult)


def test_preconditioners():
    disc = Disc(mesh=BoxMesh(2))
    CheckPreconditioner(VCycle, disc)
    CheckPreconditioner(GaussSeidel, disc)
    Refused("'ilu' cannot be called", CheckPreconditioner, "ilu", disc)
    Refused("has no Mult", CheckPreconditioner, lambda *made: None, disc)
    Refused("is not symmetric", CheckPreconditioner, lambda *made: GaussSeidel(*made, back=False), disc)
    Refused("is not positive definite", CheckPreconditioner, lambda *made: GaussSeidel(*made, sign=-1.0), disc)

    def Squares(matrix, free, disc):
        return SimpleNamespace(Mult=lambda b, x: x.FV().NumPy().__setitem__(slice(None), b.FV().NumPy() ** 2))

    def Overwrites(matrix, free, disc):
        return SimpleNamespace(Mult=lambda b, x: b.FV().NumPy().__setitem__(slice(None), 0))
    Refused("is not linear", CheckPreconditioner, Squares, disc)
    Refused("changes b", CheckPreconditioner, Overwrites, disc)


def test_linear_problems():
    disc = Disc(mesh=BoxMesh(2))
    for problem in (disc, Subspace(disc), Disc(Conforming()), Disc(held=False)):
        CheckLinearProblem(problem)
    Refused("linear problem SimpleNamespace has no .*ApplyInverse.*contact", CheckLinearProblem, SimpleNamespace(load=0))
    Refused("the load of Wrong has shape", CheckLinearProblem, Wrong(disc, load=disc.load[:3]))
    Refused("the motions of Wrong have shape", CheckLinearProblem, Wrong(disc, motions=np.zeros((2, 3))))
    Refused("Wrong.Multiply is not the matrix", CheckLinearProblem, Wrong(disc, Multiply=lambda x: 2 * disc.Multiply(x)))
    contact = SimpleNamespace(normals=disc.contact.normals, weights=2 * disc.contact.weights, Load=disc.contact.Load,
                              Displacement=disc.contact.Displacement)
    Refused("contact.Load of Wrong is not the adjoint", CheckLinearProblem, Wrong(disc, contact=contact))
    Refused("Wrong counts 0 applications of two", CheckLinearProblem, Wrong(disc, solves=3))
    other = disc.Factorise(Native(2 * Csr(disc.matrix)))
    Refused("Wrong.inverse is not that of its matrix", CheckLinearProblem, Wrong(disc, inverse=other))


def test_spaces():
    for mesh in (RectangleMesh(2), RectangleMesh(2, cells="quad"), BoxMesh(1)):
        for method in (LDG(), Conforming()):
            for order in (1, 3):
                CheckSpaceNumbering(method.Space(mesh, order, "top"), method.ScalarSpace(mesh, order))
    mesh = RectangleMesh(2)
    space = Conforming().Space(mesh, 1, "top")
    Refused("the space has 18 dofs, its component 25", CheckSpaceNumbering, space, H1(mesh, order=2))
    # The two components of a dof side by side, as other codes have them.
    scalar = H1(mesh, order=1)
    turned = SimpleNamespace(mesh=mesh, ndof=18, GetDofNrs=lambda element: [
        2 * dof + i for i in range(2) for dof in scalar.GetDofNrs(element)])
    Refused("element 0 has the dofs .* is expected", CheckSpaceNumbering, turned, scalar)
    assert len(list(mesh.Elements(VOL))) == 8


def test_laws():
    for compliance in (NormalCompliance(100), NormalCompliance(100, exponent=0.5)):
        for friction in (None, TrescaFriction(1), CoulombFriction(0.3), PowerFriction(1, 0.5),
                         SlipWeakeningFriction(0.4, 0.2, 1)):
            CheckLaw(compliance, friction)
    assert CheckLaw(NormalCompliance(100)).valid and not CheckLaw(NormalCompliance(100, exponent=0.5)).valid
    Refused("compliance law SimpleNamespace has no PressureDerivative", CheckLaw, SimpleNamespace(Pressure=np.abs))
    Refused("friction law SimpleNamespace has no Bound", CheckLaw, NormalCompliance(1), SimpleNamespace())

    class Doubled(NormalCompliance):
        def PressureDerivative(self, r):
            return 2 * super().PressureDerivative(r)

    Refused("PressureDerivative differs from the finite difference", CheckLaw, Doubled(100))


@pytest.mark.parametrize("solver", [NestedNewtonSolver(), SemismoothNewtonSolver(), UzawaSolver(),
                                    UzawaSolver(normal="implicit", acceleration="anderson")], ids=repr)
def test_solvers(solver):
    CheckSolver(solver, Disc())


def test_solvers_that_are_none():
    disc, newton = Disc(), SemismoothNewtonSolver()

    def Solver(Change, callback=True):
        def Solve(disc, *, callback=None):
            return Change(newton.Solve(disc, callback=callback if told else None))
        told = callback
        return SimpleNamespace(Solve=Solve)

    CheckSolver(Solver(lambda solution: solution), disc)
    Refused("solver SimpleNamespace has no Solve", CheckSolver, SimpleNamespace(), disc)
    Refused("raises TypeError .*callback", CheckSolver, SimpleNamespace(Solve=lambda disc: None), disc)
    Refused("returns None; return a ContactSolution", CheckSolver, Solver(lambda solution: None), disc)
    Refused("says it is not converged", CheckSolver, Solver(lambda solution: Changing(solution, converged=False)), disc)
    Refused("not on the law", CheckSolver, Solver(lambda solution: Changing(solution, traction=1.1 * solution.traction)), disc)
    Refused("not in balance", CheckSolver, Solver(lambda solution: Changing(solution, vector=Inside(solution))), disc)
    Refused("calls callback 0 times", CheckSolver, Solver(lambda solution: solution, callback=False), disc)


def Changing(solution, **changes):
    values = {name: changes.get(name, getattr(solution, name)) for name in ("vector", "traction", "converged")}
    return type(solution)(solution.disc, values["vector"], values["traction"], history=solution.history,
                          converged=values["converged"])


def Inside(solution):
    """Coefficients that differ where Gamma_C does not see it."""
    vector, disc = solution.vector.copy(), solution.disc
    vector[np.diff(disc.contact.trace.tocsc().indptr) == 0] *= 1.1
    return vector
