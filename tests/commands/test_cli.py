"""The command line as a user types it: results, one-line errors, exit codes, interruption."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from checks import ExitCode

from ngdgc import Conforming, ContactSolution
from ngdgc.cases import example_4_1
from ngdgc.commands.casefiles import CaseFiles, LoadCase
from ngdgc.cli import Main

COMMAND = Path(sys.executable).with_name("ngdgc")
CASE = Path(__file__).parents[2] / "cases" / "example_4_1.py"
FILES = {"report.txt", "report.json", "solution.html", "solution.vtu", "contact.vtu", "setting.png", "deformed.png",
         "contact.png", "law.png", "zones.png", "history.png", "error.png", "vonmises.png"}


def Command(*arguments, **options):
    return subprocess.run([COMMAND, *map(str, arguments)], capture_output=True, text=True, timeout=120, **options)


@pytest.mark.slow
def test_run_leaves_everything(tmp_path):
    out = tmp_path / "deep" / "results"
    done = Command("run", CASE, "--method", "ip", "--n", 4, "--order", 1, "--out", out)
    assert done.returncode == 0 and done.stderr == ""
    assert "iteration     1" in done.stdout and "Contact boundary" in done.stdout and str(out) in done.stdout
    assert {path.name for path in out.iterdir()} == FILES | {"solution"}
    numbers = json.loads((out / "report.json").read_text())
    solution = example_4_1.Main(n=4)
    assert numbers["elastic_energy"] == pytest.approx(solution.energy, rel=1e-12)
    # What was solved, and what was not there; a solution of a script has no case.
    assert (numbers["case"], numbers["dirichlet"], numbers["traction"]) == (
        "example_4_1", {"right": "(0, 0)"}, {"left": "(200*(5 - y), -190)"})
    assert (numbers["roller"], numbers["bodyforce"]) == ({}, None) and "TrescaFriction" in numbers["foundations"][0]
    assert solution.ToJSON()["case"] is None
    assert [level["iterations"] for level in numbers["levels"]] == [numbers["iterations"]]
    loaded = ContactSolution.Load(out / "solution", example_4_1.Problem())
    assert loaded.displacement == pytest.approx(solution.displacement, abs=1e-12)


@pytest.mark.slow
def test_an_error_is_reached_on_meshes_that_follow_from_it(quick, tmp_path, capsys):
    """What is kept comes back on the refined mesh."""
    assert Main(["run", "example_4_1", *"--n 2 --order 2 --error 0.1 --tol 1e-6".split(), "--out", str(tmp_path)]) == 0
    shown, numbers = capsys.readouterr().out, json.loads((tmp_path / "report.json").read_text())
    levels, forces = numbers["levels"], numbers["estimated_quantities"]["force bottom"]
    assert 0 < max(map(abs, forces["error"])) < 0.1 * max(map(abs, forces["value"]))
    assert " +- " in (tmp_path / "report.txt").read_text()
    assert len(levels) > 1 and levels[-1]["error"] <= 0.1 < levels[-2]["error"] and levels[0]["elements"] == 8
    assert shown.count("unknowns: estimated error") == len(levels) and f"estimated error {levels[-1]['error']:.2g}" in shown
    loaded = ContactSolution.Load(tmp_path / "solution", example_4_1.Problem())
    assert loaded.disc.mesh.ne == levels[-1]["elements"] and [level.error for level in loaded.levels] == [
        level["error"] for level in levels]


@pytest.mark.slow
def test_every_option_reaches_the_solution(quick, tmp_path, capsys, monkeypatch):
    assert Main(["run", "example_4_1", *"--method ldg --form lifting --penalty 0.5 --n 2".split(), "--out", str(tmp_path)]) == 0
    assert json.loads((tmp_path / "report.json").read_text())["options"] == "LDG(penalty=0.5, form='lifting')"
    monkeypatch.undo()      # with all pictures
    words = "--method h1 --n 3 --order 2 --plane strain --cells quad --solver uzawa --rho 200 --tol 1e-6 --scale 0.5"
    assert Main(["run", "example_4_2", *words.split(), "--out", str(tmp_path)]) == 0
    capsys.readouterr()
    numbers = json.loads((tmp_path / "report.json").read_text())
    assert (numbers["method"], numbers["order"], numbers["elements"], numbers["dofs"]) == ("H1", 2, 9, 98)
    assert numbers["solver"] == "UzawaSolver(tol=1e-06, maxiter=10000, rho=200.0, normal='explicit', acceleration=None)"
    assert (tmp_path / "deformed-scaled.png").exists()
    case = LoadCase("example_4_2")
    strain, stress = (case.Main(n=3, order=2, plane=plane, cells="quad", method=case.InteriorPenalty()).energy
                      for plane in ("strain", "stress"))
    assert abs(numbers["elastic_energy"] - strain) < abs(numbers["elastic_energy"] - stress)


@pytest.mark.slow
def test_a_case_has_its_own_order_and_says_what_it_should_give(quick, tmp_path, capsys):
    """Order 2 without --order, and the table of its Compare; an example of the paper has order 1, and nothing of the kind."""
    assert Main(["run", "greco_plate", "--method", "h1", "--n", "4", "--out", str(tmp_path)]) == 0
    assert json.loads((tmp_path / "report.json").read_text())["order"] == 2
    table, case = capsys.readouterr().out.split("expected")[1], LoadCase("greco_plate")
    for _, computed, expected in case.Compare(case.Main(n=4, method=Conforming())):
        assert f"{computed:.6g}" in table and f"{expected:.6g}" in table
    assert Main(["run", "example_4_1", "--method", "h1", "--n", "2", "--out", str(tmp_path)]) == 0
    assert json.loads((tmp_path / "report.json").read_text())["order"] == 1 and "expected" not in capsys.readouterr().out


@pytest.mark.parametrize("arguments, culprit", [
    (["run", "exmaple_4_1"], "no case 'exmaple_4_1': neither a file nor one of block_on_two_joints, bolt_and_washer"),
    (["run", "cases/missing.py"], "no case 'cases/missing.py'"), (["run", "elsewhere/example_4_1.py"], "no case 'elsewhere"),
    (["run", CASE, "--method", "ipp"], "no method 'ipp'; choose one of ip, bassi, brezzi, ldg, ldg0, nipg, iipg, wopsip, h1"),
    (["run", CASE, "--n", "many"], "'many' is not a positive integer"),
    (["run", CASE, "--n", "0"], "'0' is not a positive integer"),
    (["run", CASE, "--order", "-1"], "'-1' is not a positive integer"),
    (["run", CASE, "--rho", "big"], "'big' is not a number"),
    (["run", CASE, "--solver", "uzawa", "--rho", "-1"], "rho is -1.0"),
    (["run", CASE, "--rho", "1"], "--rho does not apply to solver 'auto'"),
    (["run", CASE, "--solver", "newton", "--rho", "1"], "--rho does not apply to solver 'newton'"),
    (["run", CASE, "--solver", "best"], "no solver 'best'; choose one of auto, newton, uzawa"),
    (["run", CASE, "--penalty", "0"], "penalty is 0.0"),
    (["run", CASE, "--penalty", "2"], "penalty=2 loses coercivity"),
    (["run", CASE, "--method", "h1", "--penalty", "3"], "--penalty does not apply to method 'h1'"),
    (["run", CASE, "--form", "both"], "form is 'both'"),
    (["run", CASE, "--method", "h1", "--form", "lifting"], "--form does not apply to method 'h1'"),
    (["run", CASE, "--tol", "0"], "tol is 0.0"), (["run", CASE, "--plane", "curved"], "plane='curved'"),
    (["run", CASE, "--cells", "hex"], "cells is 'hex'"), (["run", CASE, "--scale", "nan"], "'nan' is not a number"),
    (["run", CASE, "--colour", "red"], "unrecognized arguments: --colour red"), (["rnu", CASE], "invalid choice: 'rnu'"),
    ([], "COMMAND"), (["run"], "case"), (["table3", "--n", "40"], "n is 40; the reference mesh must refine")])
def test_a_mistake_is_one_line_and_exit_code_2(arguments, culprit, tmp_path, capsys):
    try:
        code = Main([*map(str, arguments), *(["--out", str(tmp_path)] if "run" in arguments else [])])
    except SystemExit as stop:
        code = stop.code
    message = capsys.readouterr().err
    assert code == 2 and culprit in message and message.count("\n") == 1 and "Traceback" not in message


@pytest.mark.parametrize("words, meant", [
    ("run exmaple_4_1", "'example_4_1'"), ("run hertz", "'hertz_line'"), ("run cases/machine_prat.py", "'machine_part'"),
    ("run example_4_1 --method bassy", "'bassi'"), ("run example_4_1 --solver newtn", "'newton'"),
    ("compare example_4_1 --method ip ldq", "'ldg'"), ("convergence --method brezi", "'brezzi'"),
    ("convergence --cells trianlge", "'triangle'"), ("grid --geometry bock", "'block'"), ("rnu example_4_1", "'run'"),
    ("Convergense", "'convergence'"), ("bench asembly", "'assembly'"), ("run example_4_1 --mehtod ip", "'--method'"),
    ("run example_4_1 --oder=2", "'--order'"), ("locking --lamda 3", "'--lam'")])
def test_a_mistyped_name_is_answered_with_the_one_that_is_meant(words, meant, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert ExitCode(words) == 2
    message = capsys.readouterr().err
    assert f"(did you mean {meant}?)" in message and message.count("\n") == 1
    # What an option is for stands in the help of its command.
    assert ("--" not in meant) or f"(see ngdgc {words.split()[0]} --help)" in message


def test_nothing_is_meant_by_what_is_near_to_nothing(capsys):
    for words in ("run example_4_1 --method xyz", "run example_4_1 --zzz 3", "quux"):
        assert ExitCode(words) == 2 and "did you mean" not in capsys.readouterr().err


@pytest.mark.slow
def test_names_are_found_in_any_case(quick, tmp_path):
    words = "run Example_4_1 --method LDG --form Lifting --solver Newton --cells Quad --plane STRAIN --n 2 --out"
    assert Main([*words.split(), str(tmp_path)]) == 0
    numbers = json.loads((tmp_path / "report.json").read_text())
    assert numbers["options"] == "LDG(form='lifting')" and numbers["solver"].startswith("SemismoothNewtonSolver")
    assert numbers["elements"] == 4 and "plane='strain'" in numbers["material"]


def Variant(tmp_path, old, new):
    """The example with a piece of its text replaced."""
    text = CASE.read_text()
    assert old in text
    path = tmp_path / "variant.py"
    path.write_text(text.replace(old, new))
    return path


@pytest.mark.slow
@pytest.mark.parametrize("old, new, culprit", [
    ('"right": CF((0, 0))', '"rihgt": CF((0, 0))', "dirichlet region 'rihgt' matches no boundary"),
    ("stiffness=450", "stiffness=-450", "stiffness is -450"), ("def Main(", "def Mian(", "has no function Main"),
    ("import CF, y", "import CF, yy", "cannot be loaded"), ("gap=0.05", "gap=", "cannot be loaded"),
    ("return solver.Solve(disc, callback=callback)", "pass", "returned NoneType, not a ContactSolution"),
    ("callback=None", "silent=True", "cannot be called: got an unexpected keyword argument"),
    ("def Mesh", "1 / 0\n\n\ndef Mesh", "cannot be loaded: ZeroDivisionError")])
def test_a_mistake_in_a_case_is_one_line(old, new, culprit, tmp_path, capsys):
    assert Main(["run", str(Variant(tmp_path, old, new)), "--n", "2", "--out", str(tmp_path / "out")]) == 2
    message = capsys.readouterr().err
    assert culprit in message and message.count("\n") == 1 and "Traceback" not in message


def test_unwritable_folder_is_one_line(tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert Main(["run", str(CASE), "--n", "2", "--out", str(tmp_path / "file")]) == 2
    assert "cannot write into" in capsys.readouterr().err


@pytest.mark.slow
def test_not_converged_writes_what_was_computed(tmp_path, capsys):
    stiff = Variant(tmp_path, "stiffness=450", "stiffness=4500")
    assert Main(["run", str(stiff), *"--n 4 --solver uzawa --out".split(), str(tmp_path / "out")]) == 1
    message = capsys.readouterr().err
    assert message.count("\n") == 1 and "cannot converge for any rho" in message
    assert {path.name for path in (tmp_path / "out").iterdir()} == FILES - {"error.png"} | {"solution"}
    assert "NOT CONVERGED" in (tmp_path / "out" / "report.txt").read_text()


@pytest.mark.slow
def test_interrupting_leaves_what_was_computed(tmp_path):
    """Ctrl-C while an iteration with a tiny rho crawls."""
    arguments = ["run", str(CASE), *"--n 4 --solver uzawa --rho 1e-7 --maxiter 100000000 --out".split(), str(tmp_path)]
    process = subprocess.Popen([COMMAND, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                               # A shell without job control starts background commands with SIGINT ignored.
                               preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler))
    while "iteration    50" not in process.stdout.readline():
        assert process.poll() is None
    os.kill(process.pid, signal.SIGINT)
    output, errors = process.communicate(timeout=60)
    assert process.returncode == 130 and "interrupted after" in errors and "Traceback" not in errors
    assert FILES - {"error.png"} <= {path.name for path in tmp_path.iterdir()}
    numbers = json.loads((tmp_path / "report.json").read_text())
    assert numbers["converged"] is False and numbers["iterations"] >= 50 and numbers["elastic_energy"] > 0


def test_help_is_enough_to_find_ones_way(capsys):
    for arguments, words in ((["--help"], ("run", "cases", "table3", "convergence", "locking", "cases/example_4_1.py",
                                           "exit codes")),
                             (["table3", "--help"], ("--method", "--n", "--page")),
                             (["convergence", "--help"], ("--method", "--form", "--order", "--cells", "--n", "--out")),
                             (["locking", "--help"], ("--method", "--form", "--order", "--lam", "--n", "--out")),
                             (["run", "--help"], ("--method", "--order", "--n", "--out", "--rho", "--scale"))):
        with pytest.raises(SystemExit) as stop:
            Main(arguments)
        text = capsys.readouterr().out
        assert stop.value.code == 0 and all(word in text for word in words)


def test_cases_are_listed_with_what_they_are(capsys):
    assert Main(["cases"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == list(CaseFiles()) and all(len(line.split()) > 4 for line in lines)
