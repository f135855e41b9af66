"""Newton's method from several starts: is there more than one solution?"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..contact.graph import Scales
from ..contact.stiffness import BodyStiffness
from ..contracts import Array
from ..discrete.problem import DiscreteProblem
from ..exceptions import NotConvergedError
from ..linear.equations import CheckDiscretization
from ..solution.solution import ContactSolution
from ..tools.calls import ByKeyword
from ..tools.values import Integer
from .newton.solver import SemismoothNewtonSolver

DISTINCT = 1e-6     # relative distance of displacements on Gamma_C that tells solutions apart


@ByKeyword
def MultiStart(disc: DiscreteProblem, *, count: int = 8, seed: int = 0, tol: float = 1e-10) -> list[ContactSolution]:
    """Different solutions of a discrete problem, a list of ContactSolution, found by Newton's method from `count` starts.

    The first start is rest; the others are tractions up to the size of those that the body would need to stay in contact
    everywhere, smooth and random along Gamma_C, from the generator numpy.random.default_rng(seed). Solutions whose
    displacements on Gamma_C differ by less than 1e-6 of their size count as one. An empty list means that no start led to a
    solution; one solution is no proof that there is only one, two are a proof that there are two (to the tolerance of their
    equations).

    >>> from ngsolve import CF
    >>> from ngdgc import *
    >>> from ngdgc.meshes import RectangleMesh
    >>> problem = ContactProblem(HookeMaterial(E=100, nu=0.3), Foundation("bottom", NormalCompliance(10)),
    ...                          dirichlet={"top": CF((0, -0.1))})
    >>> len(MultiStart(Discretization(problem, LDG(), RectangleMesh(4), order=1), count=3))
    1
    """
    CheckDiscretization(disc)
    count = Integer(count, "count", "give the number of starts, a positive integer")
    seed = Integer(seed, "seed", "give an integer of at least 0", least=0)
    solver = SemismoothNewtonSolver(tol=tol)
    found: list[ContactSolution] = []
    for start in [None, *Starts(disc, count - 1, seed)]:
        try:
            solution = solver.Solve(disc, start=start)
        except NotConvergedError:
            continue
        size, _ = Scales(disc.contact, solution.displacement, solution.traction)
        if all(np.abs(solution.displacement - other.displacement).max() > DISTINCT * size for other in found):
            found.append(solution)
    return found


def Starts(disc: DiscreteProblem, count: int = 5, seed: int = 0) -> Iterator[tuple[Array, Array]]:
    """`count` random pairs (displacement, traction), (n, d) each."""
    contact, rng = disc.contact, np.random.default_rng(seed)
    size = np.ptp(contact.coordinates, axis=0).max()
    place = (contact.coordinates - contact.coordinates.min(axis=0)) / size
    # A body of this extent feels tractions of the size shear modulus times strain; the strain is that of the gap and the loads.
    strain = max(np.abs(contact.gap).max(), np.abs(disc.prescribed).max(initial=0), 1e-3 * size) / size
    stress = BodyStiffness(disc).min() * strain * size
    for number in range(count):
        waves = rng.standard_normal((3, contact.dim)) @ (np.pi * (1 + number % 3) * np.eye(contact.dim))
        field = np.cos(place @ waves.T + rng.uniform(0, 2 * np.pi, 3)) @ rng.standard_normal((3, contact.dim))
        traction = 10.0 ** rng.uniform(-3, 1) * stress * field
        pressure = np.abs(contact.Normal(traction))
        yield contact.gap[:, None] * contact.normals, contact.Tangential(traction) + pressure[:, None] * contact.normals
