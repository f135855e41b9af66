"""Table 3: the protocols measure what they say, on small references; the full table is a command of its own."""

import numpy as np
import pytest
from ngsolve import GridFunction, InnerProduct, Integrate

from ngdgc import Conforming, Discretization, InteriorPenalty, ProblemError, UzawaSolver, table3
from ngdgc.cases import example_4_1
from ngdgc.elasticity import Strain
from ngdgc.table3 import (DIAGONALS, EXAMPLES, METHODS, PROTOCOLS, PUBLISHED, SIZES, BrokenP1, Errors, Page, Reading, Study,
                          Text, Verdict)


def Solved(method, n, cells="triangle"):
    disc = Discretization(example_4_1.Problem(), method, example_4_1.Mesh(n, cells), order=1)
    return UzawaSolver().Solve(disc)


@pytest.mark.parametrize("cells", ["triangle", "triangle-flipped"])
@pytest.mark.parametrize("method", [InteriorPenalty(penalty=30), Conforming()], ids=["ip", "h1"])
def test_true_error_is_the_integral_over_the_fine_mesh(method, cells):
    coarse, fine = Solved(method, 2, cells), Solved(method, 8, cells)
    difference = coarse.strain - fine.strain
    expected = np.sqrt(Integrate(InnerProduct(difference, difference), fine.disc.mesh))      # default order: interior points
    assert Errors(BrokenP1(coarse), BrokenP1(fine))[0] == pytest.approx(expected, rel=1e-9)


def test_interpolants_agree_where_the_reference_is_continuous_and_not_where_it_jumps():
    for method, agree in ((Conforming(), True), (InteriorPenalty(penalty=30), False)):
        _, nodal, averaged = Errors(BrokenP1(Solved(method, 2)), BrokenP1(Solved(method, 8)))
        assert (abs(nodal - averaged) < 1e-12) == agree


def test_nodal_interpolant_of_a_conforming_reference():
    """Against NGSolve's own nodal interpolation (a P1 function takes its vertex values)."""
    coarse, fine = Solved(Conforming(), 4), Solved(Conforming(), 16)
    nodal = GridFunction(coarse.disc.space)
    for component in range(2):
        values = [fine.At(*vertex.point)[component] for vertex in coarse.disc.mesh.vertices]
        nodal.components[component].vec.FV().NumPy()[:] = values
    difference = coarse.strain - Strain(nodal)
    expected = np.sqrt(Integrate(InnerProduct(difference, difference), coarse.disc.mesh))      # default order: interior points
    assert Errors(BrokenP1(coarse), BrokenP1(fine))[1] == pytest.approx(expected, rel=1e-9)


def test_closest_reading_of_example_4_1():
    """Plane stress, diagonals /, reference 1/128: interpolants within 7 and 5 %, the true error is far off."""
    fine = BrokenP1(Solved(InteriorPenalty(penalty=30), 128))
    true, nodal, averaged = np.array([Errors(BrokenP1(Solved(InteriorPenalty(penalty=30), n)), fine) for n in SIZES]).T
    published = np.array(PUBLISHED["4.1"])
    assert np.abs(nodal / published - 1).max() < 0.07
    assert np.abs(averaged / published - 1).max() < 0.05 and averaged[-1] == pytest.approx(published[-1], rel=0.005)
    assert true[0] > 1.1 * published[0] and true[-1] > 1.7 * published[-1]


def Invented(factors):
    """Readings whose errors are multiples of the published ones."""
    return [Reading(example, method, plane, cells, protocol, np.array(PUBLISHED[example]) * factors(plane, protocol))
            for example in EXAMPLES for method in METHODS for plane in ("stress", "strain") for cells in DIAGONALS
            for protocol in PROTOCOLS]


def test_verdict_picks_the_closest_and_the_steadiest_reading():
    tilted = np.array([0.9, 0.95, 1.0, 1.02])
    readings = Invented(lambda plane, protocol: tilted if plane == "stress" else np.full(4, 1.5))
    sentences = Verdict(readings)
    closest = [sentence for sentence in sentences if "closest:" in sentence]
    steady = [sentence for sentence in sentences if "orders closest" in sentence]
    assert len(closest) == 6 and all("plane stress" in s and "ratios 0.900 to 1.020" in s for s in closest)
    assert len(steady) == 2 and all("plane strain" in s and "constant to 0.0 %" in s for s in steady)


def test_page_and_text_hold_published_numbers_ratios_and_verdict():
    readings = Invented(lambda plane, protocol: np.full(4, 1.23))
    for text in (Page(readings), Text(readings)):
        for number in (*PUBLISHED["4.1"], *PUBLISHED["4.2"]):
            assert f"{number:.4e}" in text and f"{1.23 * number:.4e} (1.23)" in text
        assert all(sentence in text for sentence in Verdict(readings))


def test_study_holds_every_reading(monkeypatch):
    """With the quick method alone, and the smallest reference there can be, from which the first mesh is far enough."""
    monkeypatch.setattr(table3, "METHODS", {"H1": METHODS["H1"]})
    readings = Study(n=64)
    assert len({(r.example, r.plane, r.cells, r.protocol) for r in readings}) == len(readings) == 2 * 4 * 2
    for reading in readings:
        assert np.all(np.diff(reading.errors) < 0) and 0.7 < reading.ratios[0] < 2.2


def test_reference_must_refine_the_meshes():
    for n in (32, 100):
        with pytest.raises(ProblemError, match="reference mesh must refine"):
            Study(n=n)
