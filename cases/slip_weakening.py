"""A slab dragged over a base whose friction weakens with slip: for one pull it may stick or slip.

Question: At which pull does the slab break loose, and at which does it come to rest again when the pull is taken back?
Domain: (0,100) x (0,20) [mm]; its top is moved as a whole, by `pull` to the right and 0.01 mm down.
Problem: plane strain, E = 10, nu = 0.3 [N/mm^2]; p_n = 1 r; friction coefficient mu(s) = 0.3 + 0.5 exp(-s/0.001).
What to look at: the slab is a spring of stiffness G/H, softer than friction weakens, 0.5 p/0.001: between two pulls it has a
    state that sticks and one that slips, and `Path` takes the one that is near where it comes from.  Its edges, where the
    pressure is uneven, let it loose earlier than the formula, which knows no edges.
Source: the slider of J. R. Rice, A. L. Ruina, J. Appl. Mech. 50 (1983), without rates: G (pull - s)/H = mu(s) p.
Ask: Between which pulls are there two solutions?  Which law of friction without a jump makes the path unique?  How does the
    picture change when the slab is twice as high?
"""

import numpy as np
from ngsolve import CF

from ngdgc import (ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty, NestedNewtonSolver,
                   NormalCompliance, SemismoothNewtonSolver, SlipWeakeningFriction)
from ngdgc.exceptions import NotConvergedError
from ngdgc.meshes import RectangleMesh

LENGTH, HEIGHT, DOWN = 100.0, 20.0, 0.01
RUBBER = HookeMaterial(E=10, nu=0.3)
FRICTION = SlipWeakeningFriction(static=0.8, dynamic=0.3, distance=0.001)


def Problem(pull=0.013, friction=FRICTION):
    foundation = Foundation("bottom", NormalCompliance(stiffness=1), friction=friction)
    return ContactProblem(RUBBER, foundation, dirichlet={"top": CF((pull, -DOWN))})


def Mesh(n=16, cells="triangle"):
    return RectangleMesh(n, upper=(LENGTH, HEIGHT), cells=cells)


def Main(*, method=InteriorPenalty(), order=2, n=16, pull=0.013, friction=FRICTION, cells="triangle",
         solver=NestedNewtonSolver(), callback=None):
    disc = Discretization(Problem(pull, friction), method, Mesh(n, cells), order=order)
    return solver.Solve(disc, callback=callback)


def Path(pulls, *, method=InteriorPenalty(), order=2, n=16):
    """Solutions for one pull after the other, each found from the one before; a list."""
    found, mesh = [], Mesh(n)
    for pull in pulls:
        disc = Discretization(Problem(pull), method, mesh, order=order)
        start = (found[-1].displacement, found[-1].traction) if found else None
        try:
            found.append(SemismoothNewtonSolver().Solve(disc, start=start))
        except NotConvergedError:       # nothing is near: the slab jumps
            found.append(NestedNewtonSolver().Solve(disc))
    return found


def Jumps(pressure, friction=FRICTION):
    """(pull at which a slab without edges breaks loose, pull at which it comes to rest) [mm], under a pressure [N/mm^2]."""
    slip = np.linspace(0, 20 * friction.distance, 100001)
    pull = slip + friction.Coefficient(slip)[0] * pressure * HEIGHT / RUBBER.mu
    return float(pull[0]), float(pull.min())


def Compare(solution):
    """The force of the states of a slab without edges that is nearest; the pull is that of the top."""
    friction = solution.disc.problem.foundation[0].friction
    pull = float(solution.At(LENGTH / 2, HEIGHT)[0])
    force = float(-solution.weights @ solution.friction[:, 0])
    slip = np.linspace(0, pull, 100001)
    elastic = RUBBER.mu * (pull - slip) / HEIGHT * LENGTH
    excess = elastic - friction.Coefficient(slip)[0] * solution.normalforce
    states = elastic[:-1][excess[:-1] * excess[1:] <= 0]
    if excess[0] < 0:
        states = np.append(states, elastic[0])
    return [("friction force [N/mm]", force, float(states[np.abs(states - force).argmin()]))]
