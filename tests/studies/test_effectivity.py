"""The study of effectivities: what it calls the true error is one, and its tables say what was found."""

from dataclasses import replace

import numpy as np
import pytest
from ngsolve import x

from ngdgc import LDG, ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty, NormalCompliance, Solve
from ngdgc.errors import EnergyError
from ngdgc.exact import SmoothSlip
from ngdgc.meshes import RectangleMesh
from ngdgc.studies import effectivity
from ngdgc.studies.effectivity import Difference, Estimated, Randoms
from ngdgc.studies.samples import Draw
from ngdgc.studies.savings import Saving


@pytest.fixture(scope="module")
def rows():
    return list(Randoms(1, 2))


@pytest.mark.slow
def test_difference_from_a_fine_solution_is_the_error():
    exact = SmoothSlip()
    coarse = Solve(Discretization(exact.problem, LDG(), RectangleMesh(3), order=1))
    fine = Solve(Discretization(exact.problem, InteriorPenalty(), RectangleMesh(6), order=3))
    # The fine one has a thousandth of the error.
    assert Difference(fine, coarse) == pytest.approx(EnergyError(coarse, exact.displacement), rel=1e-4)
    graded = ContactProblem(HookeMaterial(E=1 + 9 * x, nu=0.3), Foundation("bottom", NormalCompliance(1)),
                            dirichlet={"top": (0, -0.1)})
    coarse, fine = (Solve(Discretization(graded, LDG(), RectangleMesh(n), order=1)) for n in (3, 6))
    assert Difference(fine, coarse) == pytest.approx(EnergyError(fine, coarse.gfu), rel=1e-6)     # C is that of each place
    assert Difference(coarse, coarse) < 1e-7        # round-off, before the root


@pytest.mark.slow
def test_random_problems_have_estimates_near_the_error(rows):
    assert len(rows) == 2 and all(0.8 < row.effectivity < 3 for row in rows)
    assert all(row.bound is None or row.bound > row.true for row in rows)
    assert all((row.bound is None) == ("q = 0" not in row.reason and "strict" not in row.reason) or row.reason for row in rows)


@pytest.mark.slow
def test_rows_say_which_problem_they_are_of(rows):
    """By its number in the sequence; the mesh is that of the study, and what it does not estimate is left out."""
    for row in rows:
        number, words = row.words.split(": ", 1)
        sample = Draw(1, int(number))
        assert row.stiffness == sample.stiffness and sample.method.discontinuous and sample.mesh.args[1] != "cad"
        mine, theirs = ([one for one in text.split() if one[:2] not in ("n=", "k=")] for text in (words, sample.words))
        assert mine == theirs and f"n={effectivity.SIZES[2]}" in words.split()


def test_farthest_rows_are_listed():
    """Those of the largest ratio to 1.4, from both sides."""
    rows = [Estimated(f"{n}: 2D", True, 10.0 ** n, 1.0, value, None, "-") for n, value in enumerate(
        (1.4, 1.3, 1.5, 1.45, 0.6, 3.2, 2.9, 0.7, 1.35))]
    text = effectivity.Page([], rows, [], seed=1, count=9, solids=0).split("The five farthest")[1]
    assert [n for n in range(9) if f"{n}: 2D" in text] == [1, 4, 5, 6, 7]


def test_page_counts_what_was_found():
    row = Estimated("0: 2D, triangle", True, 10.0, 1.0, 1.5, 3.0, "strict")
    worse = replace(row, words="1: 2D", stiffness=1e3, value=0.5, bound=None, reason="friction weakens with the slip")
    other = replace(row, words="2: 3D", stiffness=1e5)
    saving = Saving("Example 4.2", 2, 0.01, 3000, 80000.0, (2.0, 0.8), (1.0, 9.0))
    page = effectivity.Page([row], [row, worse, other], [saving], seed=1, count=2, solids=1)
    assert "0.50 to 1.50, median 1.00; in [0.9, 3]: 50 %" in page and "given for 50 %: 3.00 to 3.00" in page
    assert "no bound for 1: friction weakens" in page and "| Example 4.2 | 2 | 0.01 | 3000 | 8e+04 | 1.00 | 0.40 |" in page
    assert "1.50" in effectivity.Text([row], [row], [saving]) and np.isclose(worse.effectivity, 0.5)
