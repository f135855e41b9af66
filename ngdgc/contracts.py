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
    """A normal law: see `laws.ComplianceLaw`."""

    def Pressure(self, r: Any) -> Any: ...

    def PressureDerivative(self, r: Any) -> Any: ...


class Friction(Protocol):
    """A friction law: see `laws.FrictionLaw`."""

    def Bound(self, r: Any, p: Any) -> Any: ...


class Wear(Protocol):
    """A wear law: see wear= of `foundation.Foundation`."""

    def Depth(self, p: Any, slip: Any) -> Any: ...


class Certainty(Protocol):
    """What is known of the coercivity of a form: see `methods.guarantee.Guarantee`."""

    @property
    def holds(self) -> bool: ...

    @property
    def kappa(self) -> float | None: ...

    @property
    def culprit(self) -> str: ...

    @property
    def remedy(self) -> str: ...


class Form(Protocol):
    """B_h of a method on a mesh, before assembly; vectors (ndof,) are coefficients of the functions of V_h.

    guarantee : what is known of its coercivity; an eigenvalue computation decides where that is not certain
    consistent : Has it the term -<[v],{C eps(u)}>?  lifted : Is that (C eps(u), r_0[v]) instead, as a `FluxForm` has it?
    Matrix : B_h, NGSolve's sparse matrix on V_h;  Norm : the energy norm g_h + stabilisation, against which coercivity counts
    Prescribed : the loads of displacements that are prescribed weakly, {region: (ndof,)}
    Fluxes : sigma_hat n tested with the jumps of V_h, {region with weak displacements, or None between elements: (ndof,)}; of a
        conservative method A u - sum of Fluxes = int C eps(u):eps(v) for rigid v on each element, that is 0
    """

    @property
    def guarantee(self) -> Certainty: ...

    @property
    def consistent(self) -> bool: ...

    @property
    def lifted(self) -> bool: ...

    def Matrix(self) -> Any: ...

    def Norm(self) -> Any: ...

    def Prescribed(self) -> dict[str, Array]: ...

    def Fluxes(self, gfu: Any) -> dict[Any, Array]: ...


class FluxForm(Form, Protocol):
    """A form with a numerical flux: that of a conservative method for assembly="facet".

    operators : F_h and its blocks, `blocks.operators.FacetOperators`
    FluxFunction : sigma_hat n, a GridFunction in F_h with the normal outward of the element with the smaller number [stress]
    """

    @property
    def operators(self) -> Any: ...

    def FluxFunction(self, gfu: Any) -> Any: ...


class Method(Protocol):
    """A method, and what others ask of it, each question by itself.

    name : as tables print it
    discontinuous : Do the functions of V_h jump between elements?  Then it is VectorL2 on `ScalarSpace`.
    weak : Are displacements on Gamma_D imposed by terms of the form?  Else the dofs of V_h have them.
    conservative : Is every element in balance with the numerical flux of the form, a `FluxForm`?
    iterative : Does the cycle of `linear.multigrid` precondition A, if that is symmetric?
    symmetric : Is B_h(u, v) = B_h(v, u)?
    Space : V_h of order k, NGSolve's space, whose dofs on the boundaries `clamped` ("a|b") are not free unless they are weak
    ScalarSpace : the space of its components
    Form : B_h with E0 = interior facets, Gamma_D and rollers, a `Form`; assembly is "facet" or "skeleton"

    A method that can be compared, copied and saved is a frozen dataclass.
    """

    @property
    def name(self) -> str: ...

    @property
    def discontinuous(self) -> bool: ...

    @property
    def weak(self) -> bool: ...

    @property
    def conservative(self) -> bool: ...

    @property
    def iterative(self) -> bool: ...

    @property
    def symmetric(self) -> bool: ...

    def Space(self, mesh: Any, order: int, clamped: str) -> Any: ...

    def ScalarSpace(self, mesh: Any, order: int) -> Any: ...

    def Form(self, problem: Any, facets: Any, space: Any, order: int, assembly: str) -> Form: ...


def Missing(given: Any, contract: type) -> list[str]:
    """Members of a contract that an object has not, sorted; what a class computes when it is asked for is not computed."""
    asked = {name for name in (*dir(contract), *contract.__annotations__) if not name.startswith("_")} - set(dir(given))
    return [name for name in sorted(asked) if not hasattr(given, name)]


class Solver(Protocol):
    """A solver: as those of the `solvers` package, given wherever there is an argument solver=."""

    def Solve(self, disc: Any, *, callback: Any = None) -> Any:
        """The ContactSolution of a Discretization, or NotConvergedError; callback gets every `solution.history.Step`."""
        ...


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

    It is called for A, and for A + T' W D T with the stiffness D of Gamma_C; the matrix is not changed, and kept as long as the
    inverse.  Coarser meshes, which only predict, are solved by "auto".  It may have these attributes, else they count as False:

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


class LinearProblem(Protocol):
    """A u = f - T' W t as Newton's method sees it: a `DiscreteProblem` or a `solvers.newton.subspace.Subspace`.

    matrix : NGSolve's A;  load : f (ndof,);  prescribed : function with the strongly prescribed values (ndof,), or 0
    contact : Gamma_C with T and its adjoint T' W;  shift : displacement there that is not in the space (n, d), or 0
    motions : (m, ndof), rigid motions that A does not resist;  unresisted : words for them, or None;  resultant : of f (d,)
    inverse : A^-1;  solves, cycles, factorisation : what inverses have cost;  unknowns : how many equations
    FactoriseSum : the inverse of A and a matrix of `contact.Stiffness`;  Norm : the Euclidean norm of a vector
    """

    @property
    def matrix(self) -> Any: ...

    @property
    def mesh(self) -> Any: ...

    @property
    def problem(self) -> Any: ...

    @property
    def order(self) -> int: ...

    @property
    def load(self) -> Any: ...

    @property
    def prescribed(self) -> Any: ...

    @property
    def contact(self) -> Any: ...

    @property
    def shift(self) -> Any: ...

    @property
    def motions(self) -> Any: ...

    @property
    def unresisted(self) -> Any: ...

    @property
    def resultant(self) -> Any: ...

    @property
    def inverse(self) -> Any: ...

    @property
    def solves(self) -> int: ...

    @property
    def cycles(self) -> int: ...

    @property
    def factorisation(self) -> float: ...

    def Multiply(self, vector: Array) -> Array: ...

    @property
    def unknowns(self) -> int: ...

    def Norm(self, vector: Array) -> float: ...

    def FactoriseSum(self, added: Any) -> Inverse: ...

    def ApplyInverse(self, inverse: Inverse, load: Array) -> Array: ...

    def Iterate(self, inverse: InexactInverse, load: Array, *, tol: float, start: Array) -> Array: ...


class SpaceNumbering(Protocol):
    """How `blocks`, `linear` and `contact` number the dofs of V_h: by components, each as its scalar space does.

    Of an element GetDofNrs gives those of the first component in the order of the scalar space, then those of the others,
    shifted by the ndof of the scalar space each; ndof is d times that.  `conformance.CheckSpaceNumbering` compares.
    """

    @property
    def ndof(self) -> int: ...

    @property
    def mesh(self) -> Any: ...

    def GetDofNrs(self, element: Any, /) -> Any: ...

    def Elements(self, vb: Any, /) -> Any: ...

    def FreeDofs(self) -> Any: ...


Datum = float | Coefficient                     # of a law, a material or a boundary condition
VectorDatum = Coefficient | Sequence[Datum]     # with d components
Regions = Mapping[str, Any]                     # what is given on boundaries, by regular expressions
