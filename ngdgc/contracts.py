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


Datum = float | Coefficient                     # of a law, a material or a boundary condition
VectorDatum = Coefficient | Sequence[Datum]     # with d components
Regions = Mapping[str, Any]                     # what is given on boundaries, by regular expressions
