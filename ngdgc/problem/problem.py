"""The continuous problem (2.3)-(2.9): a body, its supports and loads, and the foundations it touches."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NoReturn

from ..contracts import Datum, VectorDatum
from ..data.coefficients import Scalar, ScalarOrVector, Vector
from ..data.regions import RegionName
from ..exceptions import ProblemError
from ..tools.calls import ByKeyword
from ..tools.formula import Described
from ..tools.units import CheckUnits
from ..tools.values import IsNumber
from .foundation import Foundation
from .frames import CARTESIAN, CYLINDRICAL, Cartesian
from .materials import AnisotropicMaterial, HookeMaterial


@ByKeyword
@dataclass(frozen=True)
class ContactProblem:
    """Find u with a(u, v-u) + j(u,v) - j(u,u) >= (f, v-u) for all admissible v, (2.14)-(2.15).

    Parameters
    ----------
    material : HookeMaterial or AnisotropicMaterial
    foundation : Foundation or Joint, or a sequence of them for several
    dirichlet : {region: vector}, displacement u = u_D [length] on all components
    roller : {region: scalar}, normal displacement u_n [length]; the tangential traction is zero there
    traction : {region: vector}, sigma n = f_2 [stress]
    force : {region: vector}, the total on a region [stress length^(d-1)], spread evenly as a traction over its area in the mesh
    spring : {region: scalar or vector}, stiffness k >= 0 of springs along a region [stress/length], sigma n = -k u, in every
        component; a traction or a force may act there too
    bodyforce : vector f_1 [stress/length] or None
    units : (length, stress) of all data, such as ("mm", "MPa"), for the words of figures and reports; nothing is converted
    axisymmetric : True for a body of revolution, whose plane mesh is half of its section, x = r >= 0 and y = z (`frames`
        module); vectors are (r, z), a `force` and all results are those of the whole ring.  On the axis, which is no boundary
        of the body, u_r = 0 by nature: nothing is given there

    Regions are NGSolve's regular expressions over boundary names ("left|bottom").  Boundaries that are not named are
    free.  Vectors are CoefficientFunctions, or tuples, with d components.

    Raises ProblemError for anything that is not of these types, and, once a mesh is known (`Discretization`), for
    names that match nothing, regions that overlap, values that are not finite, and motions that nothing resists.

    >>> from ngsolve import CF
    >>> from ngdgc import *
    >>> ContactProblem(HookeMaterial(E=1, nu=0.3), Foundation("bottom", NormalCompliance(1)),
    ...                dirichlet={"top": CF((0, -0.1))}).dim
    2
    """

    material: Any
    foundation: Any
    dirichlet: Any = None
    roller: Any = None
    traction: Any = None
    bodyforce: Any = None
    force: Any = None
    spring: Any = None
    units: Any = None
    axisymmetric: bool = False
    __repr__ = Described

    if TYPE_CHECKING:       # what is given; what is kept is converted
        def __init__(self, material: HookeMaterial | AnisotropicMaterial, foundation: Foundation | Sequence[Foundation],
                     dirichlet: Mapping[str, VectorDatum] | None = None, roller: Mapping[str, Datum] | None = None,
                     traction: Mapping[str, VectorDatum] | None = None, bodyforce: VectorDatum | None = None,
                     force: Mapping[str, VectorDatum] | None = None,
                     spring: Mapping[str, Datum | VectorDatum] | None = None,
                     units: tuple[str, str] | None = None, axisymmetric: bool = False) -> None: ...

    def __post_init__(self) -> None:
        if not isinstance(self.material, (HookeMaterial, AnisotropicMaterial)):
            raise ProblemError(f"material is {self.material!r}; give a HookeMaterial or an AnisotropicMaterial")
        several = isinstance(self.foundation, Sequence) and not isinstance(self.foundation, str)
        foundations = tuple(self.foundation) if several else (self.foundation,)
        if not foundations or not all(isinstance(foundation, Foundation) for foundation in foundations):
            raise ProblemError(f"foundation is {self.foundation!r}; give a Foundation or several, "
                               "a contact problem has at least one")
        object.__setattr__(self, "foundation", foundations)
        for name, convert in (("dirichlet", Vector), ("roller", Scalar), ("traction", Vector), ("force", Vector),
                              ("spring", ScalarOrVector)):
            object.__setattr__(self, name, _Regions(getattr(self, name), name, convert))
        if self.bodyforce is not None:
            object.__setattr__(self, "bodyforce", Vector(self.bodyforce, "bodyforce"))
        _CheckRevolved(self)
        object.__setattr__(self, "units", CheckUnits(self.units))
        if len({dim for _, dim in self._Dimensions()}) > 1:
            listing = ", ".join(f"{name}: {dim}" for name, dim in self._Dimensions())
            raise ProblemError(f"the data have different dimensions ({listing}); give all of them the dimension of the mesh")

    def __reduce__(self) -> tuple[Any, ...]:
        # Mapping proxies are not pickled.
        loads = (self.dirichlet, self.roller, self.traction)
        return type(self), (self.material, self.foundation, *map(dict, loads), self.bodyforce, dict(self.force),
                            dict(self.spring), self.units, self.axisymmetric)

    def _Dimensions(self) -> Iterator[tuple[str, int]]:
        for name in ("dirichlet", "traction", "force", "spring"):
            for region, value in getattr(self, name).items():
                if name == "spring" and (IsNumber(value) or value.dim == 1):
                    continue
                yield f"{name}[{region!r}]", value.dim
        if self.bodyforce is not None:
            yield "bodyforce", self.bodyforce.dim
        for foundation in self.foundation:
            if foundation.normal is not None:
                yield f"normal of foundation {foundation.boundary!r}", foundation.normal.dim
            if foundation.punch is not None:
                yield f"punch of foundation {foundation.boundary!r}", foundation.punch.dim
        if isinstance(self.material, AnisotropicMaterial) and not self.axisymmetric:
            yield "material", self.material.dim

    @property
    def dim(self) -> int | None:
        """Space dimension d of the data, or None if they do not tell."""
        return next((dim for _, dim in self._Dimensions()), None)

    @property
    def frame(self) -> Cartesian:
        """The coordinates of strain and integrals."""
        return CYLINDRICAL if self.axisymmetric else CARTESIAN

    def Solve(self, *_: object, **__: object) -> NoReturn:
        """ProblemError that says what is missing: NGSolve's `Solve(problem)` comes here."""
        raise ProblemError("a ContactProblem has neither mesh nor method, a Discretization has both; "
                           "give Solve(Discretization(problem, method, mesh, order=1))")

    def Regions(self) -> Iterator[tuple[str, str]]:
        """(kind, region) of every boundary region that is named, in the order of the arguments."""
        for kind in ("dirichlet", "roller", "traction", "force", "spring"):
            for region in getattr(self, kind):
                yield kind, region
        for foundation in self.foundation:
            yield foundation.kind, foundation.boundary

    @property
    def joints(self) -> list[str]:
        """The regions of joints."""
        return [foundation.boundary for foundation in self.foundation if foundation.kind == "joint"]


def _CheckRevolved(problem: ContactProblem) -> None:
    """Raise ProblemError unless `axisymmetric` is True or False, and what a body of revolution is made of is known in space."""
    if not isinstance(problem.axisymmetric, bool):
        raise ProblemError(f"axisymmetric is {problem.axisymmetric!r}; give True for a body of revolution, else False")
    if not problem.axisymmetric:
        return
    material = problem.material
    if material.plane == "stress" if isinstance(material, HookeMaterial) else material.dim == 2:
        raise ProblemError(f"material is {material!r}, whose hoop stress is not known, and the body is one of revolution; give "
                           "a HookeMaterial with plane='strain', which is the material in space, or an AnisotropicMaterial of "
                           "6 x 6 numbers in the order r, z, theta")
    if problem.dim == 3:
        raise ProblemError("the data have 3 components and the body is one of revolution, which does not twist: displacements, "
                           "loads and friction lie in its section; give vectors (r, z), or take the body in space for a torque")


def _Regions(values: Any, name: str, convert: Callable[..., Any]) -> Mapping[str, Any]:
    if values is None:
        return MappingProxyType({})
    if not isinstance(values, Mapping):
        raise ProblemError(f"{name} is {values!r}; give a dictionary {{region: value}}")
    return MappingProxyType({RegionName(region, name): convert(value, f"{name}[{region!r}]")
                             for region, value in values.items()})
