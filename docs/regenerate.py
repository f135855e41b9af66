"""Write everything in the documentation that is computed: `python docs/regenerate.py`, half an hour on two cores.

images/*.png, examples.md, convergence.md, table3.md, stability.md, atlas.md and atlas.csv; nothing in them is typed by hand.
"""

from dataclasses import replace
from itertools import product
from pathlib import Path

from ngdgc import (Conforming, Discretization, EstimateContraction, InteriorPenalty, NormalCompliance, NotConvergedError,
                   UzawaSolver)
from ngdgc.studies import convergence, locking, stability as stabilitystudy, table3
from ngdgc.studies.atlas import solvers as atlas, page as atlaspage
from ngdgc.cases import example_4_1, example_4_2
from ngdgc.exact import SmoothSlip
from ngdgc.plots import ContactFigure, ConvergenceFigure, DeformedFigure, LockingFigure, SettingFigure
from ngdgc.methods.variants import Variants

DOCS = Path(__file__).parent
EXAMPLES = {"4.1": (example_4_1, (0, 0.05)), "4.2": (example_4_2, (0, 0))}
# (cells, form or None for both, orders, sizes): in 3D one form and small meshes, the matrices are dense there.
STUDIES = (("triangle", None, (1, 2, 3, 4), (3, 6, 12)), ("quad", None, (1, 2), (4, 8, 16)), ("tet", "edge", (1,), (2, 4, 6)),
           ("hex", "lifting", (1,), (2, 4, 6)), ("prism", "edge", (1,), (2, 4, 6)))
METHODS = {"IP, penalty='auto'": InteriorPenalty(), "IP, penalty=30": InteriorPenalty(penalty=30), "H1": Conforming()}


def Images():
    (DOCS / "images").mkdir(exist_ok=True)
    for name, (case, _) in EXAMPLES.items():
        solution = case.Main(n=16)
        for kind, figure in (("setting", SettingFigure(solution.disc)), ("deformed", DeformedFigure(solution)),
                             ("contact", ContactFigure(solution))):
            figure.savefig(DOCS / "images" / f"example_{name.replace('.', '_')}_{kind}.png", dpi=110)


def Values(name):
    """Rows (method, plane, order, energy, int p_n, corner, iterations, contraction number) of an example at n = 32."""
    case, corner = EXAMPLES[name]
    solver = UzawaSolver()
    reference = (case.Main(method=Conforming(), order=4, n=64, plane=plane, solver=solver) for plane in ("strain", "stress"))
    for plane, solution in zip(("strain", "stress"), reference):
        yield "H1, n = 64", plane, solution, corner
    for (label, method), plane, order in product(METHODS.items(), ("strain", "stress"), (1, 3)):
        yield label, plane, case.Main(method=method, order=order, n=32, plane=plane, solver=solver), corner


def Limit(name):
    """Rows (factor, outcome) for multiples of the stiffness at which the contraction number is 1."""
    case, _ = EXAMPLES[name]
    problem = case.Problem("strain")
    foundation = problem.foundation[0]
    solution = case.Main(plane="strain")
    limit = foundation.compliance.stiffness / EstimateContraction(solution.disc, solution.penetration).normal
    yield "limit", f"k_n = {limit:.0f}"

    for factor in (0.5, 0.9, 1.2, 10):
        stiffer = replace(problem, foundation=replace(foundation, compliance=NormalCompliance(factor * limit)))
        try:
            steps = len(UzawaSolver().Solve(Discretization(stiffer, InteriorPenalty(), case.Mesh(16), order=1)).history)
            yield f"{factor} x", f"converged, {steps} iterations"
        except NotConvergedError as error:
            yield f"{factor} x", f"recognised as cycling after {len(error.history)} iterations"


def ExamplesPage():
    lines = ["# The two examples of the paper", "", "Written by `python docs/regenerate.py`.", ""]
    for name in EXAMPLES:
        stem = f"images/example_{name.replace('.', '_')}"
        lines += [f"## Example {name}", "", f"![setting]({stem}_setting.png)", "", f"![deformed]({stem}_deformed.png)", "",
                  f"![contact]({stem}_contact.png)", "",
                  "Mesh 1/32, diagonals `/`; the first two rows are the reference, H1 of order 4 on the mesh 1/64.", "",
                  "| method | plane | order | elastic energy | int p_n | corner displacement | Uzawa iterations | "
                  "abs(p_n' S_nn) |",
                  "|---|---|---|---|---|---|---|---|"]
        for label, plane, solution, corner in Values(name):
            number = EstimateContraction(solution.disc, solution.penetration).normal
            u = solution.At(*corner)
            lines.append(f"| {label} | {plane} | {solution.disc.order} | {solution.energy:.3f} | {solution.normalforce:.4f} | "
                         f"({u[0]:.4f}, {u[1]:.4f}) | {len(solution.history)} | {number:.3f} |")
        lines += ["", "Where the explicit iteration ends (plane strain, IP, mesh 1/16):", "", "| k_n | outcome |", "|---|---|",
                  *(f"| {factor} | {outcome} |" for factor, outcome in Limit(name)), ""]
    return "\n".join(lines)


def Convergence(cells, form, orders, sizes):
    """All methods on one kind of cells: the figure, and lines of the page."""
    exact = SmoothSlip(dim=2 if cells in ("triangle", "quad") else 3)
    series = [convergence.Study(exact, method, order=order, n=sizes, cells=cells)
              for method in Variants(form=form).values() for order in orders]
    ConvergenceFigure(series).savefig(DOCS / "images" / f"convergence_{cells}.png", dpi=110)
    return [f"## Cells: {cells}", "", f"![errors](images/convergence_{cells}.png)", "", convergence.Summary(series), ""]


def Locking():
    sweeps = [locking.Study(method, order=order) for method in Variants(form="edge").values() for order in (1, 2)]
    LockingFigure(sweeps).savefig(DOCS / "images" / "locking.png", dpi=110)
    return ["## Nearly incompressible bodies", "",
            "The relative strain error |eps_h(u - u_h)|/|eps(u)| on triangles, mesh 1/16, while lam grows and mu = 2.  The",
            "last column is the last error over the first: near 1 without locking, large where a method locks.", "",
            "![locking](images/locking.png)", "", locking.Markdown(sweeps), ""]


def ConvergencePage():
    lines = ["# Convergence and locking", "", "Written by `python docs/regenerate.py`; `ngdgc convergence` and `ngdgc locking` "
             "make the same tables and figures.", "",
             "The smooth solution `ngdgc.exact.SmoothSlip` (2D after Chouly, Ern, Pignet 2020; in 3D the same field in an",
             "oblique direction) slips with Coulomb friction on the whole of Gamma_C; mu = 2, lam = 1.  Every method has its",
             "automatic penalty.  Expected orders: k in the energy norm |u - u_h|_(1,h), k + 1 in L2.  The tables give the",
             "errors on the finest mesh 1/n and the orders observed between the last two meshes, the figures all meshes.", ""]
    for study in STUDIES:
        lines += Convergence(*study)
    return "\n".join(lines + Locking())


if __name__ == "__main__":
    Images()
    (DOCS / "convergence.md").write_text(ConvergencePage(), encoding="utf-8")
    (DOCS / "examples.md").write_text(ExamplesPage(), encoding="utf-8")
    (DOCS / "table3.md").write_text(table3.Page(table3.Study()), encoding="utf-8")
    (DOCS / "stability.md").write_text(stabilitystudy.StabilityPage(), encoding="utf-8")
    atlaspage.WritePage(DOCS / "atlas.md", list(atlas.Study(atlas.Sweeps())), atlas.Sweeps())
