"""The numerical fluxes as functions on the facets, and the user's own forms."""

import numpy as np
import pytest
from bodies import Distorted
from ngsolve import CF, L2, BilinearForm, GridFunction, Integrate, LinearForm, Parameter, VectorL2, ds, dx, grad, x, y
from problems import GRADED, TEN, Example

from ngdgc import (LDG, Conforming, ContactProblem, Discretization, Foundation, HookeMaterial, IncompleteInteriorPenalty,
                   InteriorPenalty, NonsymmetricInteriorPenalty, NormalCompliance, ProblemError, SemismoothNewtonSolver, Solve,
                   TrescaFriction)
from ngdgc.discrete import added
from ngdgc.mesh.facets import RigidMotions
from ngdgc.meshes import BoxMesh, RectangleMesh

ROWS = [*TEN, NonsymmetricInteriorPenalty(), IncompleteInteriorPenalty(form="lifting")]


def Loaded(dim, material=None):
    """A body with every kind of load and support."""
    zero = (0,) * (dim - 1)
    return ContactProblem(material or HookeMaterial(E=200, nu=0.3),
                          Foundation("bottom", NormalCompliance(10), friction=TrescaFriction(0.2)),
                          dirichlet={"right": CF((0.01 * y, *zero))}, roller={"top": -0.01 * x},
                          traction={"left": CF((10 + y, -5, 3)[:dim])}, bodyforce=CF((x ** 2, -y, 2)[:dim]))


def Unbalanced(solution, orientation):
    """int_dK orientation sigma_hat n.r + int_K f_1.r for the rigid motions r, (motions, elements), by NGSolve's integrals."""
    mesh = solution.disc.mesh
    one = L2(mesh, order=0).TestFunction()
    found = []
    for motion in RigidMotions(mesh.dim):
        form = LinearForm((orientation * (solution.flux * motion) * one) * dx(element_boundary=True, bonus_intorder=8))
        form += (Parameter(0) + solution.disc.problem.bodyforce * motion) * one * dx(bonus_intorder=8)
        found.append(form.Assemble().vec.FV().NumPy().copy())
    return np.array(found)


@pytest.mark.slow
@pytest.mark.parametrize("assembly", ["facet", "skeleton"])
@pytest.mark.parametrize("method", ROWS, ids=[f"{method.name}-{method.form}" for method in ROWS])
@pytest.mark.parametrize("mesh, material", [(Distorted("mixed"), None), (Distorted("triangle"), GRADED),
                                            (BoxMesh(1, cells="prism"), None)], ids=["mixed", "graded", "prism"])
def test_fluxes_balance_on_every_element(mesh, material, method, assembly):
    """Force and moment of the fluxes and the body force vanish on each element; with the wrong orientation they do not."""
    disc = Discretization(Loaded(mesh.dim, material), method, mesh, order=2, assembly=assembly)
    solution = SemismoothNewtonSolver(tol=1e-11).Solve(disc)
    size = np.abs(Integrate(solution.disc.problem.traction["left"], mesh, definedon=mesh.Boundaries("left"))).max()
    assert np.abs(Unbalanced(solution, solution.disc.facets.orientation)).max() < 1e-10 * size
    assert np.abs(Unbalanced(solution, CF(1))).max() > 1e-2 * size
    assert np.abs(solution.ElementImbalance()).max() < 1e-10


@pytest.mark.slow
def test_flux_on_the_boundary_is_the_traction_there(ten):
    solution = SemismoothNewtonSolver().Solve(Discretization(Loaded(2), ten, RectangleMesh(4), order=2))
    forces = {resultant.region: resultant.force for resultant in solution.Resultants() if resultant.region}
    assert set(forces) == {"right", "top", "left", "bottom"}
    for region, force in forces.items():
        integral = np.array(Integrate(solution.flux, solution.disc.mesh, definedon=solution.disc.mesh.Boundaries(region)))
        assert integral == pytest.approx(force, abs=1e-9 * np.abs(forces["left"]).max())
    assert np.abs(forces["bottom"]).min() > 1e-3


def test_conforming_method_has_no_flux():
    solution = SemismoothNewtonSolver().Solve(Discretization(Example(), Conforming(), RectangleMesh(2), order=1))
    with pytest.raises(ProblemError, match="H1 has no numerical flux"):
        solution.flux    # noqa: B018


@pytest.mark.slow
@pytest.mark.parametrize("assembly", ["facet", "skeleton"])
@pytest.mark.parametrize("method", [LDG(), InteriorPenalty(), Conforming()], ids=lambda method: method.name)
def test_added_body_force_and_springs(method, assembly):
    """A LinearForm (b, v) is a body force; a BilinearForm (k u, v) a spring foundation in the volume."""
    mesh, force = RectangleMesh(4), CF((3, -40))
    problem = Example(20.0, friction=0.1)
    given = SemismoothNewtonSolver().Solve(Discretization(Example(20.0, friction=0.1, bodyforce=force), method, mesh, order=2))
    disc = Discretization(problem, method, mesh, order=2, assembly=assembly)
    added = SemismoothNewtonSolver().Solve(disc.Add(LinearForm(force * disc.space.TestFunction() * dx)))
    assert np.abs(added.vector - given.vector).max() < 1e-9 * np.abs(given.vector).max()
    assert added.GlobalImbalance() < 1e-10

    disc = Discretization(problem, method, mesh, order=2, assembly=assembly)
    u, v = disc.space.TnT()
    springs = BilinearForm(disc.space)
    springs += 2000 * u * v * dx
    held = SemismoothNewtonSolver().Solve(disc.Add(springs))
    assert held.GlobalImbalance() < 1e-10
    assert np.abs(held.vector - given.vector).max() > 0.1 * np.abs(given.vector).max()
    if method.discontinuous:
        assert np.abs(held.ElementImbalance()).max() < 1e-10
    springy = next(resultant.force for resultant in held.Resultants() if resultant.kind == "added")
    assert springy == pytest.approx(-2000 * np.array(Integrate(held.gfu, mesh)), rel=1e-9)


def test_added_forms_that_do_not_fit_are_refused():
    disc = Discretization(Example(), LDG(), RectangleMesh(2), order=1)
    u, v = disc.space.TnT()
    with pytest.raises(ProblemError, match="form is 3"):
        disc.Add(3)
    with pytest.raises(ProblemError, match="another space"):
        disc.Add(LinearForm(VectorL2(disc.mesh, order=1)))
    mixed = BilinearForm(trialspace=disc.space, testspace=VectorL2(disc.mesh, order=2))
    for wrong in (BilinearForm(disc.space, condense=True), mixed):
        with pytest.raises(ProblemError, match="no sparse square matrix"):
            disc.Add(wrong)
    with pytest.raises(ProblemError, match="not linear in the trial function"):
        disc.Add(BilinearForm((u * u) * (u * v) * dx))
    with pytest.raises(ProblemError, match="added form is not finite"):
        disc.Add(LinearForm(CF((1, 1)) / (0 * x) * v * dx))
    negative = BilinearForm(disc.space)
    negative += -1e5 * u * v * dx
    with pytest.raises(ProblemError, match="with the forms that were added B_h is not coercive"):
        disc.Add(negative).matrix    # noqa: B018
    solved = SemismoothNewtonSolver().Solve(Discretization(Example(), LDG(), RectangleMesh(2), order=1)).disc
    with pytest.raises(ProblemError, match="the matrix or the load is there already"):
        solved.Add(BilinearForm(solved.space))


def test_unsymmetric_added_form_is_solved():
    """Convection of the displacement: a Cholesky factorisation would be wrong without a word."""
    disc = Discretization(Example(20.0), InteriorPenalty(), RectangleMesh(4), order=1)
    u, v = disc.space.TnT()
    convection = BilinearForm(disc.space)
    convection += 300 * (grad(u) * CF((1, 0))) * v * dx
    solution = SemismoothNewtonSolver().Solve(disc.Add(convection))
    assert not disc.symmetric
    function = GridFunction(disc.space)
    function.vec.FV().NumPy()[:] = solution.vector
    residual = disc.Multiply(solution.vector) - disc.load + disc.contact.Load(solution.traction)
    assert np.abs(residual).max() < 1e-9 * np.abs(disc.load).max()


@pytest.mark.slow
@pytest.mark.parametrize("mesh", [RectangleMesh(4, upper=(2, 1)), BoxMesh(2)], ids=["2d", "3d"])
@pytest.mark.parametrize("method", [InteriorPenalty(), LDG(form="lifting"), Conforming()], ids=["ip", "ldg", "h1"])
def test_springs_alone_hold_a_motion(mesh, method):
    """On a side and in the whole body they carry the load; without them, or with springs across alone, it is refused."""
    dim, pull = mesh.dim, 5
    side, back = ("right", "left") if dim == 2 else ("front", "back")
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), Foundation("bottom", NormalCompliance(10)),
                             traction={side: (pull, 0, 0)[:dim]}, roller={"left": 0} if dim == 3 else None)
    for measure in (ds(skeleton=True, definedon=mesh.Boundaries(back)), dx):
        disc = Discretization(problem, method, mesh, order=2)
        u, v = disc.space.TnT()
        solution = Solve(disc.Add(BilinearForm(500 * u * v * measure)))
        forces = {resultant.kind: resultant.force for resultant in solution.Resultants()}
        assert forces["added"][0] == pytest.approx(-pull, rel=1e-8) and solution.GlobalImbalance() < 1e-9
    with pytest.raises(ProblemError, match="floats: nothing resists translation along x"):
        Solve(Discretization(problem, method, mesh, order=2))
    # Springs across, which resist nothing of what is free.
    disc = Discretization(problem, method, mesh, order=2)
    u, v = disc.space.TnT()
    with pytest.raises(ProblemError, match="floats: nothing resists translation along x"):
        Solve(disc.Add(BilinearForm(500 * u[1] * v[1] * dx)))


@pytest.mark.parametrize("make", [
    lambda u, v, mesh: u * v * ds, lambda u, v, mesh: u * v * ds(definedon="left"),
    lambda u, v, mesh: u * v * dx + u * v * ds, lambda u, v, mesh: u * v * dx(definedon=mesh.Boundaries("left")),
    lambda u, v, mesh: u * v * ds(element_boundary=True)])
def test_forms_without_values_on_boundary_elements_are_refused(make):
    """What NGSolve cannot evaluate of a discontinuous function; with skeleton=True it can, and the form counts."""
    disc = Discretization(Example(), LDG(), RectangleMesh(2), order=1)
    u, v = disc.space.TnT()
    with pytest.raises(ProblemError, match=r"write dx.*ds\(skeleton=True, definedon=...\)"):
        disc.Add(BilinearForm(make(u, v, disc.mesh)))
    with pytest.raises(ProblemError, match="integral 2 of the form is 0"):
        disc.Add(LinearForm(v[0] * dx + v[0] * ds))
    assert not disc.added
    disc.Add(BilinearForm(u * v * ds(skeleton=True, definedon="left")))
    # The mass of the edges of the left side, whose length is 1: (1, 0) has the energy 1.
    one = GridFunction(disc.space)
    one.Set((1, 0))
    ones = one.vec.FV().NumPy()
    assert ones @ (disc.added.matrix @ ones) == pytest.approx(1, rel=1e-12)


def test_forms_on_sides_ask_whether_every_boundary_element_is_one(monkeypatch):
    """On any mesh, before anything is assembled; forms in the elements do not."""
    asked = []
    monkeypatch.setattr(added, "CheckSkeleton", asked.append)
    disc = Discretization(Example(), LDG(), RectangleMesh(2), order=1)
    u, v = disc.space.TnT()
    disc.Add(BilinearForm(u * v * dx))
    assert asked == []
    disc.Add(BilinearForm(u * v * ds(skeleton=True, definedon="left")))
    assert asked == [disc.facets]
