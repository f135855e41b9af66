"""Our own classes keep their contracts, and a class that does not is told which member is missing or wrong."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from ngsolve import H1, VOL, CF, GridFunction

from ngdgc import (LDG, Conforming, ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NestedNewtonSolver, NormalCompliance, PowerFriction, ProblemError, SemismoothNewtonSolver,
                   SlipWeakeningFriction, TrescaFriction, UzawaSolver)
from ngdgc.conformance import (CheckForm, CheckInverse, CheckLaw, CheckLinearProblem, CheckMethod, CheckPreconditioner,
                               CheckSolver, CheckSpaceNumbering)
from ngdgc.linear.choice import INVERTERS, HasPardiso
from ngdgc.linear.factorisations import Operator
from ngdgc.linear.multigrid import VCycle
from ngdgc.mesh.facets import Csr, Native
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.methods.registry import METHODS
from ngdgc.solvers.newton.subspace import Subspace


def Disc(method=None, mesh=None, held=True, **options):
    mesh = mesh or RectangleMesh(2)
    foundation = Foundation("bottom", NormalCompliance(100), friction=CoulombFriction(0.3))
    support = {"dirichlet": {"top": CF((0.01, 0, -0.02)[-mesh.dim:])}} if held else {"bodyforce": CF((0, 0, -1)[-mesh.dim:])}
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), foundation, **support)
    return Discretization(problem, method or InteriorPenalty(), mesh, **options)


def Refused(words, Check, *arguments, **options):
    with pytest.raises(ProblemError, match=words):
        Check(*arguments, **options)


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


class Wrong:
    """A Discretization with some members replaced."""

    def __init__(self, disc, **members):
        self.__dict__.update(members)
        self.disc = disc

    def __getattr__(self, name):
        return getattr(self.disc, name)


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


@pytest.mark.slow
@pytest.mark.parametrize("name", METHODS)
def test_methods(name):
    CheckMethod(METHODS[name]())


@pytest.mark.slow
@pytest.mark.parametrize("cells", ["quad", "tet", "hex"])
def test_methods_on_other_cells(cells):
    for method in (InteriorPenalty(), LDG(form="lifting"), Conforming()):
        CheckMethod(method, cells=cells, order=2)


def Form(**members):
    """The form of a method with some members replaced."""
    disc = Disc()
    return Wrong(disc.form, **members), disc.space


def test_forms_and_methods_that_are_none():
    disc = Disc()
    CheckForm(*Form())
    matrix = Csr(disc.form.Norm())
    Refused("form SimpleNamespace has no .*Matrix, Norm, Prescribed", CheckForm, SimpleNamespace(), disc.space)
    Refused(r"Wrong.Matrix\(\) has shape \(3, 3\)", CheckForm, *Form(Matrix=lambda: Native(matrix[:3, :3])))
    Refused(r"Wrong.Matrix\(\) is not finite", CheckForm, *Form(Matrix=lambda: Native(np.nan * matrix)))
    Refused(r"Wrong.Norm\(\) is not symmetric", CheckForm, *Form(Norm=lambda: Native(matrix + 0.1 * np.abs(matrix).multiply(
        np.arange(48)[:, None] > np.arange(48)).tocsr())))
    Refused(r"Wrong.Norm\(\) is not positive", CheckForm, *Form(Norm=lambda: Native(-matrix)))
    Refused(r"Wrong.Prescribed\(\)\['top'\] has shape", CheckForm, *Form(Prescribed=lambda: {"top": np.zeros(3)}))
    Refused("method SimpleNamespace has no .*Form, ScalarSpace, Space", CheckMethod, SimpleNamespace())
    Refused("says that it is symmetric", CheckMethod, Wrong(METHODS["nipg"](), symmetric=True))
    tilted = InteriorPenalty()
    Refused("does not return an affine displacement", CheckMethod, Wrong(tilted, Form=lambda problem, *rest: tilted.Form(
        replace(problem, dirichlet={region: 2 * value for region, value in problem.dirichlet.items()}), *rest)))


def Answering(method, form=None, **answers):
    """A method that answers otherwise, or makes its form with other members."""
    if form:
        answers["Form"] = lambda *data: Wrong(made := method.Form(*data), **form(made))
    return Wrong(method, **answers)


def test_methods_that_do_not_answer_for_themselves():
    """Every question of the contract, answered wrongly; the wrappers themselves are no mistake."""
    ip, h1 = InteriorPenalty(), Conforming()
    CheckMethod(Answering(ip, form=lambda made: {}))
    for words, method in {
            "has symmetric = 'yes'; answer True or False": Answering(ip, symmetric="yes"),
            "IP says discontinuous = False, and its elements have no dofs": Answering(ip, discontinuous=False),
            "H1 says discontinuous = True, and its elements have some dofs": Answering(h1, discontinuous=True),
            "IP says that displacements on Gamma_D are not weak": Answering(ip, weak=False),
            "H1 says that displacements on Gamma_D are weak": Answering(h1, weak=True),
            "has no FluxFunction, operators; .* contracts.FluxForm": Answering(h1, conservative=True),
            "H1 says iterative = True, and is continuous": Answering(h1, iterative=True),
            "not return an affine displacement": Answering(METHODS["wopsip"](), form=lambda _: {"consistent": True})}.items():
        Refused(words, CheckMethod, method)


def test_fluxes_that_are_none():
    """Of the wrong size, without a region, not finite, without balance, and not those of FluxFunction."""
    ip = InteriorPenalty()

    def Fluxes(Change):
        return Answering(ip, form=lambda made: {"Fluxes": lambda gfu: {
            region: Change(flux) for region, flux in made.Fluxes(gfu).items()}})

    def Flux(Change):
        def FluxFunction(made, gfu):
            return Change(made.FluxFunction(gfu))
        return Answering(ip, form=lambda made: {"FluxFunction": lambda gfu: FluxFunction(made, gfu)})

    def Halved(function):
        function.vec.data = 0.5 * function.vec
        return function

    CheckMethod(Fluxes(np.copy))
    CheckMethod(Flux(lambda function: function))
    Refused("Fluxes.* has shape", CheckMethod, Fluxes(lambda flux: flux[:3]))
    Refused("Fluxes.* is not finite", CheckMethod, Fluxes(lambda flux: np.nan * flux))
    Refused("do not balance its elements", CheckMethod, Fluxes(lambda flux: 2 * flux))
    Refused("is .*; give a dictionary", CheckMethod, Answering(ip, form=lambda made: {"Fluxes": lambda gfu: [1]}))
    Refused("another by FluxFunction than by Fluxes", CheckMethod, Flux(Halved))
    Refused("FluxFunction has .* coefficients", CheckMethod, Flux(lambda function: GridFunction(H1(function.space.mesh))))
    Refused(r"Prescribed\(\)\[.*\] is not finite", CheckForm, *Form(Prescribed=lambda: {"top": np.full(48, np.nan)}))
    Refused("is None; give NGSolve's sparse matrix", CheckForm, *Form(Norm=lambda: None))


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
