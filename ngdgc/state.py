"""What a Discretization is made from, and whether it still is that: NGSolve's objects can be changed at any time.

Points of the mesh are moved, boundaries renamed, Parameters set, GridFunctions filled anew, and nobody is told.  So what
was there is remembered, and compared when it is used.  Parameters are meant to be set: a solver reads them when it begins,
and what it has computed keeps the values that it has read.
"""

from contextlib import contextmanager
from functools import wraps
from zlib import crc32

import numpy as np
from netgen.libngpy._meshing import NgException
from ngsolve import CoefficientFunction, GridFunction, Parameter

from .exceptions import ProblemError
from .formula import Plain


def Leaves(function):
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


def Data(problem):
    """(name, value) of everything that a problem is given by, as messages call it; values are numbers, functions, arrays."""
    yield from ((f"material: {name}", value) for name, value in vars(problem.material).items())
    for foundation in problem.foundation:
        where = f"foundation {foundation.boundary!r}"
        yield f"{where}: gap", foundation.gap
        for role in ("compliance", "friction"):
            law = getattr(foundation, role)
            yield from ((f"{where}: {name} of {role}", value) for name, value in getattr(law, "__dict__", {}).items())
    for kind in ("dirichlet", "roller", "traction"):
        yield from ((f"{kind}[{region!r}]", value) for region, value in getattr(problem, kind).items())
    yield "bodyforce", problem.bodyforce


class State:
    """A mesh and the data of a problem, as they are now; Parameters keep the values that they have now."""

    def __init__(self, problem, mesh):
        self.problem, self.mesh = problem, mesh
        self._mesh, self._fields = MeshState(mesh), _Fields(problem)
        self._parameters = {name: [(leaf, leaf.Get()) for leaf in Leaves(value) if isinstance(leaf, Parameter)]
                            for name, value in _Functions(problem)}

    def Parameters(self):
        """The names of the data in which a Parameter has another value now, a list."""
        return [name for name, values in self._parameters.items() if any(leaf.Get() != value for leaf, value in values)]

    def CheckMesh(self):
        """Raise ProblemError if the mesh has changed."""
        if what := self._mesh.Changed(self.mesh):
            raise ProblemError(f"{what} after the Discretization was made; make a new one")

    def CheckFixed(self):
        """Raise ProblemError if anything but Parameters has changed."""
        self.CheckMesh()
        now = _Fields(self.problem)
        if changed := [name for name in {**self._fields, **now} if self._fields.get(name) != now.get(name)]:
            raise ProblemError(f"{', '.join(changed)}: a GridFunction or a number of a law was changed after the "
                               "Discretization was made; make a new one, or use a Parameter, which Solve reads when it begins")

    def CheckMaterial(self):
        """Raise ProblemError if a Parameter in the material has another value: its stress could not be given."""
        if changed := [name for name in self.Parameters() if name.startswith("material")]:
            raise ProblemError(f"a Parameter in {', '.join(changed)} was set anew since the solution was computed; set it back "
                               "to look at its stress")

    @contextmanager
    def Restored(self):
        """A time in which Parameters have the values that they had; ProblemError if anything else has changed."""
        self.CheckFixed()
        now = [(leaf, leaf.Get(), value) for values in self._parameters.values() for leaf, value in values]
        try:
            for leaf, _, value in now:
                leaf.Set(value)
            yield
        finally:
            for leaf, value, _ in now:
                leaf.Set(value)


def _Fields(problem):
    """What tells the values of GridFunctions and of the plain attributes of laws apart, {name of the datum: tuple}."""
    found = {name: tuple(crc32(leaf.vec.FV().NumPy()) for leaf in Leaves(value) if isinstance(leaf, GridFunction))
             for name, value in _Functions(problem)}
    # A law of a user's own need not be frozen.
    return found | {name: (value.tobytes() if isinstance(value, np.ndarray) else value,) for name, value in Data(problem)
                    if isinstance(value, (np.ndarray, int, float, str))}


def _Functions(problem):
    for name, value in Data(problem):
        if isinstance(value, CoefficientFunction):
            yield name, value
        elif isinstance(value, tuple):      # the matrix of an anisotropic material
            yield from ((name, entry) for row in value for entry in row if isinstance(entry, CoefficientFunction))


def AsRead(method):
    """A method of what has a `state`, with Parameters as they were when that was made."""
    @wraps(method)
    def Restored(self, *arguments, **options):
        with self.state.Restored():
            return method(self, *arguments, **options)
    return Restored


class MeshState:
    """The points, elements, names, order and deformation of a mesh, as they are now."""

    def __init__(self, mesh):
        self.order = mesh.GetCurveOrder()
        self.names = mesh.GetMaterials(), mesh.GetBoundaries()
        self.points = mesh.ngmesh.Coordinates().copy()
        self.elements = [array["index"].copy() for array in _Elements(mesh)]
        self.deformation = None if mesh.deformation is None else mesh.deformation.vec.FV().NumPy().copy()

    def Changed(self, mesh):
        """What has happened to the mesh since, in words, or None."""
        elements, points = _Elements(mesh), mesh.ngmesh.Coordinates()
        if [len(array) for array in elements] != [len(array) for array in self.elements] or points.shape != self.points.shape:
            return "the mesh was refined, or elements were added"
        if mesh.GetCurveOrder() != self.order:
            return "the mesh was curved"
        if not np.array_equal(points, self.points):
            return "points of the mesh were moved"
        if (mesh.GetMaterials(), mesh.GetBoundaries()) != self.names:
            return "regions of the mesh were renamed"
        if not all(np.array_equal(array["index"], before) for array, before in zip(elements, self.elements)):
            return "elements of the mesh were given other regions"
        deformation = None if mesh.deformation is None else mesh.deformation.vec.FV().NumPy()
        if (deformation is None) != (self.deformation is None) or not np.array_equal(deformation, self.deformation):
            return "the deformation of the mesh was set, changed or taken away"
        return None


def _Elements(mesh):
    """Netgen's elements and boundary elements, numpy arrays."""
    kinds = (mesh.ngmesh.Elements1D, mesh.ngmesh.Elements2D, mesh.ngmesh.Elements3D)[mesh.dim - 2:mesh.dim]
    return [kind().NumPy() for kind in kinds]
