"""Pictures and files of a solution for other viewers: scenes of NGSolve's viewer on a web page, and VTK for ParaView."""

from __future__ import annotations

import csv
import html
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Literal

import numpy as np
from matplotlib import colormaps
from ngsolve import CF, BoundaryFromVolumeCF
from ngsolve.webgui import Draw

from .contracts import Array
from .exceptions import ProblemError
from .histories.history import LoadHistory
from .mesh.facets import Coordinates, VolumePoints
from .solution.fields import Field, FieldOf
from .solution.magnification import Magnification
from .solution.pictured import Pictured
from .solution.solution import CheckSolution, ContactSolution
from .solution.turned import CheckTurned, DrawTurned
from .solution.vtkfields import WriteBody, WriteContact, WriteSteps, Written
from .tools.calls import ByKeyword
from .tools.kinds import Short
from .tools.units import InUnits
from .tools.values import Vectors

CAMERA_ORDER = 4    # of the quadrature whose points the camera takes into view
COLOURS = colormaps["viridis"](np.linspace(0, 1, 12))[:, :3].tolist()    # NGSolve's own rainbow is not colour-blind safe
HEIGHT = 400        # of a scene in a notebook [pixels]
LIGHT = {"ambient": 0.6, "diffuse": 0.4}
NEGLIGIBLE = 0.01   # part of the largest |u| below which colours begin at 0
STYLE = """<style>
body { font: 13px sans-serif; }
.ngdgc { position: fixed; left: calc(60px + 12vh); right: 2%; bottom: 6px; text-align: center; pointer-events: none; }
.ngdgc > * { pointer-events: auto; vertical-align: middle; }
.ngdgc > div { pointer-events: none; margin-top: 3px; }
.unit { position: fixed; left: 4%; top: calc(6% + 22px); pointer-events: none; }
@media (max-width: 560px) { .dg.main, .dg .close-button { width: 110px !important; } }
</style>"""
CONTROLS = """<div class="unit">{words}</div>
<div class="ngdgc"><button id="play">Play</button> <input id="time" type="range" min="0"> <span id="label"></span>
<div>{caption}</div></div>
<script>
{{
  const {{states, labels, smooth}} = render_data.ngdgc, last = states.length - 1;
  const time = document.getElementById("time"), play = document.getElementById("play");
  // The viewer's colour bar would be drawn lighter than the colours of the body.
  scene.renderer.outputColorSpace = "srgb-linear";
  time.max = last;
  time.step = smooth ? 0.01 : 1;
  time.value = last;
  const show = () => {{
    const t = Number(time.value), i = Math.min(Math.floor(t), Math.max(last - 1, 0));
    // States that are not blended may be on different meshes.
    if (!smooth) scene.setRenderData(states[t]);
    else if (last > 0) scene.interpolateRenderData(states[i], states[i + 1], t - i);
    document.getElementById("label").textContent = smooth ? "deformation x " + (t * render_data.ngdgc.scale).toPrecision(3)
                                                          : labels[t];
  }};
  let running = null;
  const stop = () => {{ clearInterval(running); running = null; play.textContent = "Play"; }};
  play.onclick = () => {{
    if (running) return stop();
    if (Number(time.value) >= last) time.value = 0;
    play.textContent = "Pause";
    running = setInterval(() => {{
      time.value = Number(time.value) + (smooth ? 0.02 : 1);
      show();
      if (Number(time.value) >= last) stop();
    }}, smooth ? 40 : 600);
    show();
  }};
  time.oninput = () => {{ stop(); show(); }};
  show();
}}
</script>
"""


@ByKeyword
class Scene:
    """The deformed body in colours, in NGSolve's viewer: the last line of a notebook cell shows it.

    field : whose values are the colours, by default |u|: a name or a CoefficientFunction, as for `ngdgc.plots.FieldFigure`

    scale : the deformation is drawn at `scale` times the displacement, 1 is real, "auto" one at which it is seen; a slider runs
        from the undeformed body to it

    turned : True shows a body of revolution in space, three quarters of it (`solution.turned`), in place of its section

    The elements move with their own one-sided displacements, so the jumps of a DG solution show.  Nothing is loaded from a
    network, neither in the notebook nor by the page that `Write` makes.
    """

    def __init__(self, solution: ContactSolution, *, field: Any = "displacement", scale: float | Literal["auto"] = 1,
                 turned: bool = False) -> None:
        solution = Pictured(solution)
        self.turned = CheckTurned(solution, turned)
        self.solution, self.scale = solution, Magnification(solution, scale)
        self.field = FieldOf(solution, field)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.solution!r}, scale={self.scale:g})"

    def _repr_html_(self) -> str:
        """A frame that holds the whole page, for notebooks."""
        return (f'<iframe srcdoc="{html.escape(self.Page())}" title="ngdgc: {html.escape(self.field.plain)}" loading="lazy" '
                f'style="width: 100%; height: {HEIGHT}px; border: 0"></iframe>')

    def Write(self, path: str | PathLike[str]) -> Path:
        """Write the page to a file; returns its Path."""
        path = Path(path)
        path.write_text(self.Page(), encoding="utf-8")
        return path

    def Page(self) -> str:
        """The text of the page."""
        # The viewer blends positions linearly: between the undeformed body and the deformed one in the same colours.
        states = [DrawTurned(self.solution, self.field, scale, colors=COLOURS) if self.turned else
                  _State(self.solution, self.field, scale, [self.solution]) for scale in (0, self.scale)]
        return _Page(states, self.solution, self.field, self.scale, labels=None)


@ByKeyword
class Animation(Scene):
    """A list of solutions, of load steps or on adaptive meshes, one after the other in NGSolve's viewer, as a `Scene`.

    The solutions have the same order and dimension; colours and camera are the same for all.  A button plays them, a slider
    goes to any of them, and at first the last one is shown.  Animation([*solution.earlier, solution]) is how `SolveAdaptive`
    came to its solution.
    """

    def __init__(self, solutions: Sequence[ContactSolution], *, field: str = "displacement",
                 scale: float | Literal["auto"] = 1) -> None:
        self.solutions = [Pictured(solution, f"solution {number}") for number, solution in enumerate(solutions, start=1)]
        if len(kinds := {(solution.disc.mesh.dim, _Degree(solution)) for solution in self.solutions}) != 1:
            raise ProblemError(f"an animation shows solutions of one dimension and order; given are {len(self.solutions)} with "
                               f"(dimension, order) {sorted(kinds) or 'none'}; give load steps of one Discretization")
        if not isinstance(field, str):
            raise ProblemError(f"field is {field!r}, a function of one state; give the name of a field, such as 'vonmises'")
        super().__init__(self.solutions[-1], field=field, scale=scale)

    def __repr__(self) -> str:
        return f"Animation({len(self.solutions)} solutions, scale={self.scale:g})"

    def Page(self) -> str:
        states = [_State(solution, FieldOf(solution, self.field.name), self.scale, self.solutions)
                  for solution in self.solutions]
        meshes = [solution.disc.mesh.ne for solution in self.solutions]
        sizes = [f", {elements} elements" if len(set(meshes)) > 1 else "" for elements in meshes]
        labels = [f"step {number} of {len(states)}{size}, max {self.field.plain} = {state['funcmax']:.3g}, "
                  f"deformation x {self.scale:g}"
                  for number, (state, size) in enumerate(zip(states, sizes), start=1)]
        return _Page(states, self.solution, self.field, self.scale, labels)


@ByKeyword
def WriteHTML(solution: ContactSolution, path: str | PathLike[str], *, scale: float | Literal["auto"] = 1) -> Path:
    """Write the page of a `Scene`; returns its Path."""
    return Scene(solution, scale=scale).Write(path)


def _Degree(solution: ContactSolution) -> int:
    return max(solution.disc.order, solution.disc.mesh.GetCurveOrder())


def _State(solution: ContactSolution, field: Field, scale: float, shown: Sequence[ContactSolution]) -> Any:
    """What the viewer draws of a solution, with the camera for all that are shown."""
    mesh = solution.disc.mesh
    if mesh.dim == 3:
        # On the boundary NGSolve evaluates a discontinuous function to garbage unless it is asked for its volume trace.
        displacement, function = BoundaryFromVolumeCF(solution.gfu), BoundaryFromVolumeCF(field.function)
        view = {"draw_vol": False, "euler_angles": [-70, 0, -25]}
    else:
        displacement, function, view = CF(solution.gfu), field.function, {}
    # The norm as a scalar: of a vector the viewer would take the range of its first component for the colours.
    # The outline of the body would be displaced by such boundary values; the lines of the mesh are right.
    settings = {"Objects": {"Edges": False}, "Light": LIGHT}
    # NGSolve's own `scale` moves no vertex of a scalar in the plane.
    return Draw(function, mesh, field.plain, deformation=scale * displacement, settings=settings, show=False,
                order=_Degree(solution), colors=COLOURS, **_Camera(shown, scale), **view).GetData()


def _Page(states: Any, solution: ContactSolution, field: Field, scale: float, labels: Any) -> str:
    """NGSolve's page of the last state, with controls to go to the others, which have the same colours."""
    from webgui_jupyter_widgets.html import GenerateHTML

    disc = solution.disc
    words = InUnits(f"{field.plain} {field.unit}".strip(), disc.problem.units) + states[-1].get("cut", "")
    title = f"Displacement {words}" if field.name == "displacement" else words
    caption = f"{title}: {disc.method.name}, order {disc.order}, {disc.mesh.ne} elements"
    if not solution.converged:
        caption += ", NOT CONVERGED"
    lowest, highest = min(state["funcmin"] for state in states), max(state["funcmax"] for state in states)
    lowest = 0 if 0 < lowest < NEGLIGIBLE * highest else lowest
    states = [state | {"funcmin": lowest, "funcmax": highest, "autoscale": False} for state in states]
    keep = {"states": states, "labels": labels, "smooth": labels is None, "scale": scale}
    page = GenerateHTML(states[-1] | {"ngdgc": keep}).replace("NGSolve WebGUI", f"ngdgc: {html.escape(field.plain)}", 1)
    head, end, tail = page.replace("</head>", STYLE + "</head>", 1).rpartition("</body>")
    return head + CONTROLS.format(caption=html.escape(caption), words=html.escape(words)) + end + tail


def _Points(solution: ContactSolution) -> tuple[Array, Array]:
    """Coordinates and displacement (n, d) at points all over the body."""
    points = VolumePoints(solution.disc.mesh, CAMERA_ORDER)
    return np.asarray(Coordinates(solution.disc.mesh.dim)(points)), np.asarray(solution.gfu(points))


def _Camera(shown: Sequence[ContactSolution], scale: float) -> dict[str, Any]:
    """Centre and radius of the view; NGSolve's own frame only the undeformed body."""
    x = np.concatenate([points for x, u in map(_Points, shown) for points in (x, x + scale * u)])
    lower, upper = x.min(axis=0), x.max(axis=0)
    centre = np.zeros(3)
    centre[:x.shape[1]] = (lower + upper) / 2
    return {"center": centre.tolist(), "radius": 0.65 * float(np.linalg.norm(upper - lower))}


@ByKeyword
def WriteCSV(solution: ContactSolution, path: str | PathLike[str]) -> Path:
    """Write the table of the contact points (`ContactSolution.Table`) as comma-separated text with a line of names.

    Numbers have all their digits.  `path` with or without its suffix .csv; returns the Path of the file.
    """
    CheckSolution(solution)
    table, target = solution.Table(), Path(path)
    target = target if target.suffix == ".csv" else target.with_name(target.name + ".csv")
    with open(target, "w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(table.dtype.names)
        rows.writerows(table.tolist())
    return target


@ByKeyword
def WriteVTK(solution: ContactSolution, path: str | PathLike[str]) -> Path:
    """Write a VTK file (.vtu) with every element's own points, so that the jumps of a DG solution are kept.

    Fields at the points: `displacement`, 3 components (0, in 2D, appended) [length], ready for ParaView's WarpByVector;
    `stress`, the 9 components row by row [stress], and `vonmises` [stress], both with the out-of-plane stress of the plane
    state.  The same fields of the cells are means: times areas or volumes of the cells, as in ParaView's Integrate Variables
    or pyvista's `integrate_data`, they are the integrals over every element, also where it is curved; `weights` are these
    sizes [length^d].  Of a body of revolution they are volumes around, for which that holds; its `stress` is in r, z, theta.
    Elements are bisected order - 1 times, at most three times, as VTK draws linearly; pyramids are
    written as two tetrahedra.  `path` with or without its suffix; returns the Path of the file.
    """
    CheckSolution(solution)
    return Written(solution, path, WriteBody)


@ByKeyword
def WriteContactVTK(solution: ContactSolution, path: str | PathLike[str]) -> Path:
    """Write a VTK file (.vtu) of Gamma_C, cut into a cell around every contact point, with what `ContactSolution` has there.

    Fields of the cells: `pressure`, `friction` (3 components), `bound` [stress]; `penetration`, `slip`, `gap`,
    `displacement` [length]; `zones`, as numbered in `ngdgc.contact.graph.ZONES`; `normals`; `point`, the number of the contact
    point; `weights` [length^(d-1)], which are the lengths or areas of the cells where the sides are straight and flat, so that
    there the integral of the pressure is `normalforce`; on curved sides that is the sum of pressure times weight.
    `displacement` is a field at the corners too, for ParaView's WarpByVector.  `path` with or without its suffix; returns the
    Path of the file.
    """
    CheckSolution(solution)
    return Written(solution, path, WriteContact)


@ByKeyword
def WriteSeries(solutions: LoadHistory | Sequence[ContactSolution], path: str | PathLike[str], *,
                times: Sequence[float] | None = None) -> Path:
    """Write a time series for ParaView (.pvd) of a LoadHistory, or of a list of solutions: the body and Gamma_C at every time.

    The files of all times, as `WriteVTK` and `WriteContactVTK` write them, are in a folder beside it, with the name of the
    series.  For ParaView, and pyvista's PVDReader, part 0 is the body and part 1 is Gamma_C.

    times : (m,), increasing; None: those of the LoadHistory, or 1, ..., m.  `path` with or without its suffix .pvd; returns the
        Path of the file

    Raises ProblemError if there is no solution, or for times that do not fit.
    """
    path = Path(path)
    if path.suffix != ".pvd":
        path = path.with_name(path.name + ".pvd")
    natural: Any = range(1, 1 + len(solutions)) if isinstance(solutions, (list, tuple)) else None
    if isinstance(solutions, LoadHistory):
        natural = solutions.times
    if natural is None or not len(natural):
        raise ProblemError(f"solutions is {Short(solutions)}; give a LoadHistory with a state, or a list of ContactSolutions")
    for number, solution in enumerate(solutions if isinstance(solutions, (list, tuple)) else [], start=1):
        CheckSolution(solution, f"solution {number}")
    remedy = f"give {len(natural)} increasing numbers, one for each solution"
    at = Vectors(natural if times is None else times, (len(natural),), "times", remedy)
    if np.any(np.diff(at) <= 0):
        raise ProblemError(f"times is {Short(times)}; {remedy}")
    return WriteSteps(solutions, at.tolist(), path)
