"""Table 3: the protocols measure what they say, on small references; the full table is a command of its own."""

from itertools import product

import numpy as np
import pytest
from ngsolve import GridFunction, InnerProduct, Integrate

from ngdgc import Conforming, Discretization, InteriorPenalty, ProblemError, SemismoothNewtonSolver
from ngdgc.studies import table3
from ngdgc.cases import example_4_1
from ngdgc.problem.materials import Strain
from ngdgc.studies.table3 import (CLOSEST, DIAGONALS, EVERY, EXAMPLES, PROTOCOLS, PUBLISHED, SIZES, BrokenP1, Errors,
                                  FormDifferences, Methods, Page, Reading, Study, Text, Verdict)


def Solved(method, n, cells="triangle"):
    disc = Discretization(example_4_1.Problem(), method, example_4_1.Mesh(n, cells), order=1)
    return SemismoothNewtonSolver().Solve(disc)


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


@pytest.mark.slow
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
            for example in EXAMPLES for method in EVERY for plane in ("stress", "strain") for cells in DIAGONALS
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


def test_all_methods_stand_in_the_closest_reading_with_their_differences():
    """Numbers of a method of its own in its own row; two forms that differ by 1e-3 are told so."""
    readings = Invented(lambda plane, protocol: np.full(4, 1.23))
    factors = {"Bassi edge": 1.5, "Bassi lifting": 1.5 * 1.001, "LDG edge": 1.7}
    for example, (method, factor) in product(EXAMPLES, factors.items()):
        readings += [Reading(example, method, *CLOSEST[example], "true error", factor * np.array(PUBLISHED[example]))]
    page = Page(readings)
    for example, (plane, cells) in CLOSEST.items():
        section = page.split(f"## Example {example}, all methods, plane {plane}, diagonal {DIAGONALS[cells]}")[1].split("##")[0]
        rows = [line.split("|")[1].strip() for line in section.splitlines() if line.startswith("| ")]
        assert rows[2:7] == [f"true error, {method}" for method in (*EVERY, *factors)] and len(rows) == 2 + 2 * 3 + 3
        assert f"{1.7 * PUBLISHED[example][0]:.4e} (1.70)" in section
    assert FormDifferences(readings) == [f"Example {example}, Bassi: edge and lifting form, computed separately, differ by "
                                         "1.0e-03 relatively." for example in EXAMPLES]
    assert all(sentence in page for sentence in FormDifferences(readings))


@pytest.mark.slow
def test_study_holds_every_reading():
    """With the quick method alone, and the smallest reference there can be, from which the first mesh is far enough."""
    readings = Study(n=64, methods={"H1": Conforming()})
    assert len({(r.example, r.plane, r.cells, r.protocol) for r in readings}) == len(readings) == 2 * 4 * 2
    for reading in readings:
        assert np.all(np.diff(reading.errors) < 0) and 0.7 < reading.ratios[0] < 2.2


def test_other_methods_are_read_once_with_the_penalties_of_the_page(monkeypatch):
    """Without solving: what would be solved."""
    assert {label: method.penalty for label, method in Methods().items() if method.discontinuous} == {
        f"{name} {form}": 30 if name in ("IP", "LDG") else "auto"
        for name in ("IP", "Bassi", "Brezzi", "LDG") for form in ("edge", "lifting")}
    monkeypatch.setattr(table3, "_Read", lambda example, name, method, plane, cells, n: [(example, name, plane, cells)])
    for name in Methods():
        once, every = [(example, name, *CLOSEST[example]) for example in EXAMPLES], 2 * 4
        found = [reading for reading in Study(n=64) if reading[1] == name]
        assert len(set(found)) == every if name in EVERY else found == once


def test_reference_must_refine_the_meshes():
    for n in (32, 100):
        with pytest.raises(ProblemError, match="reference mesh must refine"):
            Study(n=n)
