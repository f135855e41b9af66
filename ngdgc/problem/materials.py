"""Linear elastic materials: sigma = C eps(u), with C as in (2.11) of Xiao, Wang, Han 2018."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import TYPE_CHECKING, Any

import numpy as np
from ngsolve import CF, VOL, ElementId, Grad, Id, Mesh, Sym, Trace

from ..contracts import Array, Datum
from ..data.coefficients import CheckNumber, CheckRange, IsNumber, Scalar, ValuesAt
from ..exceptions import ProblemError
from ..tools.calls import ByKeyword
from ..tools.formula import Described
from ..tools.values import Among, Number


def Strain(u: Any) -> Any:
    """eps(u) = (grad u + grad u^T)/2, of a trial or test function or a GridFunction; shape (d, d), no unit."""
    return Sym(Grad(u))


def StiffnessAt(material: HookeMaterial | AnisotropicMaterial, points: Any, dim: int) -> Array:
    """C_ijkl at mesh points, (npoints, d, d, d, d) [stress]; ProblemError if it is not finite."""
    C = np.empty((len(points), dim, dim, dim, dim))
    if type(material) is HookeMaterial and IsNumber(material.mu) and IsNumber(material.lam):
        C[:] = _OfNumbers(material.mu, material.lam, dim)
    else:
        for k in range(dim):
            for m in range(k, dim):
                unit = np.zeros((dim, dim))
                unit[k, m] += 0.5
                unit[m, k] += 0.5
                stress = material.Stress(CF(tuple(unit.ravel()), dims=(dim, dim)))
                C[..., k, m] = C[..., m, k] = np.asarray(stress(points)).reshape(-1, dim, dim)
    if not np.all(np.isfinite(C)):
        raise ProblemError("the material is not finite at some quadrature point of the elements or facets; look for a "
                           "division by zero or a root of a negative number")
    return C


@lru_cache(64)
@np.errstate(invalid="ignore")      # of infinite ones, which are refused
def _OfNumbers(mu: float, lam: float, dim: int) -> Array:
    """lam delta_ij delta_kl + mu (delta_ik delta_jl + delta_il delta_jk), (d, d, d, d), which takes NGSolve milliseconds."""
    one = np.eye(dim)
    return lam * np.multiply.outer(one, one) + mu * (np.einsum("ik,jl->ijkl", one, one) + np.einsum("il,jk->ijkl", one, one))


def MaterialWords(mesh: Mesh, points: Any, values: Array, wrong: Array) -> str:
    """Words for the first material in which values at points are wrong (a mask); none if the mesh has one material."""
    names = mesh.GetMaterials()
    if len(names) < 2:
        return ""
    element = ElementId(VOL, int(points["nr"][np.argmax(wrong)]))
    hint = ", as where a MaterialCF has neither value nor default" if values[np.argmax(wrong)] == 0 else ""
    return f" in material {names[mesh[element].index]!r}{hint}"


@ByKeyword
@dataclass(frozen=True, kw_only=True)
class HookeMaterial:
    """Isotropic material, C eps = lam tr(eps) I + 2 mu eps.

    Either Young's modulus `E` [stress] and Poisson's ratio `nu`, or Lame's `mu` and `lam` [stress]; each a number
    or a scalar CoefficientFunction.  With plane="strain" (2D and 3D) lam = E nu/((1+nu)(1-2nu)); with
    plane="stress" (2D only) lam is replaced by lam* = 2 lam mu/(lam + 2 mu).  After construction `mu` and `lam`
    are the two coefficients that act in C.

    Raises ProblemError for an incomplete pair, E <= 0, nu outside (-1, 1/2), mu <= 0 or 3 lam + 2 mu <= 0.

    >>> HookeMaterial(E=2500, nu=0.25).mu
    1000.0
    """

    E: Any = None
    nu: Any = None
    mu: Any = None
    lam: Any = None
    plane: str = "strain"

    if TYPE_CHECKING:       # what is given; mu and lam are computed
        def __init__(self, *, E: Datum | None = None, nu: Datum | None = None, mu: Datum | None = None,
                     lam: Datum | None = None, plane: str = "strain") -> None: ...

    def __repr__(self) -> str:
        return Described(self, *(("mu", "lam") if self.E is None else ("E", "nu")), "plane")

    def __post_init__(self) -> None:
        if not Among(self.plane, ("strain", "stress")):
            raise ProblemError(f"plane={self.plane!r}; choose 'strain' or 'stress'")
        given = {name for name in ("E", "nu", "mu", "lam") if getattr(self, name) is not None}
        if given == {"E", "nu"}:
            E, nu = Scalar(self.E, "E"), Scalar(self.nu, "nu")
            CheckNumber(E, "E", above=0)
            CheckNumber(nu, "nu", above=-1)
            if IsNumber(nu) and nu >= 0.5:
                raise ProblemError(f"nu is {nu:g}; it must be less than 0.5 (0.4999 is nearly incompressible)")
            mu, lam = E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu))
        elif given == {"mu", "lam"}:
            mu, lam = Scalar(self.mu, "mu"), Scalar(self.lam, "lam")
            CheckNumber(mu, "mu", above=0)
            if IsNumber(mu) and IsNumber(lam):
                CheckNumber(3 * lam + 2 * mu, "3*lam + 2*mu", above=0)
        else:
            raise ProblemError(f"HookeMaterial got {sorted(given) or 'nothing'}; give E and nu, or mu and lam")
        if self.plane == "stress":
            lam = 2 * lam * mu / (lam + 2 * mu)
        for name in ("E", "nu"):
            if IsNumber(value := getattr(self, name)):
                object.__setattr__(self, name, Number(value))
        object.__setattr__(self, "mu", mu)
        object.__setattr__(self, "lam", lam)

    def Stress(self, strain: Any) -> Any:
        """C strain, shape (d, d) [stress]."""
        return self.lam * Trace(strain) * Id(strain.dims[0]) + 2 * self.mu * strain

    @property
    def bonus(self) -> int:
        """Quadrature degrees that integrals with C need beyond those of the displacement: 2 if C varies in space."""
        return 0 if IsNumber(self.mu) and IsNumber(self.lam) else 2

    def OtherStress(self, strain: Any) -> Any:
        """C strain with the coefficients of the neighbour across a facet, in skeleton integrals."""
        mu, lam = (value if IsNumber(value) else value.Other() for value in (self.mu, self.lam))
        return lam * Trace(strain) * Id(strain.dims[0]) + 2 * mu * strain

    def ShearAt(self, points: Any) -> Array:
        """mu at mesh points, shape (npoints,) [stress]: the scale of the paper's penalty."""
        return ValuesAt(self.mu, points, "mu")

    def Check(self, mesh: Mesh, points: Any) -> None:
        """Raise ProblemError unless C is finite and positive definite at the points."""
        if mesh.dim == 3 and self.plane == "stress":
            raise ProblemError("plane='stress' on a mesh of dimension 3; plane stress exists in 2D only, take plane='strain'")
        Where = partial(MaterialWords, mesh, points)
        mu, lam = ValuesAt(self.mu, points, "mu"), ValuesAt(self.lam, points, "lam")
        if self.nu is not None:
            nu = ValuesAt(self.nu, points, "nu")
            CheckRange(nu, "nu", above=-1, Where=Where)
            CheckRange(0.5 - nu, "0.5 - nu", above=0, Where=Where)
            CheckRange(ValuesAt(self.E, points, "E"), "E", above=0, Where=Where)
        CheckRange(mu, "mu", above=0, Where=Where)
        # d = 2, plane strain: the plane part alone must be positive, which is weaker than the 3D condition.
        CheckRange(mesh.dim * lam + 2 * mu, f"{mesh.dim}*lam + 2*mu", above=0, Where=Where)


@ByKeyword
@dataclass(frozen=True)
class AnisotropicMaterial:
    """General C, given by its symmetric positive definite Voigt matrix [stress].

    2D: 3 x 3 acting on (e11, e22, 2 e12); 3D: 6 x 6 acting on (e11, e22, e33, 2 e23, 2 e13, 2 e12); bodies of revolution: the
    same in the order r, z, theta, so that rows and columns 4 and 5 are for twist, and couple with no others.
    Entries are numbers or scalar CoefficientFunctions.

    Raises ProblemError for a wrong shape, an unsymmetric or an indefinite matrix.

    >>> AnisotropicMaterial([[3, 1, 0], [1, 3, 0], [0, 0, 1]]).dim
    2
    """

    voigt: Any

    if TYPE_CHECKING:
        def __init__(self, voigt: Sequence[Sequence[Datum]]) -> None: ...

    def __post_init__(self) -> None:
        try:
            rows = tuple(tuple(row) for row in self.voigt)
        except TypeError:
            raise ProblemError(f"voigt is {self.voigt!r}; give a 3 x 3 (2D) or 6 x 6 (3D) matrix") from None
        if len(rows) not in (3, 6) or any(len(row) != len(rows) for row in rows):
            raise ProblemError(f"voigt has {len(rows)} rows of lengths {[len(row) for row in rows]}; "
                               "it must be 3 x 3 (2D) or 6 x 6 (3D)")
        entries = tuple(tuple(Scalar(entry, f"voigt[{i}][{j}]") for j, entry in enumerate(row))
                        for i, row in enumerate(rows))
        object.__setattr__(self, "voigt", entries)
        if all(IsNumber(entry) for row in entries for entry in row):
            self._CheckMatrices(np.array(entries)[None])

    @property
    def dim(self) -> int:
        return 2 if len(self.voigt) == 3 else 3

    @property
    def _pairs(self) -> list[tuple[int, int]]:
        return [(0, 0), (1, 1), (0, 1)] if self.dim == 2 else [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]

    def _Contract(self, strain: Any, entries: Any) -> Any:
        strains = [strain[i, j] if i == j else 2 * strain[i, j] for i, j in self._pairs]
        stresses = [sum(c * e for c, e in zip(row, strains)) for row in entries]
        index = {frozenset(pair): number for number, pair in enumerate(self._pairs)}
        d = self.dim
        return CF(tuple(stresses[index[frozenset((i, j))]] for i in range(d) for j in range(d)), dims=(d, d))

    def Stress(self, strain: Any) -> Any:
        """C strain, shape (d, d) [stress]."""
        return self._Contract(strain, self.voigt)

    @property
    def bonus(self) -> int:
        """Quadrature degrees that integrals with C need beyond those of the displacement: 2 if C varies in space."""
        return 0 if all(IsNumber(entry) for row in self.voigt for entry in row) else 2

    def OtherStress(self, strain: Any) -> Any:
        """C strain with the coefficients of the neighbour across a facet, in skeleton integrals."""
        return self._Contract(strain, [[entry if IsNumber(entry) else entry.Other() for entry in row]
                                       for row in self.voigt])

    def ShearAt(self, points: Any) -> Array:
        """Largest of the shear moduli C_ijij, i != j, at mesh points, shape (npoints,) [stress]."""
        shear = range(self.dim, len(self.voigt))
        return np.max([ValuesAt(self.voigt[i][i], points, f"voigt[{i}][{i}]") for i in shear], axis=0)

    def Check(self, mesh: Mesh, points: Any) -> None:
        """Raise ProblemError unless C is finite, symmetric and positive definite at the points."""
        self._CheckMatrices(np.moveaxis(np.array(
            [[ValuesAt(entry, points, f"voigt[{i}][{j}]") for j, entry in enumerate(row)]
             for i, row in enumerate(self.voigt)]), 2, 0), partial(MaterialWords, mesh, points))

    @staticmethod
    def _CheckMatrices(matrices: Array, Where: Callable[..., str] = lambda values, wrong: "") -> None:
        asymmetry = np.abs(matrices - np.swapaxes(matrices, 1, 2)).max()
        # Round-off of entries that are computed, not typed.
        if asymmetry > 1e-12 * np.abs(matrices).max():
            raise ProblemError(f"voigt is not symmetric: entries differ by {asymmetry:g}; give a matrix equal to "
                               "its transpose, C_ijkl = C_klij")
        smallest = np.linalg.eigvalsh(matrices)[:, 0]
        if np.any(smallest <= 0):
            raise ProblemError(f"voigt is not positive definite: its smallest eigenvalue is {smallest.min():g}"
                               f"{Where(smallest, smallest <= 0)}; all must be "
                               "positive, so that every strain costs energy: look at signs and at the order of the entries")
