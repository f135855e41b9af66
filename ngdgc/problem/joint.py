"""Two parts of a body that press against each other across an interface inside the mesh."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

from ..contracts import Compliance, Datum, Friction, Wear
from ..data.coefficients import Scalar
from ..tools.calls import ByKeyword
from .foundation import Foundation


@ByKeyword
@dataclass(frozen=True, repr=False)
class Joint(Foundation):
    """The laws of a `Foundation` on the interface `boundary` inside the body, whose sides come apart there.

    With the jump [u] = u(first) - u(second) and n the outward normal of the first side, whose material comes first in
    mesh.GetMaterials() (`interfaces.Interfaces`; between parts of one material, of the element with the smaller number at its
    first boundary element):

        r = [u].n - g,    t = p_n(r) n + t_t,    |t_t| <= p_t,    friction acts along -[u]_t

    so that pressing together is positive and g >= 0 the distance of the two sides before.  The second side feels t, the first
    one -t [stress].  What a solution has on a foundation it has on a joint, `displacement` and `slip` being those of [u].

    `tension` T [stress] bonds the sides: p(r) = p_n(r + r_0) - T with p_n(r_0) = T, so that p(0) = 0.  The joint then pulls as
    it presses, and opens at the constant tension T, its cut-off; it is elastic, and bonds again where it closes.  Friction is
    p_t of r + r_0 and p + T: Coulomb's has the cohesion mu T, with the cut-off at the apex of the cone of Mohr and Coulomb.

    A joint may end inside the body; parts that hang together by joints alone are held by them as by foundations, each with its
    own free motions.  Discontinuous methods leave the joint out of E0 (assembly="facet"); for Conforming nodes are doubled
    along it on a copy of the mesh, which is solution.disc.mesh.

    Raises ProblemError as `Foundation` does.

    >>> from ngdgc import NormalCompliance
    >>> Joint("fault", NormalCompliance(450), gap=0.05)
    Joint(boundary='fault', compliance=NormalCompliance(stiffness=450.0, exponent=1), gap=0.05, tension=0.0)
    """

    normal: Any = field(init=False, default=None)
    punch: Any = field(init=False, default=None)
    tension: Any = 0.0      # type: ignore[misc]
    kind: ClassVar[str] = "joint"

    if TYPE_CHECKING:
        def __init__(self, boundary: str, compliance: Compliance, friction: Friction | None = None,
                     gap: Datum = 0.0, wear: Wear | None = None, tension: Datum = 0.0) -> None: ...

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "tension", Scalar(self.tension, f"tension of joint {self.boundary!r}"))
