"""Objects that do not keep their contracts, as in `mistakes`; `test_conformance` has one for each question that is asked."""

from types import SimpleNamespace

from mistakes import Disc

from ngdgc.conformance import CheckInverse, CheckSolver


def Unchanged(matrix, free, disc):
    """The identity is no inverse."""
    return SimpleNamespace(Solve=lambda load: load)


CONTRACTS = [
    (lambda _: CheckInverse(lambda *made: 3, Disc()), "what <lambda> makes, int | has no Solve | give it, as contracts"),
    (lambda _: CheckInverse(Unchanged, Disc()), "inverse=Unchanged | A x = b is to hold to 1e-10 | solve more accurately"),
    (lambda _: CheckSolver(SimpleNamespace(Solve=lambda disc: None), Disc()),
     "solver SimpleNamespace.Solve | raises TypeError | let it take a Discretization and callback")]
