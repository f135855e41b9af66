"""Numbers, tuples and CoefficientFunctions as data: one conversion and one check for all of them."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from ngsolve import CF, CoefficientFunction, Mesh, Parameter, Region

from ..contracts import Array
from ..exceptions import ProblemError
from ..tools.values import IsNumber, Number
from .inside import FromInside, OnBoundary


LOADBONUS = 2       # quadrature degrees for loads and prescribed values that are no polynomials of the displacement's order


def Scalar(value: Any, name: str) -> float | CoefficientFunction:
    """A finite float or a scalar CoefficientFunction, else ProblemError."""
    if IsNumber(value):
        if not np.isfinite(number := float(Number(value))):
            raise ProblemError(f"{name} is {value}; give a finite number or a CoefficientFunction")
        return number
    if not isinstance(value, CoefficientFunction):
        raise ProblemError(f"{name} is {value!r}; give a number or a scalar CoefficientFunction")
    if value.is_complex:
        raise ProblemError(f"{name} is complex; give a real CoefficientFunction")
    if value.dim != 1:
        raise ProblemError(f"{name} has {value.dim} components; give a scalar")
    return value


def Vector(value: Any, name: str) -> CoefficientFunction:
    """A CoefficientFunction with 2 or 3 components; a tuple of numbers or CoefficientFunctions, or an array will do."""
    if isinstance(value, (tuple, list)) or isinstance(value, np.ndarray) and value.ndim == 1:
        value = CF(tuple(Scalar(component, f"component {number} of {name}") for number, component in enumerate(value, start=1)))
    if not isinstance(value, CoefficientFunction) or value.dim not in (2, 3):
        shape = f"{value.dim} component(s)" if isinstance(value, CoefficientFunction) else repr(value)
        raise ProblemError(f"{name} is {shape}; give a vector with one component per dimension, "
                           "for example CF((0, 0))")
    if value.is_complex:
        raise ProblemError(f"{name} is complex; give a real CoefficientFunction")
    return value


def ScalarOrVector(value: Any, name: str) -> float | CoefficientFunction:
    """What `Scalar` takes, or `Vector`: one value for every component."""
    if IsNumber(value) or isinstance(value, CoefficientFunction) and value.dim == 1:
        return Scalar(value, name)
    return Vector(value, name)


def Unfolded(value: Any) -> CoefficientFunction:
    """The same coefficient, kept by NGSolve even where it is zero: an integrand that folds to 0 is an error there."""
    return CF(value) + _Nothing(CF(value).dim)


@cache
def _Nothing(dim: int) -> CoefficientFunction:
    """0, of which NGSolve does not know that it stays 0."""
    return Parameter(0) * (CF(1) if dim == 1 else CF((1,) * dim))


def OnFacets(problem: Any, kind: str, region: str, mesh: Mesh) -> CoefficientFunction:
    """What a problem prescribes on a region, kind "dirichlet", "roller" or "spring", for integrals ds(skeleton=True)."""
    return ForFacets(getattr(problem, kind)[region], kind, region, mesh)


def ForFacets(value: Any, kind: str, region: str, mesh: Mesh) -> CoefficientFunction:
    """The same of a value that is given."""
    return Unfolded(FromInside(value, mesh.Boundaries(region), f"{kind}[{region!r}]"))


def SpringPull(problem: Any, region: str, u: CoefficientFunction, mesh: Mesh) -> CoefficientFunction:
    """(k_i u_i), minus the traction of the springs of a region on the body, for integrals ds(skeleton=True)."""
    k = OnFacets(problem, "spring", region, mesh)
    return k * u if k.dim == 1 else CF(tuple(k[axis] * u[axis] for axis in range(k.dim)))


def Pointwise(law: Any) -> bool:
    """True if some datum of the law is a CoefficientFunction, so that it can be evaluated only at points."""
    return any(isinstance(value, CoefficientFunction) for value in getattr(law, "__dict__", {}).values())


def CheckNumber(value: Any, name: str, *, above: float | None = None, least: float | None = None) -> None:
    """Range check of plain numbers; CoefficientFunctions are checked where they are evaluated."""
    if IsNumber(value):
        CheckRange(np.asarray(value), name, above=above, least=least)


def CheckRange(values: Any, name: str, *, above: float | None = None, least: float | None = None,
               Where: Callable[[Array, np.ndarray], str] = lambda values, wrong: "") -> None:
    """Raise ProblemError unless all values are finite, > above and >= least; Where(values, mask of wrong ones) says where."""
    values = np.asarray(values)
    if not np.all(np.isfinite(values)):
        raise ProblemError(f"{name} is not finite at {np.sum(~np.isfinite(values))} of {values.size} points; "
                           "look for a division by zero or a root of a negative number")
    if above is not None and np.any(values <= above):
        raise ProblemError(f"{name} is {values.min():g}{Where(values, values <= above)}; it must be greater than {above:g}")
    if least is not None and np.any(values < least):
        raise ProblemError(f"{name} is {values.min():g}; it must be at least {least:g}")


def ValuesAt(value: Any, points: np.ndarray, name: str, region: Region | None = None) -> Array:
    """Values of a number or scalar CoefficientFunction at mesh points, as a finite array (npoints,).

    region : mesh.Boundaries(...), for points on it; the values there are those inside the body
    """
    return np.full(len(points), float(value)) if IsNumber(value) else VectorsAt(value, points, name, region)[:, 0]


def EntriesAt(value: Any, points: np.ndarray, name: str, region: Region | None = None) -> Array:
    """Of a scalar what `ValuesAt` gives, (npoints,), of a vector what `VectorsAt` gives, (npoints, d)."""
    return (ValuesAt if IsNumber(value) or value.dim == 1 else VectorsAt)(value, points, name, region)


def VectorsAt(value: Any, points: np.ndarray, name: str, region: Region | None = None) -> Array:
    """Values of a vector CoefficientFunction at mesh points, as a finite array (npoints, d); `region` as for `ValuesAt`."""
    function = value if region is None else OnBoundary(value, region, name)
    try:
        values = np.asarray(function(points), dtype=float).reshape(len(points), value.dim)
    except Exception as error:
        raise ProblemError(f"{name} cannot be evaluated on the mesh: {str(error).strip()}; give a number or a "
                           "CoefficientFunction that has values there") from error
    CheckRange(values, name)
    return values
