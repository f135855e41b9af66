"""Mistakes on the command line, as in `mistakes`; what the user reads is what the parser shows or the error's message."""

from pathlib import Path
from unittest.mock import patch

from ngdgc import cli
from ngdgc.commands.check import Looker
from ngdgc.commands.ranks import CheckOptions
from ngdgc.studies.atlas import solvers as atlas
from ngdgc.cases import example_4_1

EXAMPLE = Path(example_4_1.__file__).read_text(encoding="utf-8")


def Typed(words, *blocked):
    """The mistake of typing this command in a folder; OUT is the folder, where names `blocked` are folders already."""
    def Mistake(folder):
        for name in blocked:
            (folder / name).mkdir()
        (folder / "file").write_text("")
        options = cli._Parser().parse_args(words.replace("OUT", str(folder)).split())
        options.command(options)
    return Mistake


def Changed(old, new, name="case.py"):
    """The mistake of running an example in which a piece of text was replaced."""
    assert old in EXAMPLE

    def Mistake(folder):
        (folder / name).write_text(EXAMPLE.replace(old, new), encoding="utf-8")
        Typed(f"run OUT/{name} --n 2 --out OUT/results")(folder)
    return Mistake


def Checked(text):
    """The mistake of checking a case with this text."""
    def Mistake(folder):
        (folder / "case.py").write_text(text, encoding="utf-8")
        Typed("check OUT/case.py --out OUT/results")(folder)
    return Mistake


def Led(text, *options):
    """The mistake of leading a case with this function History along its loads."""
    def Mistake(folder):
        (folder / "case.py").write_text(f"def Main():\n    pass\n\n\n{text}", encoding="utf-8")
        Typed(" ".join(["run OUT/case.py --history --out OUT/results", *options]))(folder)
    return Mistake


def WithoutProblem(folder):
    (folder / "case.py").write_text("def Main():\n    pass\n", encoding="utf-8")
    Typed("stability OUT/case.py")(folder)


def NoAtlas(folder):
    """One row, whose table is gone from under it."""
    def Study(sweeps, **options):
        yield "a row that no file takes"

    full = OSError(28, "No space left")
    with patch.object(atlas, "Study", Study), patch("ngdgc.studies.atlas.page.Table.Add", side_effect=full), \
            patch("ngdgc.commands.studies.Write"), patch("ngdgc.studies.atlas.page.Text"):
        Typed("atlas --quick --out OUT")(folder)


RUN = "run example_4_1 --n 2 --out OUT"
COMMANDS = [
    (Typed("run exmaple_4_1"), "no case 'exmaple_4_1' | neither a file nor one of | give one of them or a file"),
    (Changed("import", "import", "case.txt"), "case.txt is not a Python file | whose name ends in .py | give one"),
    (Changed("import CF, y", "import CF, yy"), "case.py cannot be loaded | cannot import name 'yy' | mend the file"),
    (Changed("def Main(", "def Mian("), "case.py has no function | Main(method=..., order=..., n=...) | write it"),
    (Changed("callback=None", "silent=True"), "Main of | unexpected keyword argument 'callback' | needs the keywords method"),
    (Changed("return solver.Solve(disc, callback=callback)", "pass"),
     "returned NoneType | ContactSolution | let it return what the solver"),
    (WithoutProblem, "case.py has no functions | Problem() and Mesh(n) | write them"),
    (lambda _: CheckOptions(cli._Parser().parse_args("run example_4_2 --refine 1 --error 0.1".split())),
     "--error does not go with --refine | spreads the mesh over processes | leave one of them out"),
    (Led(""), "case.py has no function History(method= | what SolveHistory returns | leave --history out"),
    (Led("def History(*, callback=None):\n    pass\n"), "History of | has no keyword 'method' | needs method and callback"),
    (Led("def History(*, method, callback):\n    pass\n"), "returned NoneType | a LoadHistory | what SolveHistory returns"),
    (Led("def History(*, method, callback):\n    pass\n", "--error 0.1"), "--error does not apply | one mesh | leave one"),
    (Typed("rnu example_4_1"), "invalid choice: 'rnu' | choose one of new, check, run | did you mean 'run'"),
    (Typed("new block"), "'block' is no name of a case | one that ends in .py | give"),
    (Typed("new OUT/file.py", "file.py"), "file.py is there already and is kept | another name | give"),
    (lambda _: Looker().Solve(None), "the case is looked at | and not solved here | take ngdgc run"),
    (Checked("def Main(*, solver, **_):\n    return 1\n"), "was solved without the solver | call solver.Solve(disc | there"),
    (Checked("def Main():\n    return 1\n"), "cannot be called: | unexpected keyword argument | it needs the keywords method"),
    (Typed("mesh OUT/part.step"), "part.step is no STEP file | or is not there | give one that a CAD program has written"),
    (Typed("mesh OUT/part.msh --maxh 1"), "--maxh | does not apply to | leave it out"),
    (Typed("mesh OUT/file"), "file is | give the name of a mesh | .msh of Gmsh"),
    (Typed("run example_4_1 --colour red"), "unrecognized arguments: | --colour red | see ngdgc run --help"),
    (Typed("run example_4_1 --n many"), "--n: 'many' is not | a positive integer | give for example 4"),
    (Typed("run example_4_1 --tol big"), "--tol: 'big' is not | a number | give for example 0.5"),
    (Typed("run example_4_1 --out OUT/file"), "cannot write into | file: File exists | choose another --out"),
    (Typed("run example_4_1 --n 2 --out OUT", "report.txt"), "cannot write into | Is a directory | choose another --out"),
    (Typed(f"{RUN} --method ipp"), "no method 'ipp' | one of ip, bassi | choose"),
    (Typed(f"{RUN} --method h1 --form lifting"), "--form | does not apply to method 'h1' | leave it out"),
    (Typed(f"{RUN} --solver best"), "no solver 'best' | one of auto, newton, uzawa | choose"),
    (Typed(f"{RUN} --rho 1"), "--rho | does not apply to solver 'auto' | leave it out"),
    (Typed(f"{RUN} --error 0.1 --solver newton"), "--error | does not apply to solver 'newton' | leave one of them out"),
    (Typed("run greco_plate --n 2 --plane strain --out OUT"), "--plane | does not apply to this case | leave it out"),
    (Typed("compare example_4_1 --n 2 --method ipp --out OUT"), "no method 'ipp' | some of ip, bassi | choose"),
    (Typed("convergence --method ipp"), "no method 'ipp' | all or one of ip, bassi | choose"),
    (Typed("convergence --form both"), "form is 'both' | edge or lifting | choose"),
    (Typed("convergence --method h1 --form edge"), "form | does not apply to method 'h1' | leave it out"),
    (Typed("locking --method ip --form edge --order 1 --n 1 --lam 1 2 --out OUT", "locking.txt"),
     "cannot write into | Is a directory | choose another --out"),
    (Typed("accuracy --method ip --order 1 --cells triangle --budget 1e-9 --out OUT --page OUT/page", "page"),
     "cannot write | page: Is a directory | choose another --page"),
    (NoAtlas, "cannot write into | No space left | choose another --out"),
    (Typed("atlas --quick --out OUT --page OUT/page", "page"),
     "cannot write | page: Is a directory | choose another --page"),
    (Typed("table3 --n 40"), "n is 40 | the reference mesh must refine | give a larger multiple of 32"),
    (Typed("table3 --page OUT/page", "page"), "cannot write | page: Is a directory | choose another --page"),
    (Typed("sweep --count 1 --out OUT", "sweep.jsonl"), "cannot write into | Is a directory | choose another --out"),
    (Typed("sweep --count 3 --dofs 10 --out OUT"), "dofs is 10 | too few for a mesh with | give more"),
    (Typed("grid --geometry ball --out OUT"), "no geometry 'ball' | one of 4.1, 4.2 | choose"),
    (Typed("bench ranks --rows OUT/file2 --out OUT"), "file2' does not have rows | of an earlier run | give its scaling.json"),
    (Typed("bench --only nothing --out OUT"), "no bench has 'nothing' in its name | among | choose")]
