"""Type hints: a checker takes a script as a user writes it, refuses wrong ones by name, and has nothing against the package."""

import configparser
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SCRIPT = """\
from ngsolve import CF, Mesh, y
from ngdgc import (BassiEtAl, Conforming, ContactProblem, ContactSolution, CoulombFriction, Discretization, Foundation,
                   HookeMaterial, InteriorPenalty, NestedNewtonSolver, NormalCompliance, NotConvergedError, TrescaFriction,
                   UzawaSolver)
from ngdgc.meshes import RectangleMesh
from ngdgc.solution.history import Step


def Show(step: Step) -> None:
    print(step.number, step.residual)


class Own:
    def Pressure(self, r):
        return 3 * r

    def PressureDerivative(self, r):
        return 3.0


foundation = Foundation("bottom", NormalCompliance(stiffness=450, exponent=1), friction=CoulombFriction(0.3 + y), gap=0.05)
problem = ContactProblem(HookeMaterial(E=2000, nu=0.4, plane="stress"), [foundation, Foundation("top", Own())],
                         dirichlet={"right": CF((0, 0))}, roller={"left": 0}, traction={"left": (0, -190)})
mesh: Mesh = RectangleMesh(4, cells="quad")
solutions: dict[str, ContactSolution] = {}
for method in (InteriorPenalty(penalty=30), BassiEtAl(form="lifting"), Conforming()):
    disc = Discretization(problem, method, mesh, order=2)
    try:
        solutions[method.name] = disc.Solve(callback=Show)
    except NotConvergedError as error:
        print(error)
solution = UzawaSolver(rho="auto", normal="implicit").Solve(disc, callback=Show)
NestedNewtonSolver(tol=1e-8, coarser=[mesh]).Solve(disc)
print(problem.foundation[0].gap, problem.dirichlet["right"], problem.dim, disc.load.shape, disc.symmetric, solution.Report())
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """One for all scripts: what mypy reads of the package and of others it reads once."""
    return tmp_path_factory.mktemp("scripts")


def Checked(folder, scripts):
    """What mypy has to say of scripts, without the configuration of the package: (exit code, output)."""
    for name, script in scripts.items():
        (folder / f"{name}.py").write_text(script)
    (folder / "mypy.ini").write_text("[mypy]\nignore_missing_imports = True\ncheck_untyped_defs = True\n")
    names = [f"{name}.py" for name in scripts]
    done = subprocess.run([sys.executable, "-P", "-m", "mypy", "--config-file", "mypy.ini", "--cache-dir", ".cache", *names],
                          cwd=folder, capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


@pytest.mark.slow
def test_a_script_as_users_write_it_is_right(folder):
    code, output = Checked(folder, {"script": SCRIPT})
    assert code == 0, output


WRONG = {
    "stiffness=450": ("stiffness='soft'", '"stiffness" to "NormalCompliance" has incompatible type "str"'),
    "CoulombFriction(0.3 + y)": ("CoulombFriction()", 'Missing positional argument "coefficient"'),
    "friction=CoulombFriction(0.3 + y)": ("friction=0.3", '"friction" to "Foundation" has incompatible type "float"'),
    'Own()': ("Step", '"Foundation" has incompatible type "type[Step]"'),
    "E=2000": ("E='steel'", '"E" to "HookeMaterial" has incompatible type "str"'),
    "nu=0.4": ("poisson=0.4", 'Unexpected keyword argument "poisson" for "HookeMaterial"'),
    '{"left": 0}': ("'left'", '"roller" to "ContactProblem" has incompatible type "str"'),
    "(problem, method, mesh, order=2)": ("(problem, InteriorPenalty, mesh)", 'incompatible type "type[InteriorPenalty]"'),
    "order=2)": ("order=2.5)", '"order" to "Discretization" has incompatible type "float"'),
    "penalty=30": ("penalty='large'", "\"penalty\" to \"InteriorPenalty\" has incompatible type \"Literal['large']\""),
    'form="lifting"': ('form="weak"', "\"form\" to \"BassiEtAl\" has incompatible type \"Literal['weak']\""),
    'normal="implicit"': ("implicit=True", 'Unexpected keyword argument "implicit" for "UzawaSolver"'),
    "disc.Solve(callback=Show)": ("disc.Solve(callback=3)",
                                  '"callback" to "Solve" of "Discretization" has incompatible type "int"'),
    "coarser=[mesh]": ("coarser=4", '"coarser" to "NestedNewtonSolver" has incompatible type "int"'),
    "solution.Report()": ("solution.Raport()", '"ContactSolution" has no attribute "Raport"')}


@pytest.mark.slow
def test_mistakes_are_named(folder):
    """Each alone in a script that was right: that is the only complaint, on its line."""
    scripts = {f"wrong{number}": SCRIPT.replace(right, wrong, 1) for number, (right, (wrong, _)) in enumerate(WRONG.items())}
    _, output = Checked(folder, scripts)
    for (name, script), (_, complaint) in zip(scripts.items(), WRONG.values()):
        (line,) = (number for number, pair in enumerate(zip(SCRIPT.split("\n"), script.split("\n")), 1) if pair[0] != pair[1])
        errors = [text for text in output.split("\n") if text.startswith(f"{name}.py:") and ": error: " in text]
        assert len(errors) == 1 and errors[0].startswith(f"{name}.py:{line}: ") and complaint in errors[0], (complaint, errors)


@pytest.mark.slow
def test_the_package_is_consistent_with_its_own_hints(tmp_path):
    done = subprocess.run([sys.executable, "-P", "-m", "mypy", "--cache-dir", str(tmp_path), "ngdgc"], cwd=ROOT,
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


FLAGS = "disallow_untyped_defs", "disallow_incomplete_defs", "check_untyped_defs", "disallow_any_generics"


def Strict(module, sections):
    """Does mypy's configuration let no function of a module, or package, without types pass?  The longest pattern counts."""
    patterns = sorted((name for title in sections.sections() for name in title.removeprefix("mypy-").split(",")), key=len)
    settings = {}
    for name in patterns:
        if name in ("mypy", f"ngdgc.{module}") or name.endswith(".*") and f"ngdgc.{module}.".startswith(name[:-1]):
            settings |= dict(next(sections[title] for title in sections.sections()
                                  if name in title.removeprefix("mypy-").split(",")))
    return all(settings.get(flag) == "True" for flag in FLAGS)


def test_all_but_the_cases_is_checked_strictly():
    """The test above is that of mypy; here, that its configuration asks for it.  Cases are scripts as users write them."""
    sections = configparser.ConfigParser()
    sections.read(ROOT / ".mypy.ini")
    modules = {path.relative_to(ROOT / "ngdgc").with_suffix("").parts[0] for path in (ROOT / "ngdgc").rglob("*.py")}
    assert {"blocks", "methods", "solvers", "cli"} <= modules
    assert [module for module in sorted(modules - {"cases"}) if not Strict(module, sections)] == []
    assert not Strict("cases", sections)       # control


def test_the_hints_are_shipped():
    import ngdgc
    assert (Path(ngdgc.__file__).parent / "py.typed").exists()
