"""What the lemmas say about all methods on one mesh, as a table for the terminal, and the documentation page on stability."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from ngsolve import CF, Mesh
from ngsolve.meshes import MakeStructured2DMesh, MakeStructured3DMesh

from ..cases import example_4_1
from ..discretization import Discretization
from ..errors import Rates
from ..exact import SmoothSlip
from ..meshes import RectangleMesh
from ..methods.guarantee import Guarantee
from ..methods.overpenalised import WeaklyOverPenalised
from ..methods.penaltyfree import PenaltyFreeLDG
from ..methods.registry import METHODS, Options
from ..methods.rows import LDG, BassiEtAl, InteriorPenalty
from ..problem.foundation import Foundation
from ..problem.laws import NormalCompliance
from ..problem.materials import HookeMaterial
from ..problem.problem import ContactProblem
from ..theory.consistency import ConsistencyResidual
from ..theory.lemmas import Boundedness, Coercivity, CriticalPenalty, LiftingBounds, LiftingConstants
from ..tools.calls import ByKeyword
from ..tools.tables import Aligned, Piped

ROWS = tuple(row for row in METHODS.values() if "form" in Options(row))
RATIOS = (0, 1, 4, 10, 100)
ROUNDOFF = 1e-8     # of a critical penalty that is zero, an eigenvalue of matrices with entries of different size


@ByKeyword
@dataclass(frozen=True)
class Constants:
    """The constants of one method on one mesh; no unit.

    critical : penalty number above which the form is coercive (`CriticalPenalty`), None without a penalty
    sufficient : what is known for penalty 1, whose kappa is the number that the element bound asks for
    coercivity, boundedness : in |||.|||, penalty="auto"
    """

    method: Any
    critical: float | None
    sufficient: Guarantee
    coercivity: float
    boundedness: float


@ByKeyword
@dataclass(frozen=True)
class Stability:
    """`rows`, the `Constants` of each discontinuous method, and `liftings`, the `LiftingBounds` for l = k."""

    rows: list[Constants]
    liftings: LiftingBounds
    title: str


@ByKeyword
def Study(problem: ContactProblem, mesh: Mesh, *, order: int = 1, form: str = "edge", rows: list[Constants] | None = None,
          callback: Callable[[str], object] | None = None) -> Stability:
    """The `Stability` of all discontinuous methods for a problem on a mesh; `callback(line)` reports progress.

    rows : an empty list to which the Constants of each method are added as they come, for who may be interrupted

    About twenty seconds a method for 49 000 dofs.  Raises ProblemError as `Discretization` and `CriticalPenalty`.
    """
    rows = [] if rows is None else rows
    for row in ROWS:
        if callback:
            callback(f"{row.name}, form={form!r}")
        disc = unit = Discretization(problem, row(form=form), mesh, order=order)
        critical = None
        if "penalty" in Options(row):
            unit = Discretization(problem, row(form=form, penalty=1.0), mesh, order=order)
            critical = CriticalPenalty(problem, row, mesh, order=order, form=form)
        rows.append(Constants(disc.method, critical, unit.form.guarantee, Coercivity(disc), Boundedness(disc)))
    title = f"order {order}, form={form!r}, {disc.mesh.ne} elements, {disc.space.ndof} unknowns"
    return Stability(rows, LiftingConstants(disc), title)


def _Cells(row: Constants) -> list[str]:
    """A row of the table as words: method, critical and sufficient penalty, coercivity, boundedness."""
    constants = [f"{row.coercivity:.3g}", f"{row.boundedness:.3g}"]
    if row.critical is None:
        return [row.method.name, "has none", "has none", *constants]
    critical = "any" if row.critical <= ROUNDOFF else f"{row.critical:.3g}"
    sufficient = {"always": "any", "unknown": "unknown"}.get(row.sufficient.kind) or f"{row.sufficient.kappa:.3g}"
    return [row.method.name, critical, sufficient, *constants]


HEAD = ["method", "critical penalty", "by element bound", "coercivity", "boundedness"]


def _LiftingWords(bounds: Any) -> str:
    return f"Liftings: {bounds.c:.3g} |h^-1/2 [v]|_e <= |r_e([v])| <= {bounds.C:.3g} |h^-1/2 [v]|_e"


@ByKeyword
def Table(rows: Sequence[Constants]) -> list[str]:
    """Lines of the table of Constants."""
    return Aligned([HEAD, *map(_Cells, rows)], numbers=True)


@ByKeyword
def Text(study: Stability) -> str:
    """The table for a terminal."""
    return "\n".join([f"Stability: {study.title}", "", *Table(study.rows), "", _LiftingWords(study.liftings), "",
                      "Critical penalty: the form is coercive above it.  Coercivity, boundedness: with penalty='auto'",
                      "c |||v|||^2 <= B(v, v) and B(u, v) <= C |||u||| |||v|||."])


def _Table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    return [*Piped([head, *rows]), ""]


@ByKeyword
def Markdown(study: Stability) -> list[str]:
    """The table for the documentation, a list of lines."""
    return _Table(HEAD, map(_Cells, study.rows))


def _Problem(dim: int, lam: float = 4.0) -> ContactProblem:
    """A cantilever with mu = 1, held on the right."""
    return ContactProblem(HookeMaterial(mu=1.0, lam=float(lam)), Foundation("bottom", NormalCompliance(1.0)),
                          dirichlet={"right": CF((0,) * dim)})


def _Consistency() -> Iterator[list[str]]:
    exact, sizes = SmoothSlip(), (4, 8, 16)
    for form in ("edge", "lifting"):
        for order in (1, 2):
            residuals = [ConsistencyResidual(Discretization(exact.problem, LDG(form=form), RectangleMesh(n), order=order),
                                             exact.displacement) for n in sizes]
            rates = "round-off" if form == "edge" else ", ".join(f"{rate:.2f}" for rate in Rates(residuals))
            yield [form, str(order), *(f"{value:.1e}" for value in residuals), rates]


def _Liftings() -> Iterator[list[str]]:
    for order, liftorder in ((1, 0), (1, 1), (2, 1), (2, 2), (3, 3)):
        cells = []
        for mesh in (RectangleMesh(4), RectangleMesh(8), RectangleMesh(4, upper=(1, 0.1))):
            bounds = LiftingConstants(Discretization(_Problem(2), LDG(), mesh, order=order), order=liftorder)
            cells.append(f"{bounds.c:.3g}, {bounds.C:.3g}")
        yield [str(order), str(liftorder), *cells]


def _Thresholds() -> Iterator[list[str]]:
    for ratio in RATIOS:
        values = [CriticalPenalty(_Problem(2, ratio), InteriorPenalty, RectangleMesh(4), order=k) * k ** 2 for k in (1, 2)]
        yield [str(ratio), *(f"{value:.1f} ({value / (ratio + 2):.2f})" for value in values)]


@ByKeyword
def Shapes() -> dict[str, tuple[Mesh, int]]:
    """Meshes of different shapes, {name: (mesh, facets of an element)}, held on "right"."""
    return {"triangles": (RectangleMesh(4), 3),
            "triangles, stretched by 10": (RectangleMesh(4, upper=(1, 0.1)), 3),
            "slivers, stretched by 100 and sheared": (MakeStructured2DMesh(
                quads=False, nx=3, ny=3, mapping=lambda s, t: (s + 2 * t, t / 100)), 3),
            "squares": (RectangleMesh(4, cells="quad"), 4),
            "tetrahedra": (MakeStructured3DMesh(hexes=False, nx=2, ny=2, nz=2), 4),
            "tetrahedra, stretched by 10": (MakeStructured3DMesh(hexes=False, nx=2, ny=2, nz=2,
                                                                 mapping=lambda s, t, r: (s, t, r / 10)), 4),
            "cubes": (MakeStructured3DMesh(hexes=True, nx=2, ny=2, nz=2), 6)}


def _Bassi() -> Iterator[list[str]]:
    for name, (mesh, facets) in Shapes().items():
        values = [CriticalPenalty(_Problem(mesh.dim), BassiEtAl, mesh, order=order) for order in (1, 2)]
        yield [name, str(facets), *(f"{value:.3f}" for value in values)]


def _PenaltyFree() -> Iterator[list[str]]:
    """LDG without a penalty, and with next to none and liftings of degree k and k + 1, by lam/mu."""
    for order in (1, 2):
        for ratio in (1, 100, 10000):
            discs = [Discretization(_Problem(2, ratio), method, RectangleMesh(n), order=order)
                     for method in (PenaltyFreeLDG(), *(LDG(penalty=1e-8, liftorder=order + more) for more in (1, 0)))
                     for n in (4, 8)]
            kappa, degree = discs[0].form.guarantee.kappa, discs[0].form.operators.liftorder
            c = [f"{Coercivity(disc):.3g}" for disc in discs]
            yield [str(order), str(ratio), f"{degree}, {kappa:.3f}", *(", ".join(c[i:i + 2]) for i in (0, 2, 4))]


def _Uniform() -> Iterator[list[str]]:
    for row in (*ROWS, WeaklyOverPenalised):
        discs = [Discretization(_Problem(2), row(), RectangleMesh(n), order=1) for n in (4, 8, 16)]
        yield [row.name, *(f"{Coercivity(disc):.3f}, {Boundedness(disc):.1f}" for disc in discs)]


@ByKeyword
def StabilityPage() -> str:
    """The documentation page, Markdown."""
    study = Study(example_4_1.Problem("strain"), example_4_1.Mesh(8), order=1)
    skewed = MakeStructured2DMesh(quads=True, nx=4, ny=4, mapping=lambda s, t: (s + 0.2 * t * (1 - t), t * (1 - 0.7 * s)))
    forms = [Study(_Problem(2), skewed, order=1, form=form) for form in ("edge", "lifting")]
    return "\n".join([
        "# Stability: the lemmas, computed", "",
        "Written by `python docs/regenerate.py`; every number comes from sparse eigenvalue problems",
        "(`ngdgc/theory/lemmas.py`).",
        "The norm is |||v|||^2 = int C eps_h(v):eps_h(v) + sum_e (mu/h_e) int_e [v]:[v] over E0.  Meshes are n x n squares,",
        "cut by `/` and held on the right, with mu = 1 and lam = 4, unless said otherwise.", "",
        "## All methods on Example 4.1 (plane strain, n = 8, P1)", "",
        "Critical: the penalty number above which the form is coercive.  By element bound: the number that is enough by the",
        "bound of `ngdgc/methods/penalty.py`.  Coercivity and boundedness: with `penalty=\"auto\"`.", "",
        *Markdown(study), _LiftingWords(study.liftings) + ".", "",
        "## Quadrilaterals that are no parallelograms, where the two forms differ", "",
        "There LDG and Brezzi et al. are coercive for any penalty in their lifting forms only: the edge forms are no squares.",
        "",
        *(line for one in forms for line in (one.title, "", *Markdown(one))),
        "## Lemma 3.1, consistency", "",
        "The largest |B_h(u, v) - (f, v) + ...|/|||v||| for the smooth solution B2 and LDG.  The lifting forms see the",
        "projection of the stress on Q_h, l = k: a variational crime of order l + 1.", "",
        *_Table(["form", "k", "n = 4", "n = 8", "n = 16", "order in h"], _Consistency()),
        "## Lemma 3.2, liftings", "",
        "c, C in c |h_e^-1/2 [v]|_e <= |r_e([v])|_0 <= C |h_e^-1/2 [v]|_e.  c = 0 for l < k: what is orthogonal to P_l on a",
        "facet is not lifted.", "",
        *_Table(["k", "l", "n = 4", "n = 8", "n = 4, stretched by 10"], _Liftings()),
        "## Lemmas 3.3 and 3.4, coercivity and boundedness on refined meshes", "",
        "c, C with `penalty=\"auto\"`, P1.  WOPSIP is not bounded in this norm, its C grows like h^-2.", "",
        *_Table(["method", "n = 4", "n = 8", "n = 16"], _Uniform()),
        "## LDG without a penalty", "",
        "c on n = 4, 8 of `PenaltyFreeLDG` with its degree l and largest kappa_K, and of LDG with penalty 1e-8 and liftings of",
        "degree k + 1 and k: l = k is not enough, k + 1 is if lam is moderate; `PenaltyFreeLDG` takes k + 2 if it is large.",
        "", *_Table(["k", "lam/mu", "l, kappa_K", "without a penalty", "l = k + 1", "l = k"], _PenaltyFree()),
        "## How large eta must be for interior penalty", "",
        "Critical eta/mu, n = 4, h_e = |e|, and in parentheses eta/(lam + 2 mu).", "",
        *_Table(["lam/mu", "k = 1", "k = 2"], _Thresholds()),
        "## How large eta must be for Bassi et al.", "", "The number of facets of an element is enough.", "",
        *_Table(["mesh", "facets", "k = 1", "k = 2"], _Bassi())])
