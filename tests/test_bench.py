"""The assembly benchmark and the stability command."""

import numpy as np
import pytest

from ngdgc import LDG, Conforming, Discretization, InteriorPenalty, ProblemError
from ngdgc.bench import MeasureAssembly, Text
from ngdgc.cases import example_4_1, example_4_2
from ngdgc.cli import Main
from ngdgc.stabilitystudy import Study
from ngdgc.stabilitystudy import Text as StabilityText


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


def test_bench_command_prints_a_row_a_method(capsys):
    assert Main("bench assembly --method ip ldg --n 4 --repeat 1 --form lifting".split()) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[:3] for line in lines[1:]] == [["IP", "lifting", "192"], ["LDG", "lifting", "192"]]


def test_stability_command_prints_the_study_of_a_case(capsys):
    assert Main("stability example_4_2 --n 4 --order 2".split()) == 0
    assert capsys.readouterr().out.strip() == StabilityText(Study(example_4_2.Problem(), example_4_2.Mesh(4), order=2)).strip()


@pytest.mark.parametrize("arguments, culprit", [("bench assembly --method dg", "no method 'dg'"),
                                                ("bench assembly --n 4 --assembly fast", "assembly is 'fast'"),
                                                ("bench assembly --n 4 --form both", "form is 'both'"),
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
