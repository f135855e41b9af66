"""Inverses from outside: scipy's and pyamg's in ten lines, what they must do, and what is told of those that do not."""

from types import SimpleNamespace

import numpy as np
import pytest
from ngsolve import CF
from pyamg import smoothed_aggregation_solver
from scipy.sparse.linalg import splu

from ngdgc import (LDG, Conforming, ContactProblem, ContactSolution, CoulombFriction, Discretization, Foundation, HookeMaterial,
                   InteriorPenalty, NonsymmetricInteriorPenalty, NormalCompliance, NotConvergedError, ProblemError,
                   SemismoothNewtonSolver, TrescaFriction, UzawaSolver, WeaklyOverPenalised)
from ngdgc.linear.conjugategradients import ConjugateGradients, IterativeInverse
from ngdgc.linear.factorisations import Operator
from ngdgc.linear.motions import ProjectedMotions
from ngdgc.mesh.facets import Csr, Free
from ngdgc.meshes import BoxMesh, RectangleMesh


class SuperLU:
    """scipy's factorisation."""

    def __init__(self, matrix, free, disc):
        self.free = np.flatnonzero(Free(disc.space))
        self.factors = splu(Csr(matrix)[self.free][:, self.free].tocsc())

    def Solve(self, load):
        vector = np.zeros(len(load))
        vector[self.free] = self.factors.solve(load[self.free])
        return vector


class Aggregation:
    """Conjugate gradients with pyamg's smoothed aggregation, which knows the rigid motions."""

    def __init__(self, matrix, free, disc):
        self.free = np.flatnonzero(Free(disc.space))
        motions = ProjectedMotions(disc.space, np.zeros(disc.mesh.dim)).T[self.free]
        self.levels = smoothed_aggregation_solver(Csr(matrix)[self.free][:, self.free], B=motions)

    def Solve(self, load):
        vector = np.zeros(len(load))
        vector[self.free] = self.levels.solve(load[self.free], tol=1e-12, maxiter=200, accel="cg")
        return vector


def Cholesky(matrix, free, disc):
    return Operator(matrix.Inverse(free, inverse="sparsecholesky"), disc.mesh)


def Spoiled(Change):
    """An Inverter whose solutions of Cholesky's are changed."""
    def Spoilt(matrix, free, disc):
        inverse = Cholesky(matrix, free, disc)
        return SimpleNamespace(Solve=lambda load: Change(inverse.Solve(load)))
    return Spoilt


def Problem(stiffness=1e4, friction=0.3, dim=2):
    top = {2: (0.01, -0.02), 3: (0.01, 0, -0.02)}[dim]
    foundation = Foundation("bottom", NormalCompliance(stiffness), friction=CoulombFriction(friction))
    return ContactProblem(HookeMaterial(E=1000, nu=0.3), foundation, dirichlet={"top": CF(top)})


def Disc(inverse, method=InteriorPenalty(), mesh=None, **data):
    return Discretization(Problem(**data), method, mesh or RectangleMesh(3), inverse=inverse)


def Distance(one, other):
    return max(np.abs(getattr(one, name) - getattr(other, name)).max() / np.abs(getattr(other, name)).max()
               for name in ("vector", "traction"))


@pytest.mark.slow
@pytest.mark.parametrize("method", [InteriorPenalty(), LDG(), Conforming()], ids=lambda method: method.name)
@pytest.mark.parametrize("solver", [SemismoothNewtonSolver(), UzawaSolver(normal="implicit", acceleration="anderson")],
                         ids=["newton", "uzawa"])
def test_inverses_from_outside_lead_to_the_solution(method, solver):
    """Of pyamg's to 1e-12 there are 1e-9 left in tractions on a stiff foundation, of which Uzawa's tolerance is a part too."""
    ours = solver.Solve(Disc("sparsecholesky", method))
    for inverter, error in ((SuperLU, 1e-11), (Aggregation, 1e-8)):
        theirs = solver.Solve(Disc(inverter, method))
        assert Distance(theirs, ours) < (error if solver == SemismoothNewtonSolver() else 1e-8)
        assert theirs.EquilibriumResidual() < 1e-10 and f"linear solves by {inverter.__name__}," in theirs.Report()
    other = solver.Solve(Disc("sparsecholesky", method, friction=0.2))
    assert Distance(other, ours) > 1e-3


def test_a_stiff_foundation_and_a_body_that_it_alone_holds():
    """The matrix then has the stiffness of the law, up to a thousand moduli: its round-off is no mistake of an inverse."""
    stiff = [Disc(inverse, stiffness=1e9).Solve() for inverse in ("sparsecholesky", SuperLU)]
    assert Distance(*stiff) < 1e-8
    lying = ContactProblem(HookeMaterial(E=100, nu=0.3), Foundation("bottom", NormalCompliance(50), friction=TrescaFriction(1)),
                           bodyforce=(0, -1))
    for inverse in ("auto", SuperLU):
        assert Discretization(lying, LDG(), RectangleMesh(4), inverse=inverse).Solve().normalforce == pytest.approx(1, rel=1e-9)


def test_no_inverse_is_called_an_unsymmetric_one_that_is_right():
    method = NonsymmetricInteriorPenalty()
    assert Distance(Disc(SuperLU, method).Solve(), Disc("umfpack", method).Solve()) < 1e-10
    SuperLU.symmetric = True
    with pytest.raises(ProblemError, match="inverse='SuperLU' is for symmetric matrices, and this form is not"):
        Disc(SuperLU, method).Solve()
    del SuperLU.symmetric


class Steepest(IterativeInverse):
    """The package's iteration under another name: it takes a tolerance and a start."""

    def __init__(self, matrix, free, disc):
        super().__init__(disc, matrix, tol=1e-11)

    iterates = True


def test_an_iteration_from_outside_is_asked_for_no_more_than_is_needed():
    mesh = BoxMesh(2)
    direct = Disc("sparsecholesky", mesh=mesh, dim=3)
    ours, theirs, stubborn = (solver.Solve(coarser=()) for solver in (
        direct, Disc(Steepest, mesh=mesh, dim=3), Disc(lambda *made: Steepest(*made), mesh=mesh, dim=3)))
    assert Distance(theirs, ours) < 1e-7 and Distance(stubborn, ours) < 1e-9
    # Contact is solved in a subspace, with few solutions in V_h; one that does not say that it iterates needs more.
    assert 0 < theirs.disc.solves < stubborn.disc.solves / 2 and theirs.disc.cycles > 0 == stubborn.disc.cycles
    with pytest.raises(ProblemError, match="inverse='Steepest' is for discontinuous methods .* and H1 is none"):
        Disc(Steepest, Conforming()).Solve()
    with pytest.raises(ProblemError, match="and WOPSIP is none"):       # and not continuous either
        Disc("iterative", WeaklyOverPenalised(), mesh, dim=3).Solve()


def test_a_preconditioner_from_outside():
    """Symmetric Gauss-Seidel in the place of the cycle: the same solution in more steps."""
    mesh = BoxMesh(2)
    def GaussSeidel(matrix, free, disc):
        smoother = matrix.CreateSmoother(free)
        def Mult(b, x):
            x[:] = 0
            smoother.Smooth(x, b)
            smoother.SmoothBack(x, b)
        return SimpleNamespace(Mult=Mult)

    ours, theirs = (Disc(inverse, mesh=mesh, dim=3).Solve(coarser=()) for inverse in (
        "iterative", ConjugateGradients(preconditioner=GaussSeidel)))
    assert Distance(theirs, ours) < 1e-7 and theirs.disc.cycles > 1.2 * ours.disc.cycles > 0
    assert "by iterative with GaussSeidel," in theirs.Report()


def Forward(matrix, free, disc):
    """One sweep of Gauss-Seidel, which is not symmetric."""
    smoother = matrix.CreateSmoother(free)
    def Mult(b, x):
        x[:] = 0
        smoother.Smooth(x, b)
    return SimpleNamespace(Mult=Mult)


def test_a_preconditioner_that_is_none_is_named():
    def Backwards(matrix, free, disc):
        return SimpleNamespace(Mult=lambda b, x: x.FV().NumPy().__setitem__(slice(None), -b.FV().NumPy()))

    for preconditioner, words in ((Backwards, "preconditioner Backwards is not positive definite"),
                                  (Forward, "that Forward is poor or not symmetric")):
        disc = Disc(ConjugateGradients(preconditioner=preconditioner), mesh=BoxMesh(2), dim=3)
        with pytest.raises(ProblemError, match=words):
            disc.SolveLinear(disc.load)


def test_an_inverse_that_is_none_is_named_when_it_is_first_applied():
    mistakes = {"returns numbers that are not finite": Spoiled(lambda x: x * np.nan),
                r"returns shape \(7,\)": Spoiled(lambda x: x[:7]),
                "returns shape .* of type complex": Spoiled(lambda x: x + 0j),
                r"\|A x - b\| = .* \|b\|": Spoiled(lambda x: 1.001 * x),
                "returns shape .* of type object": Spoiled(lambda x: None),
                "Solve raises ZeroDivisionError": Spoiled(lambda x: 1 / 0)}
    for words, inverter in mistakes.items():
        for solver in (SemismoothNewtonSolver(), UzawaSolver()):
            with pytest.raises(ProblemError, match=f"inverse=Spoilt: .*{words}"):
                solver.Solve(Disc(inverter))
    with pytest.raises(ProblemError, match="inverse=Spoilt: .*returns values at dofs that are not free"):
        Disc(Spoiled(lambda x: x + 1), Conforming()).Solve()
    assert Disc(Spoiled(lambda x: 1 * x)).Solve().converged


def test_an_inverse_may_not_work_on_the_load_of_others():
    def InPlace(matrix, free, disc):
        inverse = Cholesky(matrix, free, disc)
        def Solve(load):
            load[:] = inverse.Solve(load)
            return load
        return SimpleNamespace(Solve=Solve)

    disc = Disc(InPlace)
    load = np.ones(disc.space.ndof)
    first, second = disc.SolveLinear(load), disc.SolveLinear(load)
    assert np.array_equal(first, second) and np.all(load == 1) and np.any(first != 1)


class Careless(Steepest):
    """Writes into all that it is given, but what it returns is right."""

    def __init__(self, matrix, free, disc):
        super().__init__(matrix, free, disc)
        free.Clear()

    def Solve(self, load, **options):
        vector = super().Solve(load, **options)
        load[:] = options.get("start", load)[:] = 7
        return vector


def test_an_inverse_writes_into_copies_but_may_not_change_the_matrix():
    """Of a continuous method free dofs matter; the matrix is too large for a copy, and a change would be another problem."""
    def Clearing(matrix, free, disc):
        inverse = SuperLU(matrix, free, disc)
        free.Clear()
        return inverse

    def Doubling(matrix, free, disc):
        matrix.AsVector().data = 2 * matrix.AsVector()
        return SuperLU(matrix, free, disc)

    disc = Disc(Clearing, Conforming())
    assert Distance(disc.Solve(), Disc("auto", Conforming()).Solve()) < 1e-10 and any(disc.space.FreeDofs())
    disc = Disc(Careless, mesh=BoxMesh(1), dim=3)
    load, start = np.ones(disc.space.ndof), np.zeros(disc.space.ndof)
    vector = disc.Iterate(disc.inverse, load, tol=1e-6, start=start)
    assert np.all(load == 1) and not np.any(start) and np.any(vector)
    with pytest.raises(ProblemError, match="inverse=Doubling changes the matrix that it is given"):
        Disc(Doubling).Solve()


def test_the_last_check_names_what_has_not_solved_the_equations():
    """One that turns wrong later than it was looked at: the equilibrium of the solution is computed without it."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("ngdgc.linear.outside.ACCURATE", np.inf)
        disc = Disc(Spoiled(lambda x: 1.001 * x))
        with pytest.raises(NotConvergedError, match="inverse='Spoilt' did not solve the linear equations"):
            SemismoothNewtonSolver().Solve(disc)


def test_a_file_has_the_name_of_an_inverse_and_says_so(tmp_path):
    solution = Disc(SuperLU).Solve()
    solution.Save(tmp_path)
    loaded, given = ContactSolution.Load(tmp_path, Problem()), ContactSolution.Load(tmp_path, Problem(), inverse=SuperLU)
    assert loaded.inverse == given.inverse == solution.inverse == "SuperLU" and "by SuperLU," in loaded.Report()
    assert (loaded.disc.inversekind, given.disc.inversekind) == ("sparsecholesky", "SuperLU")
    again = SemismoothNewtonSolver().Solve(given.disc)
    assert Distance(again, solution) < 1e-9 and again.inverse == "SuperLU"
    assert SemismoothNewtonSolver().Solve(loaded.disc).inverse == "sparsecholesky"
