"""What engineers ask of a result: moments, values along a line, where a field is largest, a table of the contact points."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
from ngsolve import HEX, PRISM, PYRAMID, QUAD, TET, TRIG, VOL, IntegrationRule

from ..contact.graph import ZONES
from ..contact.memory import Memory
from ..contracts import Array
from ..discrete.state import AsRead
from ..exceptions import ProblemError
from ..mesh.facets import Coordinates
from ..tools.calls import ByKeyword
from ..tools.values import Integer, Vectors
from .fields import FieldOf, SpatialStress, VonMises
from .moments import Moment

ASIDE = 1e-9        # by which a line is moved off the sides of elements that it may run along, relative to its length


@ByKeyword
class Quantities:
    """Numbers of a ContactSolution, which inherits them."""

    disc: Any
    gfu: Any
    ElementImbalance: Any

    @cached_property
    @AsRead
    def testedfluxes(self) -> dict[str | None, Array]:
        """The numerical flux tested on the functions of V_h, {region, or None inside: (ndof,)} (`contracts.Form.Fluxes`)."""
        return dict(self.disc.form.Fluxes(self.gfu))

    @cached_property
    def worst(self) -> float:
        """The largest `ElementImbalance` of an element."""
        return float(np.abs(self.ElementImbalance()).max())

    @AsRead
    def Moment(self, region: str, *, point: Sequence[float] | None = None, material: str | None = None) -> Array:
        """Moment about a point of the force on the body through a boundary region, (1,) in 2D, (3,) in 3D [stress length^d].

        int (x - point) x sigma n of the `Traction`; point None: the origin.  Region, `material` and errors as for `Force`.
        Of a body of revolution the one that turns the section about the circle point = (r, z), which must be given, added up
        all around, int (r - r_0) t_z - (z - z_0) t_r; in equilibrium those of all regions and loads are the hoop stress's,
        -int sigma_tt (z - z_0)/r over the body.
        """
        return Moment(self, region, point, material)

    @AsRead
    def Along(self, a: Sequence[float], b: Sequence[float], n: int) -> Any:
        """Displacement and stress at n points in equal distances along the line from a to b, a structured array (n,).

        distance from a [length], point (d,), displacement (d,) [length], stress (3, 3) and vonmises [stress], the stress with
        its out-of-plane component (`SpatialStress`).  Outside of the body, in a hole say, they are nan.  A line along sides of
        elements has the values of one side.  Raises ProblemError unless a and b are different points and n at least 2.

        >>> from ngdgc.cases import example_4_2
        >>> line = example_4_2.Main(n=4).Along((0, 0.1), (1, 0.1), 3)
        >>> line["distance"].tolist(), line["stress"].shape
        ([0.0, 0.5, 1.0], (3, 3, 3))
        """
        dim, n = self.disc.mesh.dim, Integer(n, "n", "give the number of points, at least 2", least=2)
        start, end = LineEnds(a, b, dim)
        s = np.linspace(0, 1, n)
        points = LinePoints(self.disc.mesh, start + s[:, None] * (end - start), end - start)
        inside, stress = points["nr"] >= 0, SpatialStress(self)
        line = np.zeros(n, dtype=[("distance", float), ("point", float, dim), ("displacement", float, dim),
                                  ("stress", float, (3, 3)), ("vonmises", float)])
        line["distance"], line["point"] = s * np.linalg.norm(end - start), start + s[:, None] * (end - start)
        for name, function in (("displacement", self.gfu), ("stress", stress), ("vonmises", VonMises(stress))):
            line[name] = np.nan
            if inside.any():
                line[name][inside] = np.asarray(function(points[inside])).reshape(line[name][inside].shape)
        return line

    @AsRead
    def Largest(self, field: Any = "vonmises") -> tuple[float, Array]:
        """(value, place (d,)) where a field is largest: by name, as for `FieldFigure`, or a scalar CoefficientFunction.

        Of all elements, each with its own values, at 2 k + 1 points along every edge, corners included, and between.  At a
        re-entrant corner stress has no largest value: it grows with every refinement.
        """
        mesh, order = self.disc.mesh, 2 * self.disc.order
        points = mesh.MapToAllElements({et: PointsOf(et, order) for et in LATTICES}, VOL)
        values = FieldOf(self, field).At(points)
        number = int(np.argmax(values))
        return float(values[number]), np.asarray(Coordinates(mesh.dim)(points[number:number + 1])).ravel()

    @cached_property
    def _memory(self) -> Memory:
        solution: Any = self
        return Memory.Of(self.disc.contact, solution.displacement, solution._graph)

    @property
    def path(self) -> Array:
        """Sum of |change of u_t| over the increments that ended in slip, this one too, (n,) [length]."""
        return np.asarray(self._memory.path)

    @property
    def worn(self) -> Array:
        """Depth worn off by wear= of the foundation, in this increment too, (n,) [length]; `penetration` is without that."""
        return np.asarray(self._memory.worn)

    @property
    def punches(self) -> dict[str, Array]:
        """{region: displacement and rotation} of the foundations that are rigid punches, (3,) or in 3D (6,) [length], [1].

        As `Resultants` has forces and moments: along the axes, then about them, through `about` of the `RigidPunch`.
        """
        punches = self.disc.contact.punches
        return {} if punches is None else dict(zip(punches.regions, self.disc.punches))

    @AsRead
    def Table(self) -> Any:
        """The contact quantities, a structured array over the contact points, for numpy, `export.WriteCSV` or pandas.DataFrame.

        region of the foundation; x, y (, z) [length]; gap, penetration [length]; pressure [stress]; friction_x, ... on the body
        [stress]; slip_x, ... [length]; worn [length], where there is wear; zone; weight [length^(d-1)].  Of a body of
        revolution r and z in place of x and y.
        """
        solution: Any = self
        contact, axes = self.disc.contact, self.disc.problem.frame.axes[:self.disc.mesh.dim]
        regions = [(part.foundation.boundary, part.points) for part in contact.parts]
        width = max(len(name) for name, _ in regions)
        columns: dict[str, Any] = {"region": np.full(len(contact.weights), "", dtype=f"U{width}")}
        for name, here in regions:
            columns["region"][here] = name
        columns |= dict(zip(axes, solution.points.T)) | {"gap": contact.gap, "penetration": solution.penetration,
                                                         "pressure": solution.pressure}
        for name in ("friction", "slip"):
            columns |= {f"{name}_{axis}": values for axis, values in zip(axes, getattr(solution, name).T)}
        if contact.wears:
            columns["worn"] = solution.worn
        columns |= {"zone": np.array(ZONES)[solution.zones], "weight": contact.weights}
        table = np.empty(len(contact.weights), dtype=[(name, values.dtype) for name, values in columns.items()])
        for name, values in columns.items():
            table[name] = values
        return table


LATTICES = {TRIG: lambda x, y, z: (z == 0) & (x + y <= 1), QUAD: lambda x, y, z: z == 0, TET: lambda x, y, z: x + y + z <= 1,
            PRISM: lambda x, y, z: x + y <= 1, HEX: lambda x, y, z: x < 2,
            # Not the tip of a pyramid, where its map is singular.
            PYRAMID: lambda x, y, z: (np.maximum(x, y) <= 1 - z) & (z < 1)}


def PointsOf(et: Any, parts: int) -> IntegrationRule:
    """Points of equal distances, corners included, of a reference element, as a rule without weights."""
    whole = np.stack(np.meshgrid(*[np.arange(parts + 1)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    inside = LATTICES[et](*(whole / parts).T.round(12))
    points = (whole[inside] / parts)[:, :2 if et in (TRIG, QUAD) else 3]
    return IntegrationRule(points=[tuple(point) for point in points.tolist()], weights=[0.0] * len(points))


def LineEnds(a: Any, b: Any, dim: int) -> list[Array]:
    """The ends of a line, (d,) each; ProblemError unless they are two points."""
    start, end = (Vectors(point, (dim,), name, f"give its {dim} coordinates") for name, point in (("a", a), ("b", b)))
    if np.array_equal(start, end):
        raise ProblemError(f"a and b are both {tuple(start.tolist())}; give two ends of a line")
    return [start, end]


def LinePoints(mesh: Any, places: Array, along: Array) -> Any:
    """NGSolve's mesh points at places (n, d) of a line along a vector (d,): a bit aside of it, or on it if that is outside."""
    length = float(np.linalg.norm(along))
    direction = along / length
    aside = np.eye(len(direction))[np.abs(direction).argmin()]
    aside = aside - (aside @ direction) * direction
    if len(direction) == 3:     # off planes of a structured mesh, too
        aside = aside + 0.37 * np.cross(direction, aside)
    beside = mesh(*(places + ASIDE * length * aside).T)
    return np.where(beside["nr"] >= 0, beside, mesh(*places.T))
