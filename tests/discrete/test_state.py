"""Nothing changes under a solve: what a Discretization was made from is compared; Parameters are read when a solver begins."""

from threading import Thread

import numpy as np
import pytest
from ngsolve import (CF, H1, BilinearForm, BoundaryFromVolumeCF, GridFunction, Id, IfPos, LinearForm, Parameter, Sym, Trace,
                     VectorH1, dx, grad, specialcf, x, y)

from ngdgc import (LDG, BassiEtAl, BrezziEtAl, Conforming, ContactProblem, CoulombFriction, Discretization, Foundation,
                   HookeMaterial, InteriorPenalty, MultiStart, NormalCompliance, NotConvergedError, ProblemError,
                   SemismoothNewtonSolver, Solve, UzawaSolver)
from ngdgc.tools.formula import Numeric, Plain
from ngdgc.meshes import BoxMesh, RectangleMesh

SOLVERS = [SemismoothNewtonSolver(), UzawaSolver()]


def Disc(method=None, *, mesh=None, E=2000, k=300, gap=0.02, top=(0.05, -0.1), load=0, coefficient=0.3, order=1):
    law = Foundation("bottom", NormalCompliance(k), friction=CoulombFriction(coefficient), gap=gap)
    problem = ContactProblem(HookeMaterial(E=E, nu=0.3), law, dirichlet={"top": top}, traction={"left": (load, 0)})
    return Discretization(problem, method or InteriorPenalty(), mesh or RectangleMesh(4, upper=(2, 1)), order=order)


def Move(mesh):
    for point in mesh.ngmesh.Points():
        point[0] *= 2


def Rename(mesh):
    mesh.ngmesh.SetBCName(0, "else")


def Deform(mesh):
    field = GridFunction(VectorH1(mesh))
    field.Set((0.1 * x, 0))
    mesh.SetDeformation(field)


def Renumber(mesh):
    for element in mesh.ngmesh.Elements1D():
        element.index = 1


@pytest.mark.slow
@pytest.mark.parametrize("Change, word", [(Move, "points"), (Rename, "renamed"), (Deform, "deformation"),
                                          (Renumber, "other regions"), (lambda mesh: mesh.Curve(3), "curved"),
                                          (lambda mesh: mesh.Refine(), "refined")])
@pytest.mark.parametrize("method", [InteriorPenalty(), Conforming()], ids=["ip", "h1"])
def test_a_mesh_that_has_changed_is_refused(method, Change, word):
    """Before the first solve and after it, by every way to use the Discretization or its solution."""
    disc, solved = Disc(method), Disc(method)
    solution = Solve(solved)
    for one in (disc, solved):
        Change(one.mesh)
    uses = [lambda: Solve(disc), lambda: disc.matrix, lambda: disc.load, lambda: Solve(solved),
            lambda: MultiStart(solved, count=1), lambda: solution.gfu, lambda: solution.stress, lambda: solution.Report(),
            lambda: solution.At(0.5, 0.5)]
    for Use in uses:
        with pytest.raises(ProblemError, match=word):
            Use()


def test_a_mesh_deformed_before_is_no_change():
    """A deformation that was there when the Discretization was made belongs to it; that one changed is another."""
    mesh = RectangleMesh(4, upper=(2, 1))
    Deform(mesh)
    disc = Disc(mesh=mesh)
    long = Solve(disc).normalforce
    assert long == pytest.approx(Solve(Disc(mesh=RectangleMesh(4, upper=(2.2, 1)))).normalforce, rel=1e-9)
    mesh.deformation.vec[:] = 0
    with pytest.raises(ProblemError, match="deformation"):
        Solve(disc)


@pytest.mark.slow
@pytest.mark.parametrize("solver", SOLVERS, ids=["newton", "uzawa"])
@pytest.mark.parametrize("name, first, second", [("E", 2000, 4000), ("k", 300, 100), ("gap", 0.02, 0.05), ("load", 20, 60),
                                                 ("coefficient", 0.3, 0.1)])
@pytest.mark.parametrize("method", [InteriorPenalty(), Conforming()], ids=["ip", "h1"])
def test_a_parameter_is_read_when_a_solver_begins(method, solver, name, first, second):
    """Every datum with its new value, and the first solution with its old one, also in what it is asked for later."""
    t = Parameter(first)
    disc, fixed, other = Disc(method, **{name: t}), Disc(method, **{name: first}), Disc(method, **{name: second})
    before, right, after = solver.Solve(disc), solver.Solve(fixed), solver.Solve(other)
    t.Set(second)
    found = solver.Solve(disc)
    # To the tolerance of the solver; the control: the two values matter.
    assert found.displacement == pytest.approx(after.displacement, abs=1e-8) and found.disc is not disc
    assert np.abs(found.displacement - right.displacement).max() > 1e-5
    assert before.energy == pytest.approx(right.energy, rel=1e-8)
    for one, exact in ((before, right), (found, after)):
        for a, b in zip(one.Resultants(), exact.Resultants()):
            assert a.force == pytest.approx(b.force, abs=1e-6 * exact.normalforce)
        assert one.bound == pytest.approx(exact.bound, abs=1e-6)
    t.Set(first)
    assert solver.Solve(disc).disc is disc


@pytest.mark.parametrize("method", [LDG(), Conforming()], ids=["ldg", "h1"])
@pytest.mark.parametrize("kind", [BilinearForm, LinearForm])
def test_a_parameter_in_an_added_form_is_read_when_a_solver_begins(kind, method):
    """As if the form had been added with the value that it has then; control: the two values give other forces."""
    value = Parameter(200.0)
    problem = ContactProblem(HookeMaterial(E=2000, nu=0.3), Foundation("bottom", NormalCompliance(300)),
                             dirichlet={"top": (0, -0.1)})

    def Added(value):
        disc = Discretization(problem, method, RectangleMesh(3))
        u, v = disc.space.TnT()
        return disc.Add(kind(value * (u * v if kind is BilinearForm else v[1]) * dx))
    disc = Added(value)
    first = Solve(disc).normalforce
    value.Set(900.0)
    second, expected = Solve(disc), Solve(Added(900.0))
    # The iterations stop at 1e-10 of the tractions.
    assert second.normalforce == pytest.approx(expected.normalforce, rel=1e-8) and second.GlobalImbalance() < 1e-8
    assert abs(second.normalforce - first) > 0.05 * first


def test_a_parameter_of_the_material_makes_the_stress_of_an_old_solution_an_error():
    """An expression of NGSolve would be evaluated with the new value; other quantities keep the old one."""
    E, load = Parameter(2000), Parameter(20)
    solution = Solve(Disc(E=E, load=load))
    load.Set(30)
    assert solution.stress.dim == 4
    E.Set(1000)
    assert solution.GlobalImbalance() < 1e-9 and solution.At(1, 0.5)[1] < 0
    with pytest.raises(ProblemError, match="Parameter in material: E.*set it back"):
        solution.stress     # noqa: B018


def test_prescribed_displacements_with_a_parameter():
    """Of DG weakly, of H1 strongly; also a matrix that stays, its factors with it."""
    for method in (LDG(), Conforming()):
        depth = Parameter(0.1)
        disc = Disc(method, top=CF((0.05, -depth)))
        first = Solve(disc)
        depth.Set(0.12)
        second, right = Solve(disc), Solve(Disc(method, top=(0.05, -0.12)))
        assert second.displacement == pytest.approx(right.displacement, abs=1e-9)
        assert second.normalforce > 1.1 * first.normalforce
        assert second.disc.matrix is disc.matrix


@pytest.mark.slow
@pytest.mark.parametrize("assembly", ["facet", "skeleton"])
@pytest.mark.parametrize("method", [InteriorPenalty(), BassiEtAl(), BrezziEtAl(form="lifting"), LDG(), Conforming()],
                         ids=["ip", "bassi", "brezzi-lifting", "ldg", "h1"])
def test_no_form_keeps_prescribed_values(method, assembly):
    """The liftings of prescribed values follow their Parameters, on either route, in the solution and in its reactions."""
    def Made(depth, shift):
        problem = ContactProblem(HookeMaterial(E=2000, nu=0.3), Foundation("bottom", NormalCompliance(300)),
                                 dirichlet={"top": CF((0.05, -depth))}, roller={"right": shift})
        return Discretization(problem, method, RectangleMesh(2), order=1, assembly=assembly)
    depth, shift = Parameter(0.1), Parameter(0)
    disc = Made(depth, shift)
    first = Solve(disc)
    depth.Set(0.12)
    shift.Set(0.02)
    second, right = Solve(disc), Solve(Made(0.12, 0.02))
    # To the tolerance of the solver, relative to forces of about 40; the control: the values matter.
    for region in ("top", "right"):
        assert second.Force(region) == pytest.approx(right.Force(region), abs=1e-6)
        assert np.abs(second.Force(region) - first.Force(region)).max() > 1
    assert second.GlobalImbalance() < 1e-8


@pytest.mark.parametrize("where", ["gap", "k", "E", "load", "top"])
def test_a_gridfunction_that_was_filled_anew_is_refused(where):
    mesh = RectangleMesh(4, upper=(2, 1))
    field = GridFunction(H1(mesh, order=1))
    field.Set({"gap": 0.02, "k": 300, "E": 2000, "load": 5, "top": 0.1}[where])
    disc = Disc(mesh=mesh, **{where: CF((0.05, -field)) if where == "top" else 2 * field - field})
    solution = Solve(disc)
    field.vec.data = 1.5 * field.vec
    for Use in (lambda: Solve(disc), lambda: solution.Report()):
        with pytest.raises(ProblemError, match="GridFunction"):
            Use()


def test_what_changes_during_a_solve_is_an_error():
    mesh = RectangleMesh(4, upper=(2, 1))
    with pytest.raises(ProblemError, match="points of the mesh were moved"):
        Solve(Disc(mesh=mesh), callback=lambda step: Move(mesh) if step.number == 1 else None)


@pytest.mark.slow
@pytest.mark.parametrize("mesh, method, order", [(lambda: RectangleMesh(12, upper=(2, 1)), InteriorPenalty(), 2),
                                                 (lambda: BoxMesh(3), LDG(), 1)], ids=["2d", "3d"])
def test_threads_on_one_discretization(mesh, method, order):
    """As many solutions at once as one after the other; the stiffness of the law goes into matrices of their own."""
    mesh = mesh()
    top = {"top": (0.05, -0.1) if mesh.dim == 2 else (0.05, 0, -0.1)}
    foundation = Foundation("bottom", NormalCompliance(3e6), gap=0.02)
    disc = Discretization(ContactProblem(HookeMaterial(E=2000, nu=0.3), foundation, dirichlet=top), method, mesh, order=order)
    right, entries = Solve(disc), disc.matrix.AsVector().FV().NumPy().copy()
    found = []
    threads = [Thread(target=lambda: found.append(Solve(disc))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 4 and all(one.converged for one in found)
    for one in found:
        assert one.displacement == pytest.approx(right.displacement, abs=1e-9)
    assert np.array_equal(disc.matrix.AsVector().FV().NumPy(), entries)


@pytest.mark.slow
@pytest.mark.parametrize("read", ["symmetric", "loose", "unresisted", "inversekind", "load", "restraints"])
@pytest.mark.parametrize("method", [InteriorPenalty(), LDG()], ids=["ip", "ldg"])
def test_reading_changes_nothing_of_what_is_added(method, read):
    """A skew form: with Cholesky's factorisation of it, chosen before it was there, N would be twice as large."""
    def Force(name=None):
        problem = ContactProblem(HookeMaterial(E=100, nu=0.3), Foundation("bottom", NormalCompliance(100)),
                                 dirichlet={"top": (0, -0.1)})
        disc = Discretization(problem, method, RectangleMesh(4))
        getattr(disc, name or "order", None)
        u, v = disc.space.TnT()
        solution = Solve(disc.Add(BilinearForm(300 * (u[0] * v[1] - u[1] * v[0]) * dx)))
        assert solution.EquilibriumResidual() < 1e-12 and disc.inversekind == "umfpack"
        return solution.normalforce

    if read == "load":
        with pytest.raises(ProblemError, match="there already"):
            Force(read)
    else:
        assert Force(read) == pytest.approx(Force(), rel=1e-10)


@pytest.mark.parametrize("solver", [SemismoothNewtonSolver(), UzawaSolver()], ids=["newton", "uzawa"])
def test_a_solution_out_of_equilibrium_is_not_converged(solver, monkeypatch):
    """A wrong inverse, Cholesky's of an unsymmetric matrix: the law holds, the equations do not; with the right one they do."""
    def Sprung():
        disc = Disc(k=100)
        u, v = disc.space.TnT()
        return disc.Add(BilinearForm(3000 * (u[0] * v[1] - u[1] * v[0]) * dx))

    assert solver.Solve(Sprung()).EquilibriumResidual() < 1e-12
    monkeypatch.setattr(Discretization, "symmetric", property(lambda disc: True))
    with pytest.raises(NotConvergedError, match=r"A u - f \+ T' W t is .* of its terms.*sparsecholesky") as failure:
        solver.Solve(Sprung())
    assert not failure.value.solution.converged and failure.value.solution.EquilibriumResidual() > 1e-3


def test_what_is_printed_tells_numbers_and_coordinates_from_the_rest():
    """The quick look that spares taking functions apart takes none as plain that may change, or has another value inside."""
    mesh, a = RectangleMesh(2), Parameter(2.0)
    field = GridFunction(H1(mesh))
    def Tensors(one):
        """Operations that a stress, and its divergence, are made of."""
        matrix = CF((one, x, y, one), dims=(2, 2))
        return (matrix.trans, Sym(matrix), Trace(matrix) * Id(2), matrix * matrix, matrix * CF((x, y)), matrix[0, :],
                CF((one, x)) * one, (one * matrix)[0, 0].Diff(x, x * y + one))

    for function in (CF((0.05, -0.1)), IfPos(x - 0.5, 1, 0), x ** 2 / 3 - y, CF((0, 0)), 1e-30 * x, CF(float("nan")),
                     *Tensors(x * y)):
        assert Plain(function) and Numeric(function)
    numeric = [a * x, IfPos(a, x, y), a, CF((a, 1)), *Tensors(a * x)]     # one value at a point, which may change
    for function in (*numeric, field, CF((x, 2 * field)), grad(field)[0], specialcf.normal(2), mesh.MaterialCF({".*": 1}),
                     mesh.BoundaryCF({"left": 1}), (x * x).Compile(), specialcf.mesh_size,
                     BoundaryFromVolumeCF(x), *Tensors(field), *Tensors(specialcf.normal(2)[0])):
        assert not Plain(function)
        assert Numeric(function) == (function in numeric)
