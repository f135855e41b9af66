"""Convergence and locking studies: orders, their table and figure, methods without locking and the one that locks."""

import re
from dataclasses import replace

import numpy as np
import pytest
from checks import ExitCode
from ngsolve.meshes import MakeStructured2DMesh

from ngdgc import LDG, BassiEtAl, Conforming, InteriorPenalty, ProblemError
from ngdgc.studies import accuracy, convergence, locking
from ngdgc.cli import Main
from ngdgc.exact import SmoothSlip
from ngdgc.plots import ConvergenceFigure, LockingFigure
from ngdgc.methods.variants import Variants

ORDER = 0.15        # of observed orders on meshes this coarse


def Series(label="IP edge", order=1, n=(4, 8), constant=1.0, energy=None):
    """Invented errors that fall with exactly the full orders, or `energy`."""
    h = 1 / np.array(n)
    return convergence.Series(label, "triangle", order, n, (10,) * len(n), constant * h ** order if energy is None else energy,
                              constant * h ** (order + 1))


def test_variants_are_four_methods_in_two_forms_and_h1():
    everything = Variants()
    assert len(everything) == 9 and len({(one.name, getattr(one, "form", None)) for one in everything.values()}) == 9
    assert list(Variants(form="lifting")) == ["IP lifting", "Bassi lifting", "Brezzi lifting", "LDG lifting", "H1"]
    assert {one.penalty for one in Variants("ldg", penalty=7).values()} == {7}
    mixed = Variants(penalty={"ip": 30})
    assert mixed["IP edge"].penalty == 30 and mixed["LDG edge"].penalty == "auto"


@pytest.mark.slow
@pytest.mark.parametrize("method", [LDG(form="lifting"), BassiEtAl(), Conforming()], ids=["ldg-lifting", "bassi", "h1"])
@pytest.mark.parametrize("order", [1, 2])
def test_study_finds_the_full_orders(method, order):
    series = convergence.Study(SmoothSlip(), method, order=order, n=(4, 6), cells="quad")
    for gain, rates in enumerate(series.rates):
        assert rates == pytest.approx(order + gain, abs=ORDER)
        assert rates != pytest.approx(order + gain + 1, abs=ORDER)     # order k is not k + 1


def test_study_control_a_wrong_solution_has_order_zero():
    exact = SmoothSlip()
    series = convergence.Study(replace(exact, displacement=1.1 * exact.displacement), InteriorPenalty(), order=2, n=(4, 8))
    assert np.abs(series.rates).max() < 0.1


def test_study_takes_any_family_of_meshes():
    """A graded one: elements of different shape, the same orders; and the callback hears of every mesh."""
    def Graded(n, cells):
        return MakeStructured2DMesh(quads=cells == "quad", nx=n, ny=n, mapping=lambda s, t: (s, t * (1 + t) / 2))

    lines = []
    series = convergence.Study(SmoothSlip(), InteriorPenalty(), n=(4, 8), mesh=Graded, callback=lines.append)
    plain = convergence.Study(SmoothSlip(), InteriorPenalty(), n=(4, 8))
    assert series.rates[0] == pytest.approx(1, abs=ORDER) and not np.allclose(series.energy, plain.energy, rtol=1e-3)
    assert lines == ["IP edge, order 1, triangle, n = 4", "IP edge, order 1, triangle, n = 8"]


def test_table_holds_errors_and_orders():
    series = Series(n=(4, 8, 24))
    text, summary = convergence.Text([series]), convergence.Summary([series])
    assert all(f"{error:.3e}" in text for norm in (series.energy, series.l2) for error in norm)
    assert [line.split()[-1] for line in text.splitlines()[2:]] == ["2.00", "2.00"]    # also where n grows by three
    assert f"| IP edge | triangle | 1 | 24 | {series.energy[-1]:.3e} | 1.00 | {series.l2[-1]:.3e} | 2.00 |" in summary
    slow = Series(energy=np.array([0.4, 0.3]))
    assert "1.00" not in convergence.Text([slow]).splitlines()[2]


def Lines(axes):
    return {line.get_label(): line for line in axes.lines if line.get_gid() != "slope"}


def test_convergence_figure_shows_every_series_and_the_slopes():
    series = [Series(label, order, constant=factor) for factor, label in enumerate(Variants(), 1) for order in (1, 2)]
    figure = ConvergenceFigure(series)
    for axes, norm, gain in zip(figure.axes, ("energy", "l2"), (0, 1)):
        drawn = [line for line in axes.lines if line.get_gid() != "slope"]
        assert len(drawn) == len(series)
        for line, one in zip(drawn, series):
            assert np.array_equal(line.get_ydata(), getattr(one, norm)) and np.allclose(line.get_xdata(), [1 / 4, 1 / 8])
        slopes = [np.array(line.get_xydata()) for line in axes.lines if line.get_gid() == "slope"]
        found = [float(np.diff(np.log(s[[0, 2], 1]))[0] / np.diff(np.log(s[[0, 2], 0]))[0]) for s in slopes]
        assert found == pytest.approx([1 + gain, 2 + gain])
        assert [text.get_text() for text in axes.texts] == [str(1 + gain), str(2 + gain)]
        assert "[length" in axes.get_xlabel() + axes.get_ylabel() and len(Lines(axes)) == 9
    assert [text.get_text() for text in figure.legends[0].get_texts()] == list(Variants())
    looks = {(line.get_color(), line.get_marker(), line.get_linestyle()) for line in Lines(figure.axes[0]).values()}
    assert len(looks) == 9


@pytest.mark.slow
def test_no_discontinuous_method_locks():
    """lam/mu from 1/2 to 5e5: the error stays, for every method of order 2."""
    for method in Variants(form="edge").values():
        if method.discontinuous:
            sweep = locking.Study(method, order=2, n=8, lam=(1, 1e3, 1e6))
            assert np.all((sweep.errors > sweep.errors[0] / 2) & (sweep.errors < 2 * sweep.errors[0])), sweep.label


@pytest.mark.slow
def test_locking_control_conforming_elements_of_order_one_lock():
    """They lose the factor, and refining the mesh does not help any more; it halves the error of interior penalty."""
    def Last(method, n):
        return locking.Study(method, n=n, lam=(1, 1e6)).errors[-1]

    assert locking.Study(Conforming(), n=16, lam=(1, 1e6)).factor > 2
    assert Last(Conforming(), 16) > 0.8 * Last(Conforming(), 8)
    assert Last(InteriorPenalty(), 16) == pytest.approx(Last(InteriorPenalty(), 8) / 2, rel=0.1)


@pytest.mark.slow
def test_locking_in_three_dimensions():
    """Hexahedra: two values of lam on one mesh of the cube, conforming elements against LDG."""
    assert locking.Study(LDG(), n=2, lam=(1, 1e6), cells="hex").factor < 2
    assert locking.Study(Conforming(), order=2, n=2, lam=(1, 1e6), cells="hex").factor > 2


def test_locking_figure_and_table_hold_the_errors():
    sweeps = [locking.Sweep(label, order, 8, (1.0, 1e6), np.array([1e-2, factor * 1e-2]) / order)
              for factor, label in enumerate(("IP edge", "H1"), 1) for order in (1, 2)]
    figure = LockingFigure(sweeps)
    for order, axes in enumerate(figure.axes, 1):
        for line, sweep in zip(axes.lines, [sweep for sweep in sweeps if sweep.order == order], strict=True):
            assert np.array_equal(line.get_ydata(), sweep.errors) and np.array_equal(line.get_xdata(), [0.5, 5e5])
        assert axes.get_title() == f"order k = {order}, h = 1/8"
    for text in (locking.Text(sweeps), locking.Markdown(sweeps)):
        assert "lam = 1e+06" in text and "2.000e-02" in text
        assert re.findall(r"(\d\.\d\d)(?: \|)?$", text, re.M) == ["1.00", "1.00", "2.00", "2.00"]


def Timed(label="IP edge", order=1, shift=0):
    """Errors 10^-1 ... 10^-4 in 1 ... 1000 seconds, times 10^shift."""
    powers = np.arange(4.0)
    return accuracy.Series(label, "triangle", order, 2 ** powers, 6 * 4 ** powers, 10 ** (powers + shift), 10 ** (-1 - powers))


def test_time_for_an_accuracy_is_interpolated_and_never_extrapolated():
    assert Timed().At(1e-3) == pytest.approx((100, 96), rel=1e-3)
    assert Timed().At(10 ** -2.5) == pytest.approx((10 ** 1.5, 48), rel=1e-3)
    assert Timed().At(0.2) is None and Timed().At(1e-5) is None


def test_accuracy_page_names_the_soonest():
    page = accuracy.Page([Timed(), Timed("H1", 2, shift=-1)], budget=2)
    assert "--budget 2 --page" in page and "more than 2 s" in page
    assert "* 1 %: H1, k = 2, is the soonest." in page and "0.001 %: " not in page
    assert "| IP edge | triangle | 1 | 10 s, 24 | 1e+02 s, 96 | - |" in page


def test_accuracy_study_refines_until_the_budget_is_spent():
    series = accuracy.Study(SmoothSlip(), InteriorPenalty(), order=2, budget=1e-9)
    assert series.n.tolist() == [2]
    series = accuracy.Study(SmoothSlip(), InteriorPenalty(), order=2, budget=0.5)
    assert len(series.n) > 2 and np.all(np.diff(series.n) > 0) and np.all(series.seconds > 0)
    assert np.log2(series.error[-2] / series.error[-1]) == pytest.approx(2, abs=0.3)
    with pytest.raises(ProblemError, match="budget is 0"):
        accuracy.Study(SmoothSlip(), InteriorPenalty(), budget=0)


@pytest.mark.slow
def test_accuracy_command_writes_table_figures_and_page(tmp_path, capsys):
    page = tmp_path / "docs" / "accuracy.md"
    arguments = f"accuracy --method h1 --order 1 2 --cells triangle --budget 0.01 --out {tmp_path} --page {page}"
    assert Main(arguments.split()) == 0
    output = capsys.readouterr().out
    assert output.count("H1      triangle") == 2 and "| H1 | triangle | 2 |" in page.read_text()
    for picture in (tmp_path / "accuracy_triangle.png", tmp_path / "docs" / "images" / "accuracy_triangle.png"):
        assert picture.stat().st_size > 10_000


@pytest.mark.slow
def test_convergence_command_prints_what_the_study_finds(tmp_path, capsys):
    arguments = "convergence --method ldg --form lifting --penalty 2 --order 1 --n 1 2 --cells triangle hex --out".split()
    assert Main([*arguments, str(tmp_path)]) == 0
    output = capsys.readouterr().out
    found = [convergence.Study(SmoothSlip(dim=dim), LDG(form="lifting", penalty=2), order=1, n=(1, 2), cells=cells)
             for dim, cells in ((2, "triangle"), (3, "hex"))]
    assert convergence.Text(found) in output
    other = convergence.Study(SmoothSlip(), LDG(form="lifting"), n=(1, 2))
    assert f"{other.energy[-1]:.3e}" not in output                         # the penalty has reached the method
    assert {path.name for path in tmp_path.iterdir()} == {"convergence.txt", "convergence_triangle.png", "convergence_hex.png"}


@pytest.mark.slow
def test_locking_command_prints_what_the_study_finds(tmp_path, capsys):
    assert Main(["locking", *"--method h1 --order 1 2 --n 4 --lam 1 1e4 --out".split(), str(tmp_path)]) == 0
    sweeps = [locking.Study(Conforming(), order=order, n=4, lam=(1, 1e4)) for order in (1, 2)]
    output = capsys.readouterr().out
    other = locking.Study(InteriorPenalty(), n=4, lam=(1, 1e4))
    assert locking.Text(sweeps) in output and f"{other.errors[1]:.3e}" not in output
    assert {path.name for path in tmp_path.iterdir()} == {"locking.txt", "locking.png"}


@pytest.mark.parametrize("arguments, culprit", [
    ("convergence --method dg", "no method 'dg'; choose all or one of ip, bassi, brezzi, ldg, ldg0, nipg, iipg, wopsip, h1"),
    ("convergence --form both", "form is 'both'; choose edge or lifting"),
    ("convergence --method h1 --form edge", "form does not apply to method 'h1'"),
    ("convergence --method h1 --penalty 3", "penalty does not apply to method 'h1'"),
    ("convergence --n 8", "n is [8]; an order needs at least two sizes"),
    ("convergence --n 8 4", "n is [8, 4]; an order needs at least two sizes that increase"),
    ("convergence --cells triangle cube", "cells is 'cube'"), ("convergence --order 0", "'0' is not a positive integer"),
    ("locking --lam 1", "lam is [1.0]; a comparison needs at least two values"),
    ("locking --lam -1 1", "lam is -1"), ("locking --lam stiff", "'stiff' is not a number"),
    ("table3 --method dg", "no method 'dg'")])
def test_a_mistake_is_one_line_and_exit_code_2(arguments, culprit, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, message = ExitCode(arguments), capsys.readouterr().err.splitlines()
    assert code == 2 and culprit in message[-1] and len([line for line in message if line.startswith("ngdgc")]) == 1


def test_a_study_that_does_not_converge_is_one_line_and_exit_code_1(tmp_path, capsys, monkeypatch):
    """A foundation too stiff for the explicit iteration."""
    monkeypatch.setattr("ngdgc.exact.SmoothSlip", lambda dim: SmoothSlip(stiffness=1e4, dim=dim))
    assert Main(["convergence", *"--method h1 --n 2 4 --out".split(), str(tmp_path)]) == 1
    message = capsys.readouterr().err.splitlines()
    assert "cannot converge for any rho" in message[-1] and not list(tmp_path.iterdir())


def test_a_bad_argument_of_a_study_is_refused():
    with pytest.raises(ProblemError, match="at least two sizes"):
        convergence.Study(SmoothSlip(), InteriorPenalty(), n=(4,))
    with pytest.raises(ProblemError, match="at least two values"):
        locking.Study(InteriorPenalty(), lam=(1,))
