"""What arguments have to offer, in words for type checkers: any object with these methods will do.

NGSolve's classes have no types of their own, so a checker takes every one of its objects for a `Coefficient`.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


class Coefficient(Protocol):
    """An NGSolve CoefficientFunction, with what the package asks it for."""

    @property
    def dim(self) -> int: ...

    @property
    def is_complex(self) -> bool: ...

    def __call__(self, points: Any, /) -> Any: ...


class Compliance(Protocol):
    """A normal law: see `foundation.ComplianceLaw`."""

    def Pressure(self, r: Any) -> Any: ...

    def PressureDerivative(self, r: Any) -> Any: ...


class Friction(Protocol):
    """A friction law: see `foundation.FrictionLaw`."""

    def Bound(self, r: Any, p: Any) -> Any: ...


class Method(Protocol):
    """A method of the `methods.rows` module."""

    @property
    def name(self) -> str: ...

    @property
    def discontinuous(self) -> bool: ...

    @property
    def symmetric(self) -> bool: ...

    def Space(self, mesh: Any, order: int, clamped: str) -> Any: ...

    def ScalarSpace(self, mesh: Any, order: int) -> Any: ...

    def Form(self, problem: Any, facets: Any, space: Any, order: int, assembly: str) -> Any: ...


class Solver(Protocol):
    """A solver of the `solvers` package."""

    def Solve(self, disc: Any, *, callback: Any = None) -> Any: ...


class Inverse(Protocol):
    """A^-1 on the free dofs of one matrix: made by an `Inverter`, applied by `LinearEquations.ApplyInverse`."""

    def Solve(self, load: Array, /) -> Array:
        """x (ndof,) with A x = load (ndof,) on the free dofs to 1e-10 of the load, 0 on the others; the load is not changed."""
        ...


class InexactInverse(Inverse, Protocol):
    """An `Inverse` that iterates: `LinearEquations.Iterate` asks it for as much as is needed."""

    @property
    def iterations(self) -> int:
        """Steps of all solves so far."""
        ...

    def Solve(self, load: Array, /, *, tol: float = ..., start: Array | None = ...) -> Array:
        """The same with |load - A x| <= tol |load|, from a start (ndof,) near the solution; without them as any `Inverse`."""
        ...


class Inverter(Protocol):
    """What is given as inverse=: a function, or a class, that makes an `Inverse` of NGSolve's matrix and its free dofs.

    It is called for A, and for A + T' W D T with the stiffness D of Gamma_C; the matrix is kept as long as the inverse.  It may
    have these attributes, else they count as False:

    symmetric : it is for symmetric positive definite matrices alone
    iterates : it makes `InexactInverse`s, for symmetric discontinuous methods; contact is then solved in a subspace
    name : what reports call it, else that of the function or class
    """

    def __call__(self, matrix: Any, free: Any, disc: Any, /) -> Inverse: ...


class Preconditioner(Protocol):
    """P near A^-1, linear, symmetric and positive definite, such as NGSolve's own; called by `ConjugateGradients`."""

    def Mult(self, b: Any, x: Any, /) -> None:
        """x = P b, NGSolve's vectors."""
        ...


class PreconditionerMaker(Protocol):
    """What is given as preconditioner=: makes a `Preconditioner` of a matrix, its free dofs and the Discretization."""

    def __call__(self, matrix: Any, free: Any, disc: Any, /) -> Preconditioner: ...


Datum = float | Coefficient                     # of a law, a material or a boundary condition
VectorDatum = Coefficient | Sequence[Datum]     # with d components
Regions = Mapping[str, Any]                     # what is given on boundaries, by regular expressions
