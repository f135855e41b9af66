"""What is given on a boundary, as the elements inside see it.

At points of boundary elements NGSolve knows no function of an L2 space, no material and no normal derivative: they count as 0,
or raise; and its normal follows the orientation of the boundary element, into the body at holes and on mirrored meshes.  The
element inside knows all of that, and its normal is outward.  What lives on the boundary alone, a BoundaryCF or a function of a
space on surfaces, would count as 0 there; it is carried to functions on facets, which both know.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from ngsolve import (BND, CF, QUAD, SEGM, TRIG, VOL, BoundaryFromVolumeCF, CoefficientFunction, ElementId, FESpace,
                     FacetFESpace, GridFunction, IfPos, IntegrationRule, Mesh, Region)

from ..contracts import Array
from ..exceptions import ProblemError
from ..tools.formula import Numeric

# Nodes of expressions that have one value on a boundary, whatever they are seen from.
EVERYWHERE = ("CoordCoefficientFunction", "ConstantCoefficientFunction", "ParameterCoefficientFunction",
              "VoxelCoefficientFunction", "ZeroCoefficientFunction")
SHELLS = ("CompiledCoefficientFunction", "GenericIdentity")     # nodes that are their one child
CARRIED = 1e-10     # relative error of a function that facets can carry
TINY = 1e-300       # what NGSolve reads where nothing was written


def FromInside(value: Any, region: Region, name: str) -> Any:
    """A CoefficientFunction for integrals ds(skeleton=True) over a region of the boundary, which see the element inside.

    value : number or CoefficientFunction;  region : mesh.Boundaries(...);  name : of the datum, for messages
    Raises ProblemError for a function that has no values there.
    """
    value = CF(value)
    return value if Numeric(value) else _Translation(region, name).Of(value)


def OnBoundary(value: Any, region: Region, name: str) -> Any:
    """The same for points of boundary elements, and for NGSolve's `Set` there."""
    value = CF(value)
    if Numeric(value):      # what NGSolve prints is a hundred times cheaper than its nodes
        return value
    translation = _Translation(region, name)
    seen = translation.Of(value)
    # Coordinates stay those of the boundary element: sqrt(1 - x) is not to fail at x = 1 by the round-off of another map.
    return value if translation.everywhere else BoundaryFromVolumeCF(seen)


def CheckMaterials(value: Any, mesh: Mesh, name: str) -> None:
    """Raise ProblemError for a MaterialCF, also within an expression, that lacks a material of the elements and is 0 there."""
    seen, waiting = {}, [value] if isinstance(value, CoefficientFunction) and not Numeric(value) else []
    while waiting:
        node = waiting.pop()
        if not isinstance(node, CoefficientFunction) or node in seen:
            continue
        kind, children = seen[node] = Parts(node)
        waiting += children
        if "DomainWise" not in kind or None not in children and len(children) >= len(mesh.GetMaterials()):
            continue
        _CheckPieces(children, {element.index for element in mesh.Elements(VOL)}, mesh.GetMaterials(), "material", name)


def _CheckPieces(children: Sequence[Any], numbers: Iterable[int], names: Sequence[str], kind: str, name: str) -> None:
    """Raise ProblemError unless a function given by materials or boundaries is given on those of these numbers."""
    missing = [number for number in numbers if number >= len(children) or children[number] is None]
    if missing:
        raise ProblemError(f"{name} has no value on {kind} {names[missing[0]]!r}; give one, or a default")


class _Translation:
    """Expressions on a region of the boundary, translated node by node.

    everywhere : False once a function was met whose value depends on what it is seen from
    """

    def __init__(self, region: Region, name: str) -> None:
        self.mesh, self.region, self.name = region.mesh, region, name
        self.everywhere = True
        self._known: dict[CoefficientFunction, CoefficientFunction] = {}

    def Of(self, node: CoefficientFunction) -> CoefficientFunction:
        """A node as the element inside sees it, itself if that needs no change."""
        if node not in self._known:
            self._known[node] = self._Translated(node)
        return self._known[node]

    def _Translated(self, node: CoefficientFunction) -> CoefficientFunction:
        if isinstance(node, GridFunction):
            return self._Function(node, node)
        kind, children = Parts(node)
        functions = [child for child in children if isinstance(child, CoefficientFunction)]
        if "GridFunctionCoefficientFunction" in kind:
            return self._Function(node, functions[0])
        if "DomainWise" in kind:
            return self._Piecewise(node, children)
        if not functions or "BoundaryFromVolume" in kind:
            if not any(name in kind for name in EVERYWHERE):
                self._CheckLeaf(node)
            return node
        if any(name in kind for name in SHELLS):
            new = self.Of(functions[0])
            return node if new is functions[0] else new
        return self._Replaced(node, functions)

    def _CheckLeaf(self, node: CoefficientFunction) -> None:
        """Raise ProblemError for a function that NGSolve does not take apart and that is 0 inside but not on the boundary."""
        self.everywhere, points = False, self._Points(1)
        inside, above = (_Values(function, points) for function in (BoundaryFromVolumeCF(node), node))
        if inside is not None and not np.any(inside) and above is not None and np.any(np.abs(above) > TINY):
            raise ProblemError(f"{self.name} contains a function with values on boundary elements only; give one that has "
                               "values in the elements too")

    def _Replaced(self, node: CoefficientFunction, functions: Sequence[CoefficientFunction]) -> CoefficientFunction:
        changed = {child: new for child in functions if (new := self.Of(child)) is not child}
        if not changed:
            return node
        try:
            return node.Replace(changed)
        except Exception as error:
            raise ProblemError(f"{self.name} combines functions of the boundary in a way that cannot be taken apart; write it "
                               "with sums, products and IfPos, and without Compile") from error

    @cached_property
    def _elements(self) -> list[tuple[Any, int]]:
        """(boundary element, number of the element inside) over the region."""
        elements = list(self.region.Elements())
        sides = [(element.edges if self.mesh.dim == 2 else element.faces)[0] for element in elements]
        return [(element, self.mesh[side].elements[0].nr) for element, side in zip(elements, sides)]

    def _Points(self, order: int) -> np.ndarray:
        rules = {et: IntegrationRule(et, order) for et in ((SEGM,) if self.mesh.dim == 2 else (TRIG, QUAD))}
        return self.mesh.MapToAllElements(rules, self.region)

    def _InsideError(self, node: CoefficientFunction) -> str | None:
        """What NGSolve says to a value inside the element at the first boundary element, or None."""
        point = self._Points(0)[:1].copy()
        point["VorB"], point["nr"] = 0, self._elements[0][1]
        for axis in "xyz"[:self.mesh.dim]:
            point[axis] = 0.2
        try:
            node(point)
        except Exception as error:
            return str(error)
        return None

    def _Function(self, node: CoefficientFunction, function: CoefficientFunction) -> CoefficientFunction:
        """A GridFunction, or a derivative of one."""
        self.everywhere, space = False, function.space
        if space.mesh != self.mesh:     # NGSolve looks up the points, in elements
            return node
        if all(_Defined(space, ElementId(VOL, inside)) for _, inside in self._elements) and not self._InsideError(node):
            return node
        if not all(_Defined(space, ElementId(BND, element.nr)) for element, _ in self._elements):
            raise ProblemError(f"{self.name} contains a GridFunction that is not defined on all of the boundary it is given "
                               "on; give one of a space on all elements there")
        carried = self._Carried(node, space.globalorder)
        if node is not function or carried is None:
            raise ProblemError(f"{self.name} contains a GridFunction of {type(space).__name__}, or its derivative, that has no "
                               "values in the elements and is no polynomial on facets; give one of a space on elements, such "
                               "as H1 or L2")
        return carried

    def _Carried(self, node: CoefficientFunction, order: int) -> GridFunction | None:
        """The same values from polynomials of this order on facets, or None if they are no such polynomials."""
        flat, components = node.Reshape((node.dim,)), []
        for number in range(node.dim):
            components.append(GridFunction(FacetFESpace(self.mesh, order=order)))
            components[-1].Set(flat[number], definedon=self.region)
        carried = CF(tuple(components), dims=tuple(node.dims)) if node.dims else components[0]
        points = self._Points(2 * order + 2)
        found, wanted = _Values(carried, points), _Values(node, points)
        if found is None or wanted is None:
            return None
        return carried if np.abs(found - wanted).max() <= CARRIED * np.abs(wanted).max() else None

    def _Piecewise(self, node: CoefficientFunction, children: Sequence[Any]) -> CoefficientFunction:
        """A function that is given by materials, or by boundaries."""
        self.everywhere = False
        bymaterial = "defined on BND" not in (self._InsideError(node) or "")
        numbers = {self.mesh[ElementId(VOL, inside)].index if bymaterial else element.index
                   for element, inside in self._elements}
        names = self.mesh.GetMaterials() if bymaterial else self.mesh.GetBoundaries()
        _CheckPieces(children, numbers, names, "material" if bymaterial else "boundary", self.name)
        if bymaterial:
            return self._Replaced(node, [child for child in children if child is not None])
        first, *others = numbers
        value = self.Of(children[first])
        for number in others:
            # A choice and no sum of products, since pieces may be infinite on each other's boundaries.
            value = IfPos(self._Indicator(number) - 0.5, self.Of(children[number]), value)
        return value

    def _Indicator(self, number: int) -> GridFunction:
        """1 on the facets of the boundary with this number, 0 on others."""
        function = GridFunction(FacetFESpace(self.mesh, order=0))
        dofs = [function.space.GetDofNrs(element)[0] for element, _ in self._elements if element.index == number]
        function.vec.FV().NumPy()[dofs] = 1
        return function


def Parts(node: CoefficientFunction) -> tuple[str, list[CoefficientFunction]]:
    """(name of the class, children) of a node; ("", []) for the few that NGSolve cannot store, which have no children."""
    try:
        parts = node.data
    except Exception:
        return "", []
    return parts["data"][:80].decode("latin1"), parts["childs"]


def _Values(function: CoefficientFunction, points: np.ndarray) -> Array | None:
    """Values at mesh points, (n,), or None where NGSolve has none."""
    try:
        return np.asarray(function(points), dtype=float).ravel()
    except Exception:
        return None


def _Defined(space: FESpace, element: Any) -> bool:
    """True if functions of the space have values on an element."""
    try:
        return space.GetFE(element).ndof > 0
    except Exception:
        return False
