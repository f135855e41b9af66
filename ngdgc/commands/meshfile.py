"""The command `ngdgc mesh`: what is in the file of a mesh, and whether it is good."""

from __future__ import annotations

from argparse import Namespace
from collections import Counter
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from netgen.occ import OCCGeometry
from ngsolve import CF, Integrate, Mesh

from ..contracts import Array
from ..exceptions import ProblemError
from ..mesh.checks import CheckBoundary
from ..mesh.facets import Facets, Vertices
from ..mesh.quality import ShapeQuality
from ..meshes import ReadMesh, ShapeMesh
from ..tools.tables import Aligned
from .arguments import Commands, Finite
from .files import Files

NAMES = {2: {3: "triangles", 4: "quadrilaterals"}, 3: {4: "tetrahedra", 5: "pyramids", 6: "prisms", 8: "hexahedra"}}
STEP = (".step", ".stp")
POOR = 0.1          # quality of a shape below which estimates and iterations suffer


def AddMesh(commands: Commands) -> None:
    """The parser of the command, added to those of the command line."""
    mesh = commands.add_parser("mesh", help="say and draw what is in the file of a mesh",
                               description="Read a mesh as ReadMesh does: elements and their quality, names, sizes and normals "
                               "of the regions, and a picture.")
    mesh.add_argument("file", help=".msh of Gmsh, .inp of Abaqus or CalculiX, .vol of Netgen; .step of CAD is meshed")
    mesh.add_argument("--maxh", type=Finite, help="largest size of elements in the mesh of a STEP file (default: a tenth of "
                      "its extent)")
    mesh.add_argument("--out", default="results", help="folder for mesh.png (default results/)")
    mesh.set_defaults(command=MeshFile)


def MeshFile(options: Namespace) -> int:
    """Print what the file holds and draw it."""
    from ..plots import MeshFigure
    from .output import DrawInto

    if Path(options.file).suffix.lower() in STEP:
        mesh = _Meshed(options.file, options.maxh)
    elif options.maxh is not None:
        raise ProblemError(f"--maxh does not apply to {options.file}, which is a mesh already; leave it out")
    else:
        mesh = ReadMesh(options.file)
    print(f"{options.file}: {MeshWords(mesh)}")
    with Files(options.out, "mesh.png") as files:
        files.Write("mesh.png", partial(DrawInto, partial(MeshFigure, mesh)))
    return 0


def _Meshed(file: str, maxh: float | None) -> Mesh:
    """A mesh of second order of the shape in a STEP file."""
    try:
        shape = OCCGeometry(file).shape
    except Exception as error:      # NgException is no RuntimeError
        raise ProblemError(f"{file} is no STEP file, or is not there ({str(error).strip()}); give one that a CAD program has "
                           "written") from error
    lower, upper = (np.array([*corner]) for corner in shape.bounding_box)
    return ShapeMesh(shape, maxh or float(np.max(upper - lower)) / 10, order=2)


def MeshWords(mesh: Mesh) -> str:
    """Elements, size, quality and regions of a mesh, some lines."""
    dim, points = mesh.dim, mesh.ngmesh.Coordinates()[:, :mesh.dim]
    vertices, quality = Vertices(mesh, mesh.dim), ShapeQuality(mesh)
    kinds = Counter((vertices >= 0).sum(axis=1).tolist())
    edges = [np.linalg.norm(np.subtract(*points[[vertex.nr for vertex in edge.vertices]])) for edge in mesh.edges]
    worst = int(quality.argmin())
    at = points[[vertex for vertex in vertices[worst] if vertex >= 0]].mean(axis=0)
    measure = "area" if dim == 2 else "volume"
    curved = f", geometry of order {order}" if (order := mesh.GetCurveOrder()) > 1 else ""
    lines = [", ".join(f"{count} {NAMES[dim][corners]}" for corners, count in sorted(kinds.items()))
             + f", {mesh.nv} vertices{curved}",
             f"from {_Point(points.min(axis=0))} to {_Point(points.max(axis=0))}, "
             f"edges of {min(edges):.3g} to {max(edges):.3g}",
             f"shapes (1 is best, 0 is flat): {quality.min():.3f} at {_Point(at)}, {quality.mean():.3f} in the mean"]
    if quality.min() < POOR:
        lines[-1] += f"; {int((quality < POOR).sum())} elements below {POOR:g}: mesh anew for better ones"
    rows = [("material", "elements", measure)]
    counts = Counter(element.mat for element in mesh.Elements())
    for name in dict.fromkeys(mesh.GetMaterials()):
        whole = Integrate(CF(1), mesh, definedon=mesh.Materials(_Literal(name)), order=2 * order)
        rows.append((name, str(counts[name]), f"{whole:.6g}"))
    lines += ["", *Aligned(rows), "", *Aligned(_Boundaries(mesh))]
    return "\n".join(lines)


def _Boundaries(mesh: Mesh) -> list[tuple[str, ...]]:
    """A row for every boundary region: sides, length or area, where, mean outward normal."""
    facets = Facets(mesh)
    rows: list[tuple[str, ...]] = [("boundary", "sides", "length" if mesh.dim == 2 else "area", "middle", "mean normal")]
    for name in dict.fromkeys(mesh.GetBoundaries()):
        region = mesh.Boundaries(_Literal(name))
        CheckBoundary(facets, _Literal(name))
        number = sum(element.mat == name for element in mesh.Elements(region.VB()))
        size, middle, normal = _Moments(mesh, facets, _Literal(name))
        inner = "inside the body" if normal is None else _Point(normal)
        rows.append((name, str(number), f"{size:.6g}", _Point(middle), inner))
    return rows


def _Moments(mesh: Mesh, facets: Facets, region: str) -> tuple[float, Array, Array | None]:
    """Measure, middle and mean outward normal of a boundary region; None in place of a normal inside the body."""
    from ..mesh.quadrature import BoundaryQuadrature

    on = BoundaryQuadrature.On(facets, region, 2 * mesh.GetCurveOrder())
    size = float(on.weights.sum())
    inside = facets.neighbours[facets.boundary[0][on.boundaryelements]] > 1
    return size, on.weights @ on.coordinates / size, None if inside.any() else on.weights @ on.normals / size


def _Literal(name: str) -> str:
    from ..plots.curves import Literal

    return Literal(name)


def _Point(values: Any) -> str:
    return "(" + ", ".join(f"{value + 0:.4g}" for value in np.round(values, 12)) + ")"
