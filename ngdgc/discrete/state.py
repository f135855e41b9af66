"""What a Discretization is made from, and whether it still is that: NGSolve's objects can be changed at any time.

Points of the mesh are moved, boundaries renamed, Parameters set, GridFunctions filled anew, and nobody is told.  So what
was there is remembered, and compared when it is used.  Parameters are meant to be set: a solver reads them when it begins,
and what it has computed keeps the values that it has read.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
from copy import copy
from functools import wraps
from typing import Any, TypeVar, cast
from zlib import crc32

import numpy as np
from netgen.libngpy._meshing import NgException
from ngsolve import CoefficientFunction, GridFunction, Mesh, Parameter

from ..exceptions import ProblemError
from ..problem.problem import ContactProblem
from ..tools.formula import Plain

Method = TypeVar("Method", bound=Callable[..., Any])
ROLES = "compliance", "friction", "wear"    # of laws on a foundation


def Leaves(function: Any) -> list[CoefficientFunction]:
    """The Parameters and GridFunctions that a CoefficientFunction is made of, each once, in the order of its tree.

    Not those below the few operations, such as Interpolate, whose operands NGSolve does not tell.
    """
    if not isinstance(function, CoefficientFunction) or Plain(function):    # what NGSolve prints is a hundred times cheaper
        return []
    seen, todo, found = {}, [function], []
    while todo:
        one = todo.pop()
        if not isinstance(one, CoefficientFunction) or id(one) in seen:
            continue
        seen[id(one)] = one     # kept alive: NGSolve has one Python object for each of its own only as long as it is held
        if isinstance(one, (Parameter, GridFunction)):
            found.append(one)
            continue
        try:
            todo += reversed(one.data["childs"])
        except NgException:
            continue
    return found


def Data(problem: ContactProblem) -> Iterator[tuple[str, Any]]:
    """(name, value) of everything that a problem is given by, as messages call it."""
    yield from ((f"material: {name}", value) for name, value in vars(problem.material).items())
    for foundation in problem.foundation:
        where = f"{foundation.kind} {foundation.boundary!r}"
        yield f"{where}: gap", foundation.gap
        yield f"{where}: tension", foundation.tension
        yield f"{where}: normal", foundation.normal
        if foundation.punch is not None:
            yield from ((f"{where}: {name}", value) for name, value in foundation.punch.Data())
        for role in ROLES:
            law = getattr(foundation, role)
            yield from ((f"{where}: {name} of {role}", value) for name, value in getattr(law, "__dict__", {}).items())
    for kind in ("dirichlet", "roller", "traction", "force", "spring"):
        yield from ((f"{kind}[{region!r}]", value) for region, value in getattr(problem, kind).items())
    yield "bodyforce", problem.bodyforce


class State:
    """A mesh and the data of a problem, as they are now; Parameters keep the values that they have now."""

    def __init__(self, problem: ContactProblem, mesh: Mesh) -> None:
        self.mesh, self._mesh, self._nested = mesh, MeshState(mesh), False
        leaves = [(name, leaf) for name, value in _Functions(problem) for leaf in Leaves(value)]
        self._parameters = [(name, leaf, leaf.Get()) for name, leaf in leaves if isinstance(leaf, Parameter)]
        self._fields = [(name, leaf, _Digest(leaf)) for name, leaf in leaves if isinstance(leaf, GridFunction)]
        self._laws = [(name, law, _Plain(law)) for name, law in _Laws(problem)]

    def Now(self) -> State:
        """The same with the values that Parameters have now, of what has not changed otherwise (`CheckFixed`)."""
        now = copy(self)
        now._nested, now._parameters = False, [(name, leaf, leaf.Get()) for name, leaf, _ in self._parameters]
        return now

    def Parameters(self) -> list[str]:
        """The names of the data in which a Parameter has another value now, a list."""
        return list(dict.fromkeys(name for name, leaf, value in self._parameters if leaf.Get() != value))

    def Following(self, parameter: Any) -> list[str]:
        """The names of the data that depend on a Parameter."""
        value = parameter.Get()
        try:
            parameter.Set(np.nan)       # which no other one is
            return list(dict.fromkeys(name for name, leaf, _ in self._parameters if np.isnan(leaf.Get())))
        finally:
            parameter.Set(value)

    def CheckMesh(self) -> None:
        """Raise ProblemError if the mesh has changed."""
        if what := self._mesh.Changed(self.mesh):
            raise ProblemError(f"{what} after the Discretization was made; make a new one")

    def CheckFixed(self) -> None:
        """Raise ProblemError if anything but Parameters has changed."""
        self.CheckMesh()
        changed = [name for name, leaf, digest in self._fields if _Digest(leaf) != digest]
        for where, law, before in self._laws:
            now = _Plain(law)
            changed += [f"{name} of {where}" for name in {**before, **now} if before.get(name) != now.get(name)]
        if changed:
            raise ProblemError(f"{', '.join(changed)}: a GridFunction or a number of a law was changed after the "
                               "Discretization was made; make a new one, or use a Parameter, which Solve reads when it begins")

    def CheckMaterial(self) -> None:
        """Raise ProblemError if a Parameter in the material has another value: its stress could not be given."""
        if changed := [name for name in self.Parameters() if name.startswith("material")]:
            raise ProblemError(f"a Parameter in {', '.join(changed)} was set anew since the solution was computed; set it back "
                               "to look at its stress")

    @contextmanager
    def Restored(self) -> Iterator[None]:
        """A time in which Parameters have the values that they had; ProblemError if anything else has changed."""
        if self._nested:
            yield
            return
        self.CheckFixed()
        now = [leaf.Get() for _, leaf, _ in self._parameters]
        try:
            self._nested = True
            for _, leaf, value in self._parameters:
                leaf.Set(value)
            yield
        finally:
            self._nested = False
            for (_, leaf, _), value in zip(self._parameters, now):
                leaf.Set(value)


def _Digest(field: GridFunction) -> int:
    return crc32(field.vec.FV().NumPy())


def _Laws(problem: ContactProblem) -> Iterator[tuple[str, Any]]:
    """(words, law) of the laws with attributes, also frozen ones: a list or an array in them may be changed in place."""
    for foundation in problem.foundation:
        for role in ROLES:
            law = getattr(foundation, role)
            if hasattr(law, "__dict__"):
                yield f"{role} on {foundation.boundary!r}", law


def _Plain(law: Any) -> dict[str, Hashable]:
    """What tells the attributes of a law apart, {name: value}; functions and other objects by their identity."""
    def Told(value: Any) -> Hashable:
        if isinstance(value, np.ndarray):
            return value.tobytes()
        if isinstance(value, (list, tuple)):    # which may be changed in place, too
            return tuple(map(Told, value))
        if isinstance(value, dict):
            return tuple((key, Told(entry)) for key, entry in value.items())
        return value if isinstance(value, (int, float, str)) else id(value)
    return {name: Told(value) for name, value in vars(law).items()}


def _Functions(problem: ContactProblem) -> Iterator[tuple[str, CoefficientFunction]]:
    for name, value in Data(problem):
        if isinstance(value, CoefficientFunction):
            yield name, value
        elif isinstance(value, tuple):      # the matrix of an anisotropic material
            yield from ((name, entry) for row in value for entry in row if isinstance(entry, CoefficientFunction))


def AsRead(method: Method) -> Method:
    """A method of what has a `state`, with Parameters as they were when that was made."""
    @wraps(method)
    def Restored(self: Any, *arguments: Any, **options: Any) -> Any:
        with self.state.Restored():
            return method(self, *arguments, **options)
    return cast(Method, Restored)


class MeshState:
    """The points, elements, names, order and deformation of a mesh, as they are now."""

    def __init__(self, mesh: Mesh) -> None:
        self.order = mesh.GetCurveOrder()
        self.names = mesh.GetMaterials(), mesh.GetBoundaries()
        self.points = mesh.ngmesh.Coordinates().copy()
        # Netgen takes long to tell the layout of its elements, which stays the same.
        self.types = [array.NumPy().dtype for array in _Elements(mesh)]
        self.elements = [indices.copy() for indices in self._Indices(mesh)]
        self.deformation = None if mesh.deformation is None else mesh.deformation.vec.FV().NumPy().copy()

    def _Indices(self, mesh: Mesh) -> list[np.ndarray]:
        """Region numbers of elements and boundary elements, views."""
        return [np.frombuffer(array, dtype)["index"] for array, dtype in zip(_Elements(mesh), self.types)]

    def Changed(self, mesh: Mesh) -> str | None:
        """What has happened to the mesh since, in words, or None."""
        elements, points = self._Indices(mesh), mesh.ngmesh.Coordinates()
        if [len(array) for array in elements] != [len(array) for array in self.elements] or points.shape != self.points.shape:
            return "the mesh was refined, or elements were added"
        if mesh.GetCurveOrder() != self.order:
            return "the mesh was curved"
        if not np.array_equal(points, self.points):
            return "points of the mesh were moved"
        if (mesh.GetMaterials(), mesh.GetBoundaries()) != self.names:
            return "regions of the mesh were renamed"
        if not all(np.array_equal(indices, before) for indices, before in zip(elements, self.elements)):
            return "elements of the mesh were given other regions"
        deformation, before = None if mesh.deformation is None else mesh.deformation.vec.FV().NumPy(), self.deformation
        if deformation is not before and (deformation is None or before is None or not np.array_equal(deformation, before)):
            return "the deformation of the mesh was set, changed or taken away"
        return None


def _Elements(mesh: Mesh) -> list[Any]:
    """Netgen's elements and boundary elements, its own arrays."""
    kinds = (mesh.ngmesh.Elements1D, mesh.ngmesh.Elements2D, mesh.ngmesh.Elements3D)[mesh.dim - 2:mesh.dim]
    return [kind() for kind in kinds]
