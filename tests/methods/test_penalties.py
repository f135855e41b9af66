"""Critical penalties, the promise of the automatic one, lost coercivity, and the study of stability."""

import re
from pathlib import Path

import numpy as np
import pytest
from bodies import Cube, Distorted
from checks import Spectrum
from ngsolve import CF, GridFunction, x, y
from ngsolve.meshes import MakeStructured2DMesh, MakeStructured3DMesh
from problems import FOUNDATION, Held

from ngdgc import (LDG, BassiEtAl, BrezziEtAl, Conforming, ContactProblem, Discretization, HookeMaterial, InteriorPenalty,
                   ProblemError)
from ngdgc.methods import penalty
from ngdgc.cases import example_4_1
from ngdgc.theory.consistency import ConsistencyResidual
from ngdgc.theory.lemmas import Boundedness, Coercivity, CriticalPenalty, DualNorm, LiftingConstants
from ngdgc.meshes import RectangleMesh
from ngdgc.methods.penalty import MARGIN
from ngdgc.studies.stability import HEAD, ROWS, Markdown, Shapes, Study, Text

DOCS = Path(__file__).parents[2] / "docs"


@pytest.mark.slow
def test_critical_penalty_on_a_mesh_too_large_for_dense_matrices():
    """19 200 unknowns, with threads: the threshold grows a little towards that of an infinite mesh."""
    coarse, fine = (CriticalPenalty(Held(), BassiEtAl, RectangleMesh(n)) for n in (8, 40))
    assert coarse < fine == pytest.approx(coarse, rel=0.02)


@pytest.mark.slow
@pytest.mark.parametrize("mesh, order", [(Distorted("triangle"), 2), (Distorted("quad"), 1), (Cube("tet", 1), 1)],
                         ids=["triangles", "quads", "tets"])
@pytest.mark.parametrize("row, form", [(InteriorPenalty, "edge"), (InteriorPenalty, "lifting"), (BassiEtAl, "edge"),
                                       (BassiEtAl, "lifting")])
def test_critical_penalty_is_where_the_dense_smallest_eigenvalue_changes_sign(row, form, mesh, order):
    problem = Held(mesh.dim)
    critical = CriticalPenalty(problem, row, mesh, order=order, form=form)
    assert critical == pytest.approx(CriticalPenalty(problem, row(form=form), mesh, order=order), rel=1e-9)
    below, above = (Spectrum(Discretization(problem, row(form=form, penalty=factor * critical), mesh, order=order))
                    for factor in (0.999, 1.001))
    assert -0.01 < below < 0 < above < 0.01


def test_critical_penalty_of_interior_penalty_in_units_of_mu():
    """The thresholds of a first study, h_e = |e|, plane strain, held on the right; growing like lam + 2 mu."""
    found = {ratio: [CriticalPenalty(Held(mu=7.0, lam=7.0 * ratio), InteriorPenalty, RectangleMesh(4), order=k) * k ** 2
                     for k in (1, 2)] for ratio in (0, 1, 4, 10, 100)}
    published = {0: (7.1, 15), 1: (9.9, 22), 4: (21.5, 47), 10: (45.8, 98), 100: (416, 887)}
    for ratio, values in published.items():
        assert found[ratio] == pytest.approx(values, rel=0.015)     # printed with two or three digits
    assert 3.2 < min(found[ratio][0] / (ratio + 2) for ratio in found) and max(found[100]) / 102 < 8.8


@pytest.mark.slow
@pytest.mark.parametrize("shape", Shapes())
def test_bassi_needs_at_most_the_number_of_facets_and_brezzi_and_ldg_nothing(shape):
    mesh, facets = Shapes()[shape]
    problem = Held(mesh.dim)
    assert 0.5 < CriticalPenalty(problem, BassiEtAl, mesh) < facets
    for row in (BrezziEtAl, LDG):
        # The matrices differ by the stabilisation, eta* = 1, in a form of size lam/mu k^2: round-off of 1e-8 at most.
        assert CriticalPenalty(problem, row, mesh) < 1e-8
    assert CriticalPenalty(problem, InteriorPenalty, mesh) > 5


def test_edge_forms_of_brezzi_and_ldg_need_a_penalty_where_the_stress_is_not_in_the_lifting_space():
    mesh = Skewed()
    for row in (BrezziEtAl, LDG):
        assert CriticalPenalty(Held(), row, mesh, form="lifting") < 1e-8
        critical = CriticalPenalty(Held(), row, mesh)
        assert critical > 1
        assert Spectrum(Discretization(Held(), row(penalty=0.99 * critical), mesh, order=1)) < 0


def Skewed():
    """Quadrilaterals far from parallelograms."""
    return MakeStructured2DMesh(quads=True, nx=2, ny=2, mapping=lambda s, t: (s + 0.4 * t * (1 - t), t * (1 - 0.8 * s)))


def Box(cells, stretch):
    """Two elements or a few more, flat by the factor `stretch`; what an element needs does not depend on their number."""
    if cells in ("triangle", "quad"):
        return MakeStructured2DMesh(quads=cells == "quad", nx=2, ny=1, mapping=lambda s, t: (s, t / stretch))
    return MakeStructured3DMesh(hexes=cells == "hex", nx=2 if cells == "hex" else 1, ny=1, nz=1,
                                mapping=lambda s, t, r: (s, t, r / stretch))


@pytest.mark.slow
@pytest.mark.parametrize("nu, stretch", [(0.0, 1), (0.4999, 1), (0.4999, 100)])
@pytest.mark.parametrize("cells, order", [("triangle", 1), ("triangle", 8), ("quad", 1), ("quad", 8), ("tet", 1), ("tet", 3),
                                          ("hex", 1), ("hex", 2)])
def test_automatic_penalty_keeps_its_margin(cells, order, nu, stretch, monkeypatch):
    """B_h >= (1 - 1/sqrt(MARGIN)) (g_h + penalty) for every method with one; a tenth of the penalty loses coercivity."""
    mesh = Box(cells, stretch)
    problem = Held(mesh.dim, E=1000, nu=nu)
    rows = [row for row in ROWS if hasattr(row, "penalty")] if order == 1 else [InteriorPenalty]
    for row in rows:
        assert Spectrum(Discretization(problem, row(), mesh, order=order)) > 1 - MARGIN ** -0.5 - 1e-6
    monkeypatch.setattr(penalty, "MARGIN", MARGIN / 10)
    assert Spectrum(Discretization(problem, InteriorPenalty(), mesh, order=order)) < 0


def Assembled(problem, method, mesh, order):
    """The discretisation, its matrix assembled and checked."""
    disc = Discretization(problem, method, mesh, order=order)
    assert disc.matrix.height == disc.space.ndof
    return disc


@pytest.mark.parametrize("row, mesh, order, low", [(InteriorPenalty, RectangleMesh(4), 2, 10),
                                                   (BassiEtAl, RectangleMesh(4), 2, 0.3),
                                                   (InteriorPenalty, Cube("tet", 2), 1, 10)])
def test_lost_coercivity_is_refused_with_a_penalty_that_is_enough(row, mesh, order, low):
    problem = Held(mesh.dim)
    with pytest.raises(ProblemError, match=f"penalty={low:g} loses coercivity") as refused:
        Assembled(problem, row(penalty=low), mesh, order)
    enough = float(re.search(r"; penalty=(\S+) is safe", str(refused.value))[1])
    assert 0.95 < Assembled(problem, row(penalty=enough), mesh, order).form.guarantee.kappa < 1
    assert enough > CriticalPenalty(problem, row, mesh, order=order) > low


def test_where_no_bound_is_known_the_other_form_is_named():
    remedy = "take form='edge', a larger liftorder or a larger penalty"
    with pytest.raises(ProblemError, match=f"penalty=0.5 loses coercivity.* {remedy}"):
        Assembled(Held(), InteriorPenalty(form="lifting", penalty=0.5), Skewed(), 1)
    assert Assembled(Held(), InteriorPenalty(), Skewed(), 1).form.guarantee.kappa < 1


@pytest.mark.parametrize("row", [BassiEtAl, BrezziEtAl])
def test_automatic_penalty_where_the_stress_is_not_lifted(row):
    """Nearly incompressible quadrilaterals: the number of facets is not enough there for the edge form of Bassi et al."""
    problem = Held(E=1000, nu=0.4999)
    assert Spectrum(Discretization(problem, row(), Skewed(), order=1)) > 1 - MARGIN ** -0.5 - 1e-6
    with pytest.raises(ProblemError, match="penalty=4 loses coercivity"):
        Assembled(problem, BassiEtAl(penalty=4), Skewed(), 1)


@pytest.mark.slow
def test_study_holds_the_constants_of_every_method():
    seen = []
    study = Study(Held(), RectangleMesh(3), order=2, callback=seen.append)
    assert [row.method.name for row in study.rows] == [row.name for row in ROWS] and len(seen) == len(ROWS)
    for row in study.rows:
        if row.critical is not None:
            assert row.critical <= (0 if row.sufficient.kind == "always" else row.sufficient.kappa)
        assert 0 < row.coercivity < 1 < row.boundedness
    text = Text(study)
    assert all(name in text for name in HEAD) and "any" in text and f"{study.liftings.C:.3g}" in text


@pytest.mark.slow
def test_page_is_what_the_code_computes():
    page = (DOCS / "stability.md").read_text()
    study = Study(example_4_1.Problem("strain"), example_4_1.Mesh(8), order=1)
    tables = [[cell.strip() for cell in line.split("|")[1:-1]] for line in page.splitlines() if line.startswith("| ")]
    for line in Markdown(study)[2:-1]:
        name, *cells = [cell.strip() for cell in line.split("|")[1:-1]]
        written = next(row[1:] for row in tables if row[0] == name)
        for cell, other in zip(cells, written, strict=True):
            assert cell == other or float(cell) == pytest.approx(float(other), rel=0.01)    # three digits are printed
    assert len(tables) > 40


@pytest.mark.parametrize("call, culprit", [
    (lambda disc: CriticalPenalty(disc.problem, Conforming(), disc.mesh), "no penalty"),
    (lambda disc: CriticalPenalty(disc.problem, LDG(), disc.mesh, form="edge"), "form given beside"),
    (lambda disc: CriticalPenalty(disc.problem, LDG, disc.mesh, form="both"), "form is 'both'"),
    (lambda disc: ConsistencyResidual(disc, CF((x, y))), r"displacement differs from dirichlet\['right'\]"),
    (lambda disc: ConsistencyResidual(disc, GridFunction(disc.space)), "displacement is"),
    (lambda disc: ConsistencyResidual(disc, CF((0, 0, 0))), "with 2 components"),
    (lambda disc: LiftingConstants(disc, order=-1), "order is -1"),
])
def test_bad_arguments(call, culprit):
    with pytest.raises(ProblemError, match=culprit):
        call(Discretization(Held(), LDG(), RectangleMesh(2), order=1))


@pytest.mark.parametrize("tool", [Coercivity, Boundedness, lambda disc: DualNorm(disc, np.zeros(disc.space.ndof)),
                                  lambda disc: CriticalPenalty(disc.problem, LDG, disc.mesh)])
def test_a_body_held_by_its_foundation_alone_has_no_norm(tool):
    problem = ContactProblem(HookeMaterial(mu=1, lam=1), FOUNDATION, roller={"left|right": 0})
    with pytest.raises(ProblemError, match="only contact resists"):
        tool(Discretization(problem, LDG(), RectangleMesh(2), order=1))
