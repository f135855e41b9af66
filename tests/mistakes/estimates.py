"""Mistakes in what is estimated, as in `mistakes`."""

from mistakes import Disc
from ngsolve import BilinearForm, dx

from ngdgc import Solve
from ngdgc.estimates.residual import ResidualEstimate


def Sprung():
    """A body with springs that were added as a form."""
    disc = Disc()
    u, v = disc.space.TnT()
    return Solve(disc.Add(BilinearForm(10 * u * v * dx)))


ESTIMATES = [
    (lambda _: ResidualEstimate(Disc()), "solution is Discretization(IP | a ContactSolution, which Solve(disc) returns | give"),
    (lambda _: ResidualEstimate(Sprung()), "the solution has added forms | could be compared | estimate errors without them")]
