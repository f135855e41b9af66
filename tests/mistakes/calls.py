"""Calls with other arguments than there are, and objects that cannot be copied, as in `mistakes`."""

import copy
import pickle

from mistakes import Disc

from ngdgc import (LDG, CheckLaws, ContactSolution, Discretization, HookeMaterial, NormalCompliance, NotConvergedError, Solve,
                   SolveInterrupted)
from ngdgc.meshes import RectangleMesh

CALLS = [
    (lambda _: HookeMaterial(2000, 0.3), "HookeMaterial(...): 2000, 0.3 by position | given by name | E=2000, nu=0.3"),
    (lambda _: Discretization(None, LDG(), None, 2), "Discretization(...): 2 by position | give it by name | order=2"),
    (lambda _: LDG(30), "LDG(...): 30 by position | its arguments are given by name | penalty=30"),
    (lambda _: RectangleMesh(2, cell="quad"), "no argument 'cell' | choose among n, lower, upper | did you mean 'cells'?"),
    (lambda _: HookeMaterial(poisson=0.3), "HookeMaterial | no argument 'poisson' | choose among E, nu, mu, lam"),
    (lambda _: Solve(Disc()).Report(width=3), "Report(...) | there is no argument 'width' | leave it out"),
    (lambda _: NormalCompliance(1, stiffness=3), "stiffness is given twice | by position and by name | give it once"),
    (lambda _: NormalCompliance(1, 2, 3), "3 by position are too many | it takes stiffness, exponent | leave out the rest"),
    (lambda _: NormalCompliance(1).Pressure(2 ** 63), "r is 9223372036854775808 | real numbers, an array | give"),
    (lambda _: ContactSolution.Load("results"), "Load(...) | problem missing | give problem=..."),
    (lambda _: CheckLaws(), "CheckLaws(...) | compliance missing | give compliance=..."),
    (lambda _: NotConvergedError("slow", 3), "solution is 3 | a ContactSolution | give"),
    (lambda _: SolveInterrupted(None), "solution is None | a ContactSolution | give"),
    (lambda _: pickle.dumps(Solve(Disc())), "a ContactSolution belongs to a mesh | not copied or pickled | take Save(folder)"),
    (lambda _: copy.copy(Disc()), "a Discretization has a mesh | not copied or pickled | make another one")]
