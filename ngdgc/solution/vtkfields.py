"""What files for VTK hold of a solution: fields in the elements, and the contact quantities on cells around their points."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from os import PathLike
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

import numpy as np
from ngsolve import CF, Integrate

from ..contracts import Array
from .fields import SpatialStress, VonMises
from .pointcells import ContactCells
from .vtkfiles import LINE, POLYGON, ElementGrid, WriteUnstructured

SUBDIVISION = 3     # bisections of an element at most: 8 intervals along an edge


def Written(solution: Any, path: str | PathLike[str], Write: Any) -> Path:
    """The file that `Write` makes of a solution; of one that is spread over processes, that which names a file of each."""
    return Path(solution.WriteParts(path, Write) if hasattr(solution, "WriteParts") else Write(solution, path))


def WriteBody(solution: Any, path: str | PathLike[str], elements: np.ndarray | None = None) -> Path:
    """The file of `export.WriteVTK`; elements : True for those that are written (elements,), None: all."""
    disc, stress, Weighted = solution.disc, SpatialStress(solution), solution.disc.problem.frame.Weighted
    degree = max(disc.order, disc.mesh.GetCurveOrder())
    grid = ElementGrid(disc.facets, 2 ** min(degree - 1, SUBDIVISION))
    fields = {"displacement": CF(solution.gfu), "stress": stress, "vonmises": VonMises(stress)}
    values, means = {}, {}
    for name, field in fields.items():
        values[name] = np.asarray(field(grid.points)).reshape(len(grid.points), -1)
        # Of curved elements the integrand is a polynomial of more than their degree.
        integrals = [np.array(Integrate(Weighted(part), disc.mesh, order=3 * degree, element_wise=True))
                     for part in _Components(field)]
        means[name] = grid.Means(values[name], np.column_stack(integrals))
    for arrays in (values, means):
        arrays["displacement"] = _Spatial(arrays["displacement"])
    means |= {"weights": grid.Sizes()}
    if elements is None:
        return WriteUnstructured(path, grid.coordinates, grid.cells, values, means)
    used, cells, kept = grid.Of(elements)
    return WriteUnstructured(path, grid.coordinates[used], cells, {name: array[used] for name, array in values.items()},
                             {name: array[kept] for name, array in means.items()})


def WriteContact(solution: Any, path: str | PathLike[str]) -> Path:
    """The file of `export.WriteContactVTK`."""
    contact, cells = solution.disc.contact, ContactCells(solution.disc)
    names = ["pressure", "friction", "bound", "penetration", "slip", "displacement", "zones", "normals"]
    names += ["worn"] * contact.wears
    fields = {name: np.asarray(getattr(solution, name)) for name in names} | {"gap": contact.gap}
    fields = {name: (_Spatial(field) if field.ndim == 2 else field)[contact.members] for name, field in fields.items()}
    fields |= {"weights": cells.weights, "point": contact.members}
    displacement = np.asarray(solution.gfu(cells.points)).reshape(len(cells.points), -1)
    kind = LINE if solution.disc.mesh.dim == 2 else POLYGON
    return WriteUnstructured(path, _Spatial(cells.coordinates), [(kind, corners[None]) for corners in cells.corners],
                             {"displacement": _Spatial(displacement)}, fields)


def WriteSteps(solutions: Iterable[Any], times: Sequence[float], path: Path) -> Path:
    """The files of `export.WriteSeries`, one solution after the other: a LoadHistory finds each when it is asked for."""
    folder = path.with_suffix("")
    folder.mkdir(parents=True, exist_ok=True)
    lines = []
    for number, (time, solution) in enumerate(zip(times, solutions)):
        for part, (name, Write) in enumerate((("body", WriteBody), ("contact", WriteContact))):
            file = Write(solution, folder / f"{name}-{number:04d}.vtu")
            lines.append(f'<DataSet timestep="{time!r}" group="" part="{part}" name="{name}" '
                         f'file="{escape(folder.name)}/{file.name}"/>')
    text = "\n".join(['<?xml version="1.0"?>', '<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">',
                      "<Collection>", *lines, "</Collection>", "</VTKFile>", ""])
    path.write_text(text, encoding="utf-8")
    return path


def _Components(field: Any) -> list[Any]:
    return [field[place if len(place) > 1 else place[0]] for place in np.ndindex(*field.dims)] if field.dim > 1 else [field]


def _Spatial(vectors: Array) -> Array:
    """Vectors (n, d) with a third component 0 in 2D, (n, 3)."""
    return np.pad(vectors, ((0, 0), (0, 3 - vectors.shape[1])))
