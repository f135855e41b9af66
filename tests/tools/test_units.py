"""Units are words: every axis, report and table has those of the problem, no number changes, unknown ones are refused."""

import re

import pytest
from ngsolve import CF, Parameter

from ngdgc import (Conforming, ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty, NormalCompliance,
                   Solve, SolveHistory)
from ngdgc.cases import example_4_2
from ngdgc.commands.compare import Table
from ngdgc.export import Scene
from ngdgc.meshes import BoxMesh
from ngdgc.plots import (ComparisonFigure, ContactFigure, DeformedFigure, FieldFigure, LawFigure, LineFigure, SettingFigure,
                         LoadHistoryFigure, ZonesFigure)
from ngdgc.tools.units import InUnits

UNITS = ("mm", "N/mm^2")


def Words(figure):
    return " ".join(text.get_text() for text in figure.findobj(lambda artist: hasattr(artist, "get_fontsize")))


def Figures(solution):
    yield from (Make(solution) for Make in (DeformedFigure, FieldFigure, ContactFigure, ZonesFigure, LawFigure))
    yield from (SettingFigure(solution.disc), ComparisonFigure({"IP": solution}))


@pytest.fixture(scope="module", params=[2, 3])
def pair(request):
    """A block under a load, with units and without."""
    dim = request.param

    def Solved(units):
        problem = ContactProblem(HookeMaterial(E=100, nu=0.3), Foundation("bottom", NormalCompliance(10)),
                                 dirichlet={"top": CF((0,) * (dim - 1) + (-0.1,))}, units=units)
        return Solve(Discretization(problem, InteriorPenalty(), example_4_2.Mesh(2) if dim == 2 else BoxMesh(1)))
    return Solved(UNITS), Solved(None)


@pytest.mark.slow
def test_every_axis_has_them(pair):
    for figure, plain in zip(Figures(pair[0]), Figures(pair[1])):
        assert not re.search(r"\[[^]]*(length|stress)", Words(figure)) and "[mm]" in Words(figure)
        assert Words(figure) == InUnits(Words(plain), UNITS) != Words(plain)


def test_lines_and_scenes_have_them(pair):
    ends = ((0.1,) * pair[0].disc.mesh.dim, (0.9,) * pair[0].disc.mesh.dim)
    words = Words(LineFigure(pair[0], *ends))
    assert "[N/mm^2]" in words and "[mm]" in words and "[length]" not in words
    page, plain = (Scene(solution, field="vonmises").Page() for solution in pair)
    assert "von Mises stress [N/mm^2]" in page and "von Mises stress [stress]" in plain


def test_report_and_tables_have_them(pair):
    """Of what is written without units not a letter changes; forces have a name, in the plane per thickness."""
    (text, plain), dim = (solution.Report() for solution in pair), pair[0].disc.mesh.dim
    force = "N" if dim == 3 else "N/mm"
    assert f"Forces on the body [{force}]" in text and re.search(r"pressure p_n .* \[N/mm\^2\]\n", text)
    assert f"  {'int p_n':<22}{pair[0].normalforce:>14.6g} [{force}]\n" in text
    assert not re.search(r"\[|\]", plain)

    def Same(words):
        """Without units and seconds."""
        return re.sub(r" *\[[^]]*\]|[ (][0-9.]+ s\b", "", words)

    assert Same(text) == Same(plain) and text != plain
    assert pair[0].ToJSON()["units"] == list(UNITS) and pair[1].ToJSON()["units"] is None
    table, without = (Table({"ip": solution}).splitlines()[0] for solution in pair)
    assert "max |u| [mm]" in table and f"int p_n [{force}]" in table and "[" not in without


def test_units_of_products():
    """A force is stress times area; without a name for it the product stands there."""
    assert InUnits("[stress length^3] [stress length^2] [stress length]", ("m", "kPa")) == "[kN m] [kN] [kN/m]"
    assert InUnits("[stress length^4]", ("m", "kPa")) == "[kN m^2]"
    assert InUnits("[stress length^4]", ("m", "psi")) == "[psi m^4]"
    assert InUnits("[sqrt(stress length^2)] [stress/length] [length^2]", ("cm", "bar")) == "[sqrt(bar cm^2)] [bar/cm] [cm^2]"
    assert InUnits("the length [1]", UNITS) == "the length [1]"


def test_problems_keep_them():
    problem = ContactProblem(HookeMaterial(E=1, nu=0.3), Foundation("bottom", NormalCompliance(1)), dirichlet={"top": (0, 0)},
                             units=["m", "Pa"])
    assert problem.units == ("m", "Pa") and "units=('m', 'Pa')" in repr(problem)
    assert Discretization(problem, Conforming(), example_4_2.Mesh(2)).problem.units == ("m", "Pa")


@pytest.mark.parametrize("mesh", [example_4_2.Mesh(1), BoxMesh(1)], ids=["2D", "3D"])
def test_histories_have_them(mesh):
    """Forces and work of a body in space or of a slice; without units these words are left out."""
    force, work = ("N", "N mm") if mesh.dim == 3 else ("N/mm", "N")
    t = Parameter(0)
    for units, names in ((UNITS, {"[mm]", f"[{force}]", f"[{work}]"}), (None, {"[length]"})):
        problem = ContactProblem(HookeMaterial(E=100, nu=0.3), Foundation("bottom", NormalCompliance(10)),
                                 dirichlet={"top": CF((0,) * (mesh.dim - 1) + (-0.1 * t,))}, units=units)
        history = SolveHistory(Discretization(problem, InteriorPenalty(), mesh), parameter=t, times=[0, 1])
        words = Words(LoadHistoryFigure(history, against=[0, 1]))
        assert set(re.findall(r"\[.*?\]", words)) == names
