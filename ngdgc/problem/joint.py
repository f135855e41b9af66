"""Two parts of a body that press against each other across an interface inside the mesh."""

from __future__ import annotations

from dataclasses import dataclass

from ..exceptions import ProblemError
from ..tools.calls import ByKeyword
from .foundation import Foundation


@ByKeyword
@dataclass(frozen=True, repr=False)
class Joint(Foundation):
    """The laws of a `Foundation` on the interface `boundary` inside the body, whose sides come apart there.

    With the jump [u] = u(first) - u(second) and n the outward normal of the first side, whose material comes first in
    mesh.GetMaterials():

        r = [u].n - g,    t = p_n(r) n + t_t,    |t_t| <= p_t,    friction acts along -[u]_t

    so that pressing together is positive.  The second side feels t, the first -t.  Raises ProblemError as `Foundation` does.

    >>> from ngdgc import NormalCompliance
    >>> Joint("fault", NormalCompliance(450), gap=0.05).gap
    0.05
    """

    def __post_init__(self) -> None:
        if self.normal is not None:
            raise ProblemError(f"joint {self.boundary!r} has a normal; n of a joint is that of its first side: leave it out")
        super().__post_init__()
