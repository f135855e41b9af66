"""The benchmarks and the stability command."""

import numpy as np
import pytest

from ngdgc import LDG, Conforming, Discretization, InteriorPenalty, ProblemError
from ngdgc.studies.bench import solutions as bench
from ngdgc.studies.atlas.solvers import Point
from ngdgc.studies.bench.assembly import MeasureAssembly, Text
from ngdgc.studies.bench.page import Page
from ngdgc.studies.bench.traffic import MeasureTraffic, Traffic
from ngdgc.cases import example_4_1, example_4_2
from ngdgc.cli import Main
from ngdgc.studies.stability import Study
from ngdgc.studies.stability import Text as StabilityText


@pytest.mark.slow
@pytest.mark.parametrize("method, assembly", [(LDG(form="lifting"), "facet"), (InteriorPenalty(), "skeleton"),
                                              (Conforming(), "facet")], ids=lambda value: getattr(value, "name", value))
def test_measurement_is_of_the_matrix_it_names(method, assembly):
    row = MeasureAssembly(method, order=2, n=4, repeat=2, assembly=assembly)
    disc = Discretization(example_4_1.Problem(), method, example_4_1.Mesh(4), order=2)
    assert (row.dofs, row.entries) == (disc.space.ndof, disc.matrix.nze)
    for times in (row.setup, row.assembly, row.factorisation):
        assert times.shape == (2,) and np.all(times > 0)
    assert row.ratio == pytest.approx(np.mean(row.assembly / row.factorisation))        # the median of two
    assert 0 < row.before <= row.peak < 4096
    header, line = Text([row]).splitlines()
    assert f"{row.ratio:.2f}" in line and str(row.entries) in line and len(header) == len(line)


@pytest.mark.slow
def test_bench_command_prints_a_row_a_method(capsys):
    assert Main("bench assembly --method ip ldg --n 4 --repeat 1 --form lifting".split()) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[:3] for line in lines[1:]] == [["IP", "lifting", "192"], ["LDG", "lifting", "192"]]


@pytest.mark.slow
def test_cost_is_that_of_the_solution_it_names():
    cost = bench.Measure(Point(problem="4.1", n=16), repeat=2)
    disc = Point(problem="4.1", n=16).Discretization()
    finest = disc.Solve(tol=bench.TOL).levels[-1]
    assert (cost.dofs, cost.entries, cost.kind) == (disc.space.ndof, disc.matrix.nze, "sparsecholesky")
    assert (cost.iterations, cost.solves) == (finest.iterations, finest.solves) and 0 < cost.peak < 4096
    assert cost.cycles == cost.linear == 0
    parts = [cost.setup, cost.assembly, cost.coarse, cost.inverse, cost.contact]
    assert all(times.shape == (2,) and np.all(times > 0) for times in [*parts, cost.factorisation, cost.solve])
    assert np.allclose(sum(parts), cost.total, rtol=1e-9)
    assert cost.ratio == pytest.approx(np.mean(cost.total / (cost.factorisation + cost.solve)))     # the median of two


def test_a_swollen_box_is_the_box_of_another_material():
    swollen, box = bench.Swollen(problem="box", n=2, nu=0.499).contactproblem, Point(problem="box", n=2).contactproblem
    assert (swollen.material.nu, swollen.material.E) == (0.499, box.material.E) != (box.material.nu, box.material.E)


@pytest.mark.slow
def test_cost_of_an_iteration_counts_its_steps():
    cost = bench.Measure(Point(problem="box", n=3), repeat=1, inverse="iterative")
    disc = Discretization(Point(problem="box", n=3).contactproblem, InteriorPenalty(), Point(problem="box", n=3).Mesh(),
                          inverse="iterative")
    assert cost.cycles == disc.Solve(tol=bench.TOL).levels[-1].cycles > cost.solves
    disc.inverse.Solve(disc.load, tol=bench.TOL)
    assert cost.linear == disc.inverse.iterations
    assert f"| {cost.cycles} | {cost.linear} | iterative |" in Page({"a": [cost]}, [], 2)


def Costs(*sizes):
    """Costs whose total grows as dofs^1.5."""
    times = dict.fromkeys(("setup", "assembly", "coarse", "inverse", "contact", "factorisation", "solve"), np.ones(1))
    return [bench.Cost(Point(n=n), 6 * n ** 2, 9, "umfpack", 2, 7, 0, 0, 512.0, **times, total=np.array([n ** 3.0]))
            for n in sizes]


def test_growth_is_the_exponent_of_the_size():
    assert bench.Growth(Costs(4, 8, 64)) == pytest.approx(1.5)
    assert np.isnan(bench.Growth(Costs(4)))


def test_page_has_every_number_and_growth_only_of_sizes():
    page = Page({"sizes": Costs(8, 16), "one": Costs(8)}, ["GetFEM: skipped, no such thing"], 2)
    rows = [line.split(" | ") for line in page.splitlines() if line.startswith("| IP edge")]
    assert [row[1] for row in rows] == ["384", "1536", "384"] and rows[1][7:10] == ["4096.00", "2.00", "2048.00"]
    assert "sizes: time grows as unknowns^1.50" in page and "one: time grows" not in page and "* GetFEM: skipped" in page


@pytest.mark.slow
def test_bench_command_writes_table_figure_and_page(tmp_path, capsys):
    """With an interpreter that has no peer, which is said and harms nothing."""
    assert Main(["bench", "--quick", "--repeat", "1", "--only", "its own data", "--out", str(tmp_path), "--page",
                 str(tmp_path / "docs" / "performance.md")]) == 0
    written, page = (tmp_path / "performance.txt").read_text(), (tmp_path / "docs" / "performance.md").read_text()
    for text in (capsys.readouterr().out, written, page):
        assert text.count("IP edge, k = 1, n = ") == 2 and "time grows as unknowns^" in text
        assert "GetFEM: " in text and "DOLFINx: " in text
    assert (tmp_path / "performance.png").stat().st_size > 10_000
    assert (tmp_path / "docs" / "images" / "performance.png").stat().st_size > 10_000


def test_a_peer_that_is_missing_is_skipped_with_a_line(tmp_path):
    broken = tmp_path / "python"
    broken.write_text("#!/bin/sh\necho No module named getfem >&2\nexit 1\n")
    broken.chmod(0o755)
    assert bench.Peer("getfem", 4, python=str(broken)) == "No module named getfem"
    broken.write_text("#!/bin/sh\necho noise\necho '{\"dofs\": 3, \"seconds\": 2.0}'\n")
    assert bench.Peer("getfem", 4, python=str(broken)) == {"dofs": 3, "seconds": 2.0}


@pytest.mark.slow
def test_stability_command_prints_the_study_of_a_case(capsys):
    assert Main("stability example_4_2 --n 4 --order 2".split()) == 0
    assert capsys.readouterr().out.strip() == StabilityText(Study(example_4_2.Problem(), example_4_2.Mesh(4), order=2)).strip()


@pytest.mark.slow
@pytest.mark.parametrize("arguments, culprit", [("bench assembly --method dg", "no method 'dg'"),
                                                ("bench assembly --n 4 --assembly fast", "assembly is 'fast'"),
                                                ("bench assembly --n 4 --form both", "form is 'both'"),
                                                ("bench --only nothing", "no bench has 'nothing' in its name"),
                                                ("stability nothing", "no case 'nothing'"),
                                                ("stability example_4_1 --n 2 --form both", "form is 'both'")])
def test_a_mistake_is_one_line_and_exit_code_2(arguments, culprit, capsys):
    assert Main(arguments.split()) == 2
    error = capsys.readouterr().err
    assert culprit in error.splitlines()[-1]


def test_a_case_without_a_problem_has_no_stability(tmp_path, capsys):
    case = tmp_path / "case.py"
    case.write_text("def Main():\n    pass\n")
    assert Main(["stability", str(case)]) == 2
    assert "has no functions Problem() and Mesh(n)" in capsys.readouterr().err


def test_no_repetition_is_refused():
    with pytest.raises(ProblemError, match="repeat is 0"):
        MeasureAssembly(LDG(), n=4, repeat=0)


def test_traffic_counts_what_a_step_reads():
    """On tetrahedra of order 1 blocks of 12 x 12: of L, L' one for each facet between two elements, of D^-1 one an element."""
    traffic = MeasureTraffic(Point(problem="box", n=2, stiffness=1.0), length=1 << 12, repeat=1)
    elements, inner = 6 * 2 ** 3, (4 * 6 * 2 ** 3 - 6 * 2 * 2 ** 2) // 2
    assert (traffic.dofs, traffic.bytes) == (12 * elements, 8 * 12 ** 2 * (5 * inner + 2 * elements))
    assert traffic.steps > 5 and traffic.seconds > 0 and traffic.bandwidth > 1e7
    half = Traffic(dofs=1, steps=1, seconds=0.5, bytes=100, bandwidth=400.0)
    assert half.fraction == 0.5 and "0.5 of the 4e-07 GB/s" in str(half)
