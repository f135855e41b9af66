"""Derivatives of CoefficientFunctions along the axes, also of those that are made of GridFunctions."""

from __future__ import annotations

from typing import Any

from ngsolve import CF, CoefficientFunction, Grad, GridFunction, grad, x, y, z
from ngsolve.comp import GridFunctionCoefficientFunction

from ..exceptions import ProblemError
from ..tools.calls import ByKeyword
from ..tools.formula import Plain
from .inside import Parts

AXES = (x, y, z)
REMEDY = ("give an expression of x, y, z and GridFunctions, without gradients of GridFunctions, normals, voxels, CacheCF and "
          "Freeze")
# Functions without parts whose derivatives are known; NGSolve takes others, such as voxels, for constants.
KNOWN = ("Coord", "Constant", "Parameter", "Zero", "Identity", "UnitVector", "GridFunction")
TAKEN = "BoundaryFromVolume", "RealCF", "ImagCF"    # functions of others that it differentiates in part


@ByKeyword
def Derivative(value: Any, axis: int, name: str = "the function") -> Any:
    """d value/dx_axis of a CoefficientFunction, of its shape.

    NGSolve's `Diff` alone takes a GridFunction for a constant; by the chain rule, with D the derivative in a direction,

        d/dx f(x, g) = d_x f + D_g f [d_x g],      d_x g from NGSolve's Grad in every element.

    Raises ProblemError for what has no such derivative: gradients of GridFunctions, frozen functions, normals, voxels.

    >>> from ngsolve import H1, GridFunction
    >>> from ngdgc.meshes import RectangleMesh
    >>> mesh = RectangleMesh(2)
    >>> square = GridFunction(H1(mesh, order=2))
    >>> square.Set(x * x)
    >>> round(Derivative(y * square, 0)(mesh(0.5, 0.75)), 12), (y * square).Diff(x)(mesh(0.5, 0.75))
    (0.75, 0.0)
    """
    functions = _Functions(value, name)
    try:
        total = value.Diff(AXES[axis])
        for function in functions:
            variable = (1 * function).MakeVariable()
            total = total + value.Replace({function: variable}).Diff(variable, _Slope(function, axis))
    except Exception as error:
        raise ProblemError(f"{name} has no symbolic derivative ({str(error).strip()}); {REMEDY}") from error
    return total


def _Functions(value: Any, name: str) -> list[CoefficientFunction]:
    """The different GridFunctions, or operators of GridFunctions, in the tree of a CoefficientFunction."""
    seen, waiting = {}, [] if Plain(value) else [value]
    while waiting:
        node = waiting.pop()
        if node is None or node in seen:
            continue
        seen[node] = isinstance(node, (GridFunction, GridFunctionCoefficientFunction))
        if not seen[node]:
            kind, parts = Parts(node)
            if not (parts or any(one in kind for one in KNOWN)) or any(one in kind for one in TAKEN):
                raise ProblemError(f"{name} has no symbolic derivative (a part of it is known at points only); {REMEDY}")
            waiting += parts
    return [node for node, found in seen.items() if found]


def _Slope(function: CoefficientFunction, axis: int) -> CoefficientFunction:
    if function.dim == 1:
        return grad(function)[axis]
    return CF(tuple(Grad(function)[number, axis] for number in range(function.dim)))
