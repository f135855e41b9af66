"""Iterations that fail, one for every diagnosis, as in `mistakes`: culprit | expectation | remedy."""

from unittest.mock import patch

from ngsolve import CF
from problems import Example

from ngdgc import (ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NestedNewtonSolver, NormalCompliance, PowerFriction, SemismoothNewtonSolver, TrescaFriction, UzawaSolver)
from ngdgc.studies.atlas.solvers import Point
from ngdgc.meshes import RectangleMesh
from ngdgc.solvers import driver
from ngdgc.solvers.newton import correction
from ngdgc.solvers.uzawa.contraction import ComplianceNorm
from ngdgc.solvers.newton.record import Record


def Disc(problem=None, n=4, *, method=None, order=1):
    return Discretization(problem or Example(), method or InteriorPenalty(), RectangleMesh(n), order=order)


def Pressed(stiffness, friction, n=4, *, push=0.0, gap=0.0, **options):
    """A block that is pressed and pushed along its foundation."""
    foundation = Foundation("bottom", NormalCompliance(stiffness), friction=friction, gap=gap)
    return Disc(ContactProblem(HookeMaterial(E=2000, nu=0.3), foundation, dirichlet={"top": CF((push, -0.05))}), n, **options)


def Dragged(force):
    """A block on a foundation whose friction holds no more than 3."""
    law = Foundation("bottom", NormalCompliance(1e4), friction=CoulombFriction(0.3))
    return Disc(ContactProblem(HookeMaterial(E=2000, nu=0.3), law, traction={"top": CF((force, -10))}))


def Sheared(stiffness, friction, n, order):
    """Example 4.1 without a gap."""
    return Disc(Example(foundation=Foundation("bottom", NormalCompliance(stiffness), friction=friction)), n, order=order)


def TakenForLost(solver, disc, *, after=5):
    """An iteration that would converge, but that the driver takes for a cycle after some steps: what does it make of that?"""
    def Verdict(solver, history, *others):
        return "cycle" if len(history) == after else None

    with patch.object(driver, "_Verdict", Verdict):
        return solver.Solve(disc)


def StepTooLong():
    """An implicit step of three times what the norm of S allows."""
    disc = Sheared(1e6, TrescaFriction(100), 2, 1)
    UzawaSolver(normal="implicit", rho=3 / ComplianceNorm(disc)).Solve(disc)


def Cycling():
    """Newton's method whose zones would come back every second step."""
    with patch.object(Record, "Period", return_value=2):
        return TakenForLost(SemismoothNewtonSolver(), Pressed(2e6, CoulombFriction(0.3), 8, push=0.01), after=3)


def Iterated():
    """A box whose linear equations are iterated."""
    point = Point(problem="box", n=3)
    return Discretization(point.contactproblem, InteriorPenalty(), point.Mesh(), inverse="iterative")


def Impatient():
    """Corrections that are taken for lost after the first one."""
    with patch.object(correction, "PATIENCE", 0):
        SemismoothNewtonSolver().Solve(Iterated())


FAILURES = [
    # Contact in a subspace and equilibrium in the whole.
    (lambda _: Impatient(), "in the whole space, in turn, stay at a law residual of | what the subspace does not see | "
     "inverse='sparsecholesky', which needs no subspace, or a finer mesh"),
    # Uzawa's iteration with the normal compliance explicit.
    (lambda _: UzawaSolver(tol=1e-17).Solve(Disc(n=8, order=3)), "tol=1e-17 | what round-off allows here | take a larger tol"),
    (lambda _: UzawaSolver(maxiter=2).Solve(Disc()),
     "too slowly with rho='auto' | together they must be below 1 | raise maxiter or tol"),
    (lambda _: UzawaSolver(maxiter=2, rho=1e-3).Solve(Disc()),
     "rho=0.001 | large sticking zones are slow | take rho='auto', raise maxiter"),
    (lambda _: UzawaSolver().Solve(Disc(Example(4500.0))),
     "the contraction number |p_n' S_nn| is | must be below 1 | a foundation that is softer by this factor"),
    (lambda _: UzawaSolver(rho=0.95).Solve(Pressed(2000, TrescaFriction(107), 8, push=0.3, gap=0.05)),
     "Uzawa cycles because rho=0.95 is too large | must be below 1 | of it, or rho='auto'"),
    (lambda _: TakenForLost(UzawaSolver(), Disc(Example(830.0))),
     "Uzawa cycles because its step is too large | must be below 1 | Remedy: UzawaSolver(normal='implicit'"),
    (lambda _: TakenForLost(UzawaSolver(acceleration="anderson"), Sheared(300, TrescaFriction(1), 2, 1)),
     "acceleration makes no progress | plain steps contract | Remedy: acceleration=None"),
    (lambda _: TakenForLost(UzawaSolver(), Sheared(300, CoulombFriction(0.3), 2, 1)),
     "Uzawa cycles although its numbers predict | the friction bound depends on the penetration | Remedy: a smaller friction"),
    # With the implicit normal step.
    (lambda _: UzawaSolver(normal="implicit", tol=1e-17).Solve(Disc(n=8, order=3)),
     "tol=1e-17 | what round-off allows here | take a larger tol"),
    (lambda _: StepTooLong(), "is too large: rho |S| is 3 | must be below 2 | of it, or rho='auto'"),
    (lambda _: TakenForLost(UzawaSolver(normal="implicit", rho="adaptive"), Sheared(1e5, TrescaFriction(1), 2, 1)),
     "makes no progress with rho='adaptive' | so plain steps converge | Remedy: rho='auto' without acceleration"),
    (lambda _: UzawaSolver(normal="implicit").Solve(Sheared(3.416e4, PowerFriction(76725), 8, 2)),
     "makes no progress although its step is small enough | there is no energy | Remedy: a smaller friction"),
    (lambda _: UzawaSolver(normal="implicit", maxiter=2, rho=1e-6).Solve(Disc()),
     "converges too slowly with rho=1e-06 | rho |S| is | take rho='auto', raise maxiter or tol"),
    # Newton's method.
    (lambda _: SemismoothNewtonSolver(maxiter=1).Solve(Pressed(2e6, CoulombFriction(0.3), 8, push=0.01)),
     "Newton | reached its limit of steps | raise maxiter"),
    (lambda _: SemismoothNewtonSolver(tol=1e-17).Solve(Pressed(2e6, CoulombFriction(0.3), 8, order=3)),
     "tol=1e-17 | what round-off allows here | take a larger tol"),
    (lambda _: NestedNewtonSolver(coarser=()).Solve(Dragged(3.1)),
     "The foundation alone resists translation along x | push it along harder than friction holds | Remedy: other loads"),
    (lambda _: TakenForLost(SemismoothNewtonSolver(), Pressed(2e6, CoulombFriction(0.3), 8, push=0.01), after=2),
     "Newton stagnates, its last step shortened | raising the load in steps was given up | Remedy: a smaller friction"),
    (lambda _: Cycling(), "Newton cycles with period 2 | differ in the zones of | Remedy: a smaller friction")]
