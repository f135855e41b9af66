"""Fields of a solution by their names: displacements, stresses, and what is made of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from ngsolve import CF, CoefficientFunction, GridFunction, InnerProduct, Norm, Trace, sqrt

from ..contracts import Array
from ..discrete.state import Leaves
from ..exceptions import ProblemError
from ..problem.materials import HookeMaterial
from ..tools.calls import ByKeyword
from ..tools.names import Known

DIRECTIONS = "xyz"
ENTRIES = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))      # of a symmetric matrix


@dataclass(frozen=True)
class Field:
    """A scalar function on the elements, and the words that an axis has for it."""

    name: str
    function: Any
    label: str

    def At(self, points: Any) -> Array:
        """Values at points in elements, (n,); ProblemError unless they are finite numbers."""
        try:
            values = np.asarray(self.function(points))
        except Exception as error:
            raise ProblemError(f"field {self.name} cannot be evaluated in the elements: {str(error).strip()}; give a "
                               "CoefficientFunction that has values there") from error
        values = values.reshape(len(points))
        if values.dtype.kind not in "fi" or not np.all(np.isfinite(values)):
            raise ProblemError(f"field {self.name} is not a finite real number everywhere; look for a division by zero, a root "
                               "of a negative number, or a part that is complex")
        return values


def _Names(solution: Any) -> dict[str, tuple[str, Callable[[], Any]]]:
    """{name: (label, how to make the function)}."""
    dim = solution.disc.mesh.dim
    def Component(i: int) -> Any:
        return solution.gfu[i]

    def Entry(i: int, j: int) -> Any:
        return SpatialStress(solution)[i, j]

    names: dict[str, tuple[str, Callable[[], Any]]] = {
        "displacement": ("|u| [length]", lambda: Norm(solution.gfu))}
    for i, axis in enumerate(DIRECTIONS[:dim]):
        names[f"u{axis}"] = f"$u_{axis}$ [length]", partial(Component, i)
    names["vonmises"] = "von Mises stress [stress]", lambda: VonMises(SpatialStress(solution))
    names["meanstress"] = "mean stress [stress], tension positive", lambda: Trace(SpatialStress(solution)) / 3
    for i, j in ENTRIES:
        if i == j or j < dim:
            pair = DIRECTIONS[i] + DIRECTIONS[j]
            names[f"s{pair}"] = f"$\\sigma_{{{pair}}}$ [stress]", partial(Entry, i, j)
    return names


def FieldOf(solution: Any, field: Any) -> Field:
    """The `Field` of a solution that is meant: one of its own by name, or any scalar CoefficientFunction on its mesh.

    Names: displacement (|u|), ux, uy, uz; vonmises, meanstress (tr(sigma)/3), sxx, syy, szz, sxy, sxz, syz.  In 2D szz is
    the stress across the plane, as for `SpatialStress`.
    """
    names = _Names(solution)
    if isinstance(field, str):
        name = Known(field, names, what="field")
        label, Make = names[name]
        return Field(name, Make(), label)
    if not isinstance(field, CoefficientFunction):
        raise ProblemError(f"field is {field!r}; give a CoefficientFunction, or one of {', '.join(names)}")
    if field.dim != 1:
        raise ProblemError(f"field has {field.dim} components; give one of them, or Norm(field)")
    for leaf in Leaves(field):
        if isinstance(leaf, GridFunction) and leaf.space.mesh != solution.disc.mesh:
            raise ProblemError(f"field has a GridFunction on another mesh, of {leaf.space.mesh.ne} elements, than the "
                               f"solution, which has {solution.disc.mesh.ne}; give a field on solution.disc.mesh")
    return Field("of your own", field, "field")


@ByKeyword
def SpatialStress(solution: Any) -> Any:
    """C eps(u_h) as a CoefficientFunction (3, 3) [stress].

    In 2D the out-of-plane component is that of the material: lam tr(eps) in plane strain, 0 in plane stress, and 0 for an
    AnisotropicMaterial, whose plane matrix does not tell.
    """
    stress, material = solution.stress, solution.disc.problem.material
    if solution.disc.mesh.dim == 3:
        return stress
    strained = isinstance(material, HookeMaterial) and material.plane == "strain"
    normal = material.lam * Trace(solution.strain) if strained else CF(0)
    return CF((stress[0, 0], stress[0, 1], 0, stress[1, 0], stress[1, 1], 0, 0, 0, normal), dims=(3, 3))


@ByKeyword
def VonMises(stress: Any) -> Any:
    """sqrt(3/2 s:s) with the deviator s = sigma - tr(sigma)/3 I, for sigma of shape (3, 3) [stress]."""
    return sqrt(1.5 * InnerProduct(stress, stress) - 0.5 * Trace(stress)**2)
