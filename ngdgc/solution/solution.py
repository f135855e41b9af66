"""What a solver returns: fields, contact quantities, resultants, history."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import cached_property
from os import PathLike
from typing import Any

import numpy as np
from ngsolve import GridFunction, InnerProduct, Integrate

from ..contact.graph import ZONES, Distance, GraphDistance
from ..contracts import Array, Inverter
from ..discrete.state import AsRead, State
from ..exceptions import ProblemError
from ..methods.fluxes import Flux
from ..tools.calls import ByKeyword
from . import archive
from .forces import DisplacementAt, Force, Mean, TractionOn, Tractions
from .history import ContractionRates, Level, ObservedRate, Step
from .numbers import Quantities
from .report import JsonValue, Report, Summary
from .resultants import ElementImbalance, EquilibriumResidual, GlobalImbalance, Resultant, Resultants


@ByKeyword
class ContactSolution(Quantities):
    """Displacement and contact traction of a discrete problem.

    Attributes
    ----------
    disc : Discretization
    gfu : GridFunction of the displacement u_h [length];  vector : its coefficients (ndof,)
    traction : (n, d) traction t = p_n n + p_t lambda that the body exerts on the foundations at the n contact points [stress];
        the traction on the body is -t
    history : list of Step;  converged : bool;  solver : its text
    case : name of the case that `ngdgc run` solved, None elsewhere
    levels : list of Level, one for each mesh of a nested or adaptive iteration, the last one the solution's own; else empty
    estimate : of the error, an ErrorEstimate if SolveAdaptive or `ngdgc run` made one, else None
    zoneerrors : of ZoneLengths, {zone: error} by EstimateZones if `ngdgc run` made it, else None
    forceerrors : ForceEstimate if `ngdgc run --error` made it, else None
    earlier : its ContactSolutions on the meshes before, else empty

    Contact quantities are arrays over the n quadrature points of Gamma_C, whose `points` (n, d), `normals` (n, d) and `weights`
    (n,) come with them; the normals are those along which the law acts, outward or a foundation's own.

    >>> from ngdgc.cases import example_4_2
    >>> solution = example_4_2.Main(n=4)
    >>> solution.pressure.shape == solution.weights.shape
    True
    """

    def __init__(self, disc: Any, vector: Any, traction: Any, *, history: Iterable[Step] = (), converged: bool = True,
                 solver: str = "", Predict: Callable[[], float | None] | None = None, levels: Iterable[Level] = (),
                 inverse: str | None = None) -> None:
        self.disc, self.vector, self.traction = disc, np.asarray(vector), np.asarray(traction)
        self.history, self.converged, self.solver, self.Predict = list(history), converged, solver, Predict
        self.levels, self._inverse = list(levels), inverse
        self.case: str | None = None
        self.estimate: Any = None
        self.zoneerrors: dict[str, float] | None = None
        self.forceerrors: Any = None
        self.earlier: list[ContactSolution] = []

    @property
    def state(self) -> State:
        """The `State` of mesh and data that the solution belongs to."""
        return self.disc.state

    @property
    def inverse(self) -> str:
        """The name of what solved the linear equations, also where the solution was loaded and something else would now."""
        return self._inverse or self.disc.inversekind

    def __repr__(self) -> str:
        state = "" if self.converged else "not "
        return f"ContactSolution({self.disc!r}, {state}converged after {len(self.history)} iterations)"

    def __reduce_ex__(self, protocol: Any) -> Any:
        raise ProblemError("a ContactSolution belongs to a mesh and a factorised matrix, which are not copied or pickled; take "
                           "Save(folder) and ContactSolution.Load(folder, problem), or its arrays, such as traction")

    @property
    def gfu(self) -> Any:
        """u_h, a GridFunction; discontinuous ones have no values on boundaries: `Mean`, or BoundaryFromVolumeCF(gfu)."""
        self.state.CheckMesh()
        return self._gfu

    @cached_property
    def _gfu(self) -> Any:
        function = GridFunction(self.disc.space, "u")
        function.vec.FV().NumPy()[:] = self.vector
        return function

    @cached_property
    def rates(self) -> ContractionRates:
        """`ContractionRates`; the prediction costs at most 20 linear solves, and no more than the iteration took."""
        return ContractionRates(self.Predict and self.Predict(), ObservedRate(self.history))

    @property
    def strain(self) -> Any:
        """eps(u_h), CoefficientFunction (d, d); (3, 3) in the order r, z, theta for a body of revolution."""
        return self.disc.problem.frame.Strain(self.gfu)

    @property
    def stress(self) -> Any:
        """C eps(u_h), CoefficientFunction as `strain` [stress], in the elements; on boundaries take `Force` or `Traction`."""
        self.state.CheckMaterial()
        return self.disc.problem.material.Stress(self.strain)

    @cached_property
    @AsRead
    def flux(self) -> Any:
        """The numerical flux sigma_hat n on every facet, a GridFunction (d,) [stress]; see `fluxes.Flux`.  DG only."""
        return Flux(self)

    @property
    def points(self) -> Array:
        return self.disc.contact.coordinates

    @property
    def normals(self) -> Array:
        return self.disc.contact.normals

    @property
    def weights(self) -> Array:
        return self.disc.contact.weights

    @cached_property
    def displacement(self) -> Array:
        """u_h at the contact points, (n, d) [length]."""
        return self.disc.contact.Displacement(self.vector)

    @property
    def penetration(self) -> Array:
        """r = u_n - g, (n,) [length]; positive inside the foundation."""
        return self.disc.contact.Penetration(self.displacement)

    @property
    def slip(self) -> Array:
        """u_t, on rigid punches (u - M)_t, since the undeformed body, (n, d) [length]; `path` adds up that of increments."""
        return self.disc.contact.Tangential(self.displacement - self.disc.contact.moved)

    @cached_property
    def _graph(self) -> GraphDistance:
        return Distance(self.disc.contact, self.displacement, self.traction)

    @property
    def pressure(self) -> Array:
        """-sigma_n = p_n, (n,) [stress]; exactly 0 in separation and positive elsewhere, which `traction` is to round-off."""
        return self._graph.pressure

    @property
    def friction(self) -> Array:
        """sigma_t, the friction traction on the body, (n, d) [stress]; it acts against u_t, and is exactly 0 where p_t is."""
        return 0 - self._graph.friction

    @property
    def bound(self) -> Array:
        """p_t, (n,) [stress]."""
        return self.disc.contact.Bound(self.penetration, self.disc.contact.Slip(self.displacement))

    @property
    def zones(self) -> Any:
        """0 separation, 1 stick, 2 slip at the contact points, (n,); names in `ngdgc.contact.graph.ZONES`."""
        return self._graph.zones

    def ZoneLengths(self) -> dict[str, float]:
        """Length (2D) or area (3D, revolution) of each zone, {"separation": ..., "stick": ..., "slip": ...} [length^(d-1)]."""
        return {name: float(self.weights[self.zones == number].sum()) for number, name in enumerate(ZONES)}

    @cached_property
    @AsRead
    def energy(self) -> float:
        """Elastic energy, half of int C eps(u_h):eps(u_h) over the elements [stress length^d]."""
        frame = self.disc.problem.frame
        density = frame.Weighted(0.5 * InnerProduct(self.stress, self.strain))
        return float(Integrate(density, self.disc.mesh, order=2 * self.disc.order + 2 + frame.bonus))

    @cached_property
    def normalforce(self) -> float:
        """int_GammaC p_n [stress length^(d-1)]."""
        return float(self.weights @ self.pressure)

    def At(self, *point: float) -> Array:
        """u_h at a point of the body, (d,) [length]; ProblemError for a point outside of it."""
        return DisplacementAt(self, point)

    @cached_property
    @AsRead
    def facettractions(self) -> Any:
        """`tractions.FacetTractions`: tractions on all boundaries and interfaces, and their integrals over the facets."""
        return Tractions(self)

    @AsRead
    def Force(self, region: str, *, material: str | None = None) -> Array:
        """Force on the body through a boundary region, (d,) [stress length^(d-1)]: loads, reactions and contact alike.

        The integral of `Traction`, in balance to round-off, of a body of revolution over the whole ring; forces of added forms
        are not in it.  With `material`, a regular expression: on that part of the body, through the facets of the region, also
        inside the body.  There without material: on the side whose outward normal `flux` has (`interfaces.Interfaces`).

        Raises ProblemError for a region or material that is not there, or if the side cannot be told.

        >>> from ngdgc import *
        >>> from ngdgc.meshes import RectangleMesh
        >>> problem = ContactProblem(HookeMaterial(E=100, nu=0.3), Foundation("bottom", NormalCompliance(10)),
        ...                          dirichlet={"top": (0, -0.1)})
        >>> solution = Solve(Discretization(problem, Conforming(), RectangleMesh(4), order=2))
        >>> bool(abs(solution.Force("bottom")[1] - solution.normalforce) < 1e-12), solution.Force("left|right").tolist()
        (True, [0.0, 0.0])
        """
        return Force(self, region, material)

    def Mean(self, region: str) -> Array:
        """Mean displacement of a boundary region, (d,) [length]; inside the body the mean of both sides."""
        return Mean(self, region)

    @AsRead
    def Traction(self, region: str) -> Any:
        """sigma n on a boundary region, a CoefficientFunction (d,) [stress] for boundary integrals and boundary points.

        The numerical flux `flux`, or of Conforming C eps(u_h) n corrected to balance (`conformingtractions`), f_2 and -t.
        Integrate(solution.Traction("left"), mesh, definedon=mesh.Boundaries("left")) is Force("left"), on curved boundaries up
        to quadrature.
        """
        return TractionOn(self, region)

    def Resultants(self) -> list[Resultant]:
        """Force and moment of every support, load and foundation, a list of `Resultant`."""
        return self._resultants

    @cached_property
    @AsRead
    def _resultants(self) -> list[Resultant]:
        return Resultants(self)

    def GlobalImbalance(self) -> float:
        """Largest component of the sum of all forces and moments, relative to the largest one."""
        return GlobalImbalance(self)

    @AsRead
    def ElementImbalance(self) -> Array:
        """Unbalanced force and moment per element, (elements, 3 or 6), relative; DG only, H1 balances globally."""
        return ElementImbalance(self)

    @AsRead
    def EquilibriumResidual(self) -> float:
        """|A u - f + T' W t| relative to its terms, no unit: how well the linear equations are solved."""
        return EquilibriumResidual(self.disc, self.vector, self.traction)

    def Report(self) -> str:
        """A page of text: what was solved, how the iteration went, what happens on Gamma_C, forces and balance."""
        return Report(self)

    def ToJSON(self) -> dict[str, Any]:
        """The numbers of the report as a dictionary of plain types, for json.dump; `report.SCHEMA` says what they are.

        Numbers that are not finite, which JSON has not, are None.
        """
        return JsonValue(Summary(self))

    def Save(self, folder: str | PathLike[str]) -> None:
        """Write mesh, coefficients, traction, history and summary into `folder` (vol.gz, npz, json; no pickle).

        With them goes what tells the discrete problem from others: regions, data at points, laws at several depths and slips.
        What was saved there before is replaced at the end, or kept if that fails.  Raises ProblemError if the folder cannot be
        written, and for what a file cannot keep: a method of your own, a deformation of the mesh.
        """
        with self.state.Restored():
            archive.Keep(self, folder)

    @classmethod
    def Load(cls, folder: str | PathLike[str], problem: Any, *, added: Sequence[Any] = (),
             inverse: str | Inverter | None = None) -> ContactSolution:
        """The solution saved in `folder`; CoefficientFunctions are not stored, so the problem is given again.

        added : the forms that `disc.Add` was given, as forms on a space of the same mesh, method and order, or as functions of
            the space that make them: added=[lambda space: BilinearForm(...)]
        inverse : as for Discretization, for what is solved from now on; None: as it was, or "auto" if the solution was saved
            with one of your own, of which a file has only the name

        Raises ProblemError if the folder holds no solution, a damaged one, or one of another problem: all data are compared to
        six digits, contact law and balance are verified.
        """
        disc, arrays, words = archive.Open(folder, problem, added, inverse)
        history, levels, predicted = archive.Iteration(folder, arrays, words)
        numbering = archive.Numbering(folder, disc, arrays)
        solution = cls(disc, arrays["vector"][numbering], arrays["traction"], history=history, converged=words["converged"],
                       solver=words["solver"], Predict=lambda: predicted, levels=levels,
                       inverse=words["summary"].get("inverse"))
        archive.Compare(folder, solution, arrays, numbering)
        return solution


def CheckSolution(solution: Any, name: str = "solution") -> None:
    """Raise ProblemError unless it is a ContactSolution."""
    if not isinstance(solution, ContactSolution):
        raise ProblemError(f"{name} is {solution!r}; give a ContactSolution, which Solve(disc) returns")
