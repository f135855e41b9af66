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

LENGTH, STRESS = "[length]", "[stress]"
ENTRIES = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))      # of a symmetric matrix


@dataclass(frozen=True)
class Field:
    """A scalar function on the elements, its symbol on axes, in plain text, and its unit."""

    name: str
    function: Any
    symbol: str
    plain: str
    unit: str

    @property
    def label(self) -> str:
        """Of an axis."""
        return f"{self.symbol} {self.unit}".strip()

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


def _Names(solution: Any) -> dict[str, tuple[Callable[[], Any], str, str, str]]:
    """{name: (how to make the function, symbol, plain words, unit)}."""
    dim, axes = solution.disc.mesh.dim, solution.disc.problem.frame.axes
    def Component(i: int) -> Any:
        return solution.gfu[i]

    def Entry(i: int, j: int) -> Any:
        return SpatialStress(solution)[i, j]

    names: dict[str, tuple[Callable[[], Any], str, str, str]] = {
        "displacement": (lambda: Norm(solution.gfu), "|u|", "|u|", LENGTH)}
    for i, axis in enumerate(axes[:dim]):
        names[f"u{axis}"] = partial(Component, i), f"$u_{axis}$", f"u{axis}", LENGTH
    for name, words, Make in (("vonmises", "von Mises stress", VonMises), ("meanstress", "mean stress", _Mean)):
        names[name] = partial(_Of, Make, solution), words, words, STRESS
    for i, j in ENTRIES:
        if i == j or j < dim:
            pair = axes[i] + axes[j]
            symbol = pair.replace("t", r"\theta")
            names[f"s{pair}"] = partial(Entry, i, j), f"$\\sigma_{{{symbol}}}$", f"s{pair}", STRESS
    return names


def FieldOf(solution: Any, field: Any) -> Field:
    """The `Field` of a solution that is meant: one of its own by name, or any scalar CoefficientFunction on its mesh.

    Names: displacement (|u|), ux, uy, uz; vonmises, meanstress (tr(sigma)/3), sxx, syy, szz, sxy, sxz, syz.  In 2D szz is
    the stress across the plane, as for `SpatialStress`.  Of a body of revolution: ur, uz, srr, szz, srz, and stt around.
    """
    names = _Names(solution)
    if isinstance(field, str):
        name = Known(field, names, what="field")
        Make, *words = names[name]
        return Field(name, Make(), *words)
    if not isinstance(field, CoefficientFunction):
        raise ProblemError(f"field is {field!r}; give a CoefficientFunction, or one of {', '.join(names)}")
    if field.dim != 1:
        raise ProblemError(f"field has {field.dim} components; give one of them, or Norm(field)")
    for leaf in Leaves(field):
        if isinstance(leaf, GridFunction) and leaf.space.mesh != solution.disc.mesh:
            raise ProblemError(f"field has a GridFunction on another mesh, of {leaf.space.mesh.ne} elements, than the "
                               f"solution, which has {solution.disc.mesh.ne}; give a field on solution.disc.mesh")
    return Field("of your own", field, "field", "field", "")


def _Mean(stress: Any) -> Any:
    return Trace(stress) / 3


def _Of(Make: Callable[[Any], Any], solution: Any) -> Any:
    return Make(SpatialStress(solution))


@ByKeyword
def SpatialStress(solution: Any) -> Any:
    """C eps(u_h) as a CoefficientFunction (3, 3) [stress].

    In 2D the out-of-plane component is that of the material: lam tr(eps) in plane strain, 0 in plane stress, and 0 for an
    AnisotropicMaterial, whose plane matrix does not tell; of a body of revolution the hoop stress, after r and z.

    >>> from ngdgc.cases import example_4_2
    >>> solution = example_4_2.Main(n=4)
    >>> SpatialStress(solution)(solution.disc.mesh(0.5, 0.5))[2::3]
    (0.0, 0.0, 0.0)
    """
    stress, material = solution.stress, solution.disc.problem.material
    if stress.dims[0] == 3:
        return stress
    strained = isinstance(material, HookeMaterial) and material.plane == "strain"
    normal = material.lam * Trace(solution.strain) if strained else CF(0)
    return CF((stress[0, 0], stress[0, 1], 0, stress[1, 0], stress[1, 1], 0, 0, 0, normal), dims=(3, 3))


@ByKeyword
def VonMises(stress: Any) -> Any:
    """sqrt(3/2 s:s) with the deviator s = sigma - tr(sigma)/3 I, for sigma of shape (3, 3) [stress].

    >>> from ngsolve import CF, Mesh, unit_square
    >>> mesh = Mesh(unit_square.GenerateMesh(maxh=1))
    >>> round(VonMises(CF((3, 0, 0, 0, 0, 0, 0, 0, 0), dims=(3, 3)))(mesh(0.5, 0.5)), 12)
    3.0
    """
    return sqrt(1.5 * InnerProduct(stress, stress) - 0.5 * Trace(stress)**2)
