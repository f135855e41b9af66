"""A clamped beam under its weight on a foundation that breaks: two solutions of one problem.

Question: Is there more than one equilibrium on a foundation that breaks when it is pressed too deep?
Domain: (0,2) x (0,1), clamped on the left, touching the foundation (gap 0); no units.
Problem: mu = lam = 4, body force (-1.2, -0.9); p_n(r) = 20 r up to r = `strength` = 0.1 and 0 beyond; friction of the
    potential ln(1 + |u_t|), that is p_t = `friction` min(r, 0.1)/(1 + |u_t|) with friction = 8.
What to look at: an iteration that starts from the beam without foundation finds it broken, sunk in by 1.6.  With strength =
    infinity the largest penetration is 0.045, so this is a solution for strength = 0.1 too.  PEER are values that another
    program stores for it; they are those of friction = 0, friction = 8 halves the horizontal ones.
Source: an example of the program conmech, P1 on a cross mesh with h = 1/4, good to about three digits.
Ask: From which strength on is there only one solution?  Which of the two would a beam find that is let down slowly?  What
    do refined meshes do to the two, and to the penetration at which one of them breaks?
"""

from dataclasses import dataclass

import numpy as np
from ngsolve import CF

from ngdgc import (ComplianceLaw, ContactProblem, Discretization, Foundation, FrictionLaw, HookeMaterial, InteriorPenalty,
                   NestedNewtonSolver)
from ngdgc.meshes import RectangleMesh

PEER = {0.25: (0.0605, 0.0287), 0.5: (0.1041, 0.0358), 1.75: (0.2009, 0.0442), 2.0: (0.1979, 0.0427)}    # {x: -u(x, 0)}


@dataclass(frozen=True)
class BreakingFoundation(ComplianceLaw):
    """p_n(r) = stiffness r for 0 < r < strength, 0 beyond."""

    stiffness: float = 20.0
    strength: float = 0.1

    def Pressure(self, r):
        return np.where((r > 0) & (r < self.strength), self.stiffness * r, 0)

    def PressureDerivative(self, r):
        return np.where((r > 0) & (r < self.strength), self.stiffness, 0)


@dataclass(frozen=True)
class LogarithmicFriction(FrictionLaw):
    """p_t = stiffness min(r, limit)/(1 + |u_t|)."""

    stiffness: float = 8.0
    limit: float = 0.1

    def Bound(self, r, p):
        return self.stiffness * np.clip(r, 0, self.limit)

    def BoundDerivatives(self, r, p):
        return np.where((r > 0) & (r < self.limit), self.stiffness, 0), np.zeros_like(r)

    def Coefficient(self, slip):
        return 1 / (1 + slip), -1 / (1 + slip) ** 2


def Problem(strength=0.1, friction=8.0):
    foundation = Foundation("bottom", BreakingFoundation(strength=strength), friction=LogarithmicFriction(friction))
    return ContactProblem(HookeMaterial(mu=4, lam=4), foundation,
                          dirichlet={"left": CF((0, 0))}, bodyforce=CF((-1.2, -0.9)))


def Mesh(n=16, cells="triangle"):
    return RectangleMesh(n, upper=(2, 1), cells=cells)


def Main(*, method=InteriorPenalty(), order=1, n=16, strength=0.1, friction=8.0, cells="triangle",
         solver=NestedNewtonSolver(), callback=None):
    disc = Discretization(Problem(strength, friction), method, Mesh(n, cells), order=order)
    return solver.Solve(disc, callback=callback)
