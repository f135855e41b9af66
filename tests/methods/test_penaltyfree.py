"""LDG without a penalty: liftings of degree k + 1 alone are stable, of degree k they are not."""

import numpy as np
import pytest
from bodies import Cube, Distorted
from checks import Spectrum
from ngsolve import CF, x, y
from problems import Example, Held

from ngdgc import (LDG, ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty, NormalCompliance,
                   PenaltyFreeLDG, ProblemError, SemismoothNewtonSolver)
from ngdgc.errors import EnergyError, L2Error, Rates
from ngdgc.exact import AffinePatch, SmoothSlip
from ngdgc.linear.conjugategradients import IterativeInverse
from ngdgc.mesh.facets import Csr
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.methods.penaltyfree import Correlation
from ngdgc.theory.lemmas import Boundedness, Coercivity

FORMS = ("edge", "lifting")


def Disc(mesh, method, order, lam=1.0):
    return Discretization(Held(mesh.dim, mu=1.0, lam=lam), method, mesh, order=order)


def Meshes(cells, *sizes):
    return [RectangleMesh(n, cells=cells) if cells in ("triangle", "quad") else Cube(cells, n) for n in sizes]


@pytest.mark.slow
@pytest.mark.parametrize("cells, order, sizes, expected", [
    ("triangle", 1, (4, 8), 0.65), ("triangle", 2, (2, 4), 0.54), ("quad", 1, (4, 8), 0.71), ("quad", 2, (2, 4), 0.6),
    ("tet", 1, (1, 2), 0.64), ("tet", 2, (1, 2), 0.55), ("hex", 1, (1, 2), 0.74), ("prism", 1, (1, 2), 0.67)])
def test_coercive_uniformly_in_the_mesh_size(cells, order, sizes, expected):
    """In |||.|||, which knows nothing of liftings.  Finer meshes have more facets inside: a few per cent."""
    coarse, fine = (Coercivity(Disc(mesh, PenaltyFreeLDG(), order)) for mesh in Meshes(cells, *sizes))
    assert 0.9 * coarse < fine < coarse and fine == pytest.approx(expected, abs=0.04)


@pytest.mark.slow
def test_control_liftings_of_degree_k_lose_it_like_h_squared_and_of_degree_k_less_1_are_singular():
    meshes = [RectangleMesh(n) for n in (4, 8, 16)]
    for order in (1, 2):
        found = [Coercivity(Disc(mesh, LDG(penalty=1e-8, liftorder=order), order)) for mesh in meshes]
        assert Rates(found)[-1] == pytest.approx(2, abs=0.4) and found[-1] < 0.02
        assert Coercivity(Disc(meshes[0], LDG(penalty=1e-8, liftorder=order + 1), order)) > 0.5
    assert Coercivity(Disc(meshes[0], LDG(penalty=1e-8, liftorder=1), 2)) < 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("cells, order", [("triangle", 1), ("triangle", 2), ("quad", 1), ("quad", 2), ("mixed", 2), ("tet", 1),
                                          ("tet", 2), ("hex", 1), ("prism", 1)])
def test_element_bound_is_a_bound(cells, order, form):
    """B_h >= (1 - sqrt kappa) (g_h + (C r_0, r_0)), and not by far: neighbours share the jumps that are worst for one."""
    mesh = Distorted(cells) if cells in ("triangle", "quad", "mixed") else Cube(cells, 2 if cells == "hex" else 1)
    disc = Disc(mesh, PenaltyFreeLDG(form=form), order)
    guarantee, smallest = disc.form.guarantee, Spectrum(disc)
    assert guarantee.holds and 0.2 < guarantee.kappa < 0.95
    assert 1 - guarantee.kappa ** 0.5 - 1e-9 < smallest < 4 * (1 - guarantee.kappa ** 0.5)
    # With liftings of degree k the angle is zero.
    lower = Disc(mesh, LDG(penalty=1e-8, liftorder=order, form="lifting"), order)
    assert Correlation(lower.form.operators, True).kappa == pytest.approx(1, abs=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize("cells, order", [("triangle", 1), ("triangle", 2), ("quad", 1), ("tet", 2)])
def test_no_constant_depends_on_lam(cells, order):
    """With liftings of degree k + 2, which nearly incompressible materials get; with k + 1 the bound tends to 1 but for P1."""
    mesh, = Meshes(cells, 4 if cells in ("triangle", "quad") else 1)
    moderate, stiff, stiffer = (Disc(mesh, PenaltyFreeLDG(), order, lam) for lam in (5.0, 1e3, 1e5))
    assert [disc.form.operators.liftorder - order for disc in (moderate, stiff, stiffer)] == [1, 2, 2]
    assert stiffer.form.guarantee.kappa == pytest.approx(stiff.form.guarantee.kappa, abs=0.01)
    assert stiffer.form.guarantee.kappa < 0.6
    assert Coercivity(stiffer) == pytest.approx(Coercivity(stiff), rel=0.05) and Coercivity(stiff) > 0.45
    fewer = Correlation(Disc(mesh, LDG(liftorder=order + 1), order, 1e5).form.operators, True).kappa
    assert (fewer > 0.999) == ((cells, order) != ("triangle", 1))


@pytest.mark.slow
@pytest.mark.parametrize("cells, order", [("triangle", 2), ("mixed", 2), ("hex", 1)])
def test_a_material_that_varies_within_elements_needs_the_lifting_form(cells, order):
    """Poisson's ratio rises to 0.4999 within elements: tractions on facets are no longer in Q_h, and no jump need be lifted.

    Of the lifting form the bound holds as for every material.  A constant material is the control: both forms are coercive.
    """
    mesh = Cube("hex", 1) if cells == "hex" else Distorted(cells)
    rollers = {"roller": {"left": 0, "right": 0}} if cells == "hex" else {}

    def Body(nu, form):
        problem = ContactProblem(HookeMaterial(E=1, nu=nu), Foundation("bottom", NormalCompliance(1)),
                                 dirichlet={"top": CF((0,) * mesh.dim)}, **rollers)
        return Discretization(problem, PenaltyFreeLDG(form=form), mesh, order=order)

    with pytest.raises(ProblemError, match="varies within elements, loses coercivity .* form='lifting'"):
        Body(0.2 + 0.2999 * x * y, "edge").SolveLinear(0)
    lifting = Body(0.2 + 0.2999 * x * y, "lifting")
    assert 1 - lifting.form.guarantee.kappa ** 0.5 - 1e-9 < Spectrum(lifting)
    assert Spectrum(Body(0.4999, "edge")) > 0.1


@pytest.mark.slow
@pytest.mark.parametrize("cells, order", [("triangle", 8), ("quad", 8), ("tet", 3), ("prism", 3)])
def test_highest_liftings_return_affine_functions(cells, order):
    """Liftings of degree k + 1 up to the highest order in 2D, and some of 3D; l = 9 is beyond what liftorder= admits."""
    mesh, = Meshes(cells, 1)
    exact = AffinePatch("slip", dim=mesh.dim)
    for form in FORMS:
        disc = Discretization(exact.problem, PenaltyFreeLDG(form=form), mesh, order=order)
        assert disc.form.operators.liftorder == order + 1
        solution = SemismoothNewtonSolver(tol=1e-11).Solve(disc)
        assert L2Error(solution, exact.displacement) < 1e-10 < L2Error(solution, AffinePatch("slip", dim=mesh.dim,
                                                                                         gap=0.11).displacement)


@pytest.mark.slow
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("order", [1, 2])
def test_converges_at_full_rates(form, order):
    exact, energy, l2 = SmoothSlip(), [], []
    for n in (4, 8):
        solution = SemismoothNewtonSolver(tol=1e-10).Solve(
            Discretization(exact.problem, PenaltyFreeLDG(form=form), RectangleMesh(n), order=order))
        energy.append(EnergyError(solution, exact.displacement))
        l2.append(L2Error(solution, exact.displacement))
    assert Rates(energy)[0] == pytest.approx(order, abs=0.15) and Rates(l2)[0] == pytest.approx(order + 1, abs=0.15)
    assert energy[-1] < 2 * 0.125 ** order


@pytest.mark.slow
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("cells", ["triangle", "quad", "tet", "hex", "prism"])
def test_two_assemblies_share_no_integral_and_agree(cells, form):
    mesh, = Meshes(cells, 2)
    problem = ContactProblem(HookeMaterial(mu=1.0, lam=4.0), Foundation("bottom", NormalCompliance(1.0)),
                             dirichlet={"right": CF((0.1, 0.2, 0.3)[:mesh.dim])}, roller={"top": 0.1})
    blocks, symbols = (Discretization(problem, PenaltyFreeLDG(form=form), mesh, order=1, assembly=assembly)
                       for assembly in ("facet", "skeleton"))
    for kind in ("Matrix", "Norm"):
        first, second = (Csr(getattr(disc.form, kind)()) for disc in (blocks, symbols))
        assert abs(first - second).max() < 1e-12 * abs(first).max()
    assert np.abs(blocks.load - symbols.load).max() < 1e-12 * np.abs(blocks.load).max()
    gfu = SemismoothNewtonSolver().Solve(blocks).gfu
    tested, other = blocks.form.Fluxes(gfu), symbols.form.Fluxes(gfu)
    for region, flux in tested.items():
        assert np.abs(flux - other[region]).max() < 1e-10 * np.abs(flux).max()
    assert abs(first - Csr(blocks.form.Matrix())).max() > 1e-3 * abs(first).max()      # control


@pytest.mark.slow
def test_conditioned_as_well_as_with_a_penalty_and_solved_by_conjugate_gradients():
    """C/c of the lemmas is below that of LDG with its automatic penalty; steps are about those of interior penalty."""
    discs = [Disc(RectangleMesh(8), method, 1) for method in (PenaltyFreeLDG(), LDG())]
    free, ldg = (Boundedness(disc) / Coercivity(disc) for disc in discs)
    assert free < ldg
    for nu in (0.3, 0.499):
        steps = {}
        for method in (PenaltyFreeLDG(), InteriorPenalty()):
            problem = ContactProblem(HookeMaterial(E=1, nu=nu), Foundation("bottom", NormalCompliance(1)),
                                     dirichlet={"top": (0, 0, -1)}, bodyforce=(0, 0, -1))
            disc = Discretization(problem, method, BoxMesh(4))
            inverse = IterativeInverse(disc, disc.matrix)
            inverse.Solve(disc.load)
            steps[method.name] = inverse.iterations
        assert steps["LDG0"] < 1.2 * steps["IP"] < 45


def test_where_the_edge_form_is_no_square_its_own_coupling_is_bounded():
    """On quadrilaterals that are no parallelograms the coupling of the edge form has another bound, and holds it too."""
    edge, lifting = (Discretization(Example(), PenaltyFreeLDG(form=form), Distorted("quad"), order=2).form for form in FORMS)
    assert not edge.operators.contains
    assert Correlation(edge.operators, False) == edge.guarantee != lifting.guarantee == Correlation(lifting.operators, True)
    assert edge.guarantee.holds and lifting.guarantee.holds
