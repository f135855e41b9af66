"""A clamped beam under its weight on a foundation that breaks, with friction that weakens with the slip.

Domain: (0,2) x (0,1), clamped on the left, touching the foundation (gap 0); no units.
Problem: mu = lam = 4, body force (-1.2, -0.9) times `load`; p_n(r) = 20 r up to r = 0.1 and 0 beyond; friction of the
    potential ln(1 + |u_t|), that is p_t = 8 min(r, 0.1)/(1 + |u_t|).
What to look at: for load = 1 the largest penetration is 0.045, so that the drop at 0.1 is not reached; PEER are values of
    another program for it.  Where a larger load reaches it the foundation breaks, and several solutions are possible.
Source: an example of the program conmech, P1 on a cross mesh with h = 1/4, good to about three digits.
"""

from dataclasses import dataclass

import numpy as np
from ngsolve import CF

from ngdgc import (ComplianceLaw, ContactProblem, Discretization, Foundation, FrictionLaw, HookeMaterial, InteriorPenalty,
                   UzawaSolver)
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


def Problem(load=1.0):
    foundation = Foundation("bottom", BreakingFoundation(), friction=LogarithmicFriction())
    return ContactProblem(HookeMaterial(mu=4, lam=4), foundation,
                          dirichlet={"left": CF((0, 0))}, bodyforce=load * CF((-1.2, -0.9)))


def Mesh(n=16, cells="triangle"):
    return RectangleMesh(n, upper=(2, 1), cells=cells)


def Main(*, method=InteriorPenalty(), order=1, n=16, load=1.0, cells="triangle", solver=UzawaSolver(), callback=None):
    disc = Discretization(Problem(load), method, Mesh(n, cells), order=order)
    return solver.Solve(disc, callback=callback)
