"""A column between springs and friction, whose loop is a formula."""

from itertools import pairwise

import numpy as np
from ngsolve import CF, IfPos, Parameter
from problems import Along

from ngdgc import (ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NormalCompliance, SolveHistory)
from ngdgc.meshes import RectangleMesh

STIFFNESS = 3000.0


def test_a_column_on_shear_springs_has_the_loop_of_a_formula():
    """A block dragged to a, back to -a and to a again: its shear force is that of a spring in series with a friction element.

    With rollers at the sides and a top of one pressure P all is homogeneous: under a shear force per area F of springs k above,
    the top at s moves by F/k + F/mu (height 1) until F reaches mu_c P, backwards from the reversal on, with twice the range.
    """
    k, shear, bound, a = 50.0, 400.0, 0.3 * 20, 0.4
    stiffness = 1 / (1 / k + 1 / shear)
    path = [0, a, -a, a]
    t = Parameter(0)
    # u_x = s - F/k at the top is what a spring to a wall moved by s does: traction k s and the spring's own -k u_x.
    wide = Foundation("bottom", NormalCompliance(STIFFNESS), friction=CoulombFriction(0.3))
    sides = Spring(t, path, stiffness, bound)
    problem = ContactProblem(HookeMaterial(mu=shear, lam=0.0), wide, spring={"top": (k, 0)},
                             traction={"top": CF((k * Along(t, path), -20)), "left": CF((0, -sides)), "right": CF((0, sides))})
    times = np.linspace(0, 3, 31)[1:]
    history = SolveHistory(Discretization(problem, InteriorPenalty(), RectangleMesh(2)), parameter=t, times=times)
    expected = [Loop(time, path, stiffness, bound) for time in times]
    # Force on the body against the motion; 1e-9 the tolerance of thirty increments.
    assert np.abs(history.forces["bottom"][:, 0] + expected).max() < 1e-9 * bound
    # Control: at the same place on the way back the force is another one, by far.
    assert abs(expected[4] - expected[14]) > 0.5 * bound


def Loop(time, path, stiffness, bound):
    """The force of a spring with a friction element in series, at a displacement that goes through `path` at 0, 1, 2, ..."""
    force, last = 0.0, path[0]
    for end in [*path[1:int(time) + 1], np.interp(time, range(len(path)), path)]:
        force, last = np.clip(force + stiffness * (end - last), -bound, bound), end
    return float(force)


def Spring(t, path, stiffness, bound):
    """The same as a function of t."""
    times = sorted({*np.arange(len(path)), *Kinks(path, stiffness, bound)})
    found = CF(Loop(times[-1], path, stiffness, bound))
    for before, after in reversed(list(pairwise(times))):
        a, b = (Loop(time, path, stiffness, bound) for time in (before, after))
        found = IfPos(after - t, a + (t - before) / (after - before) * (b - a), found)
    return found


def Kinks(path, stiffness, bound):
    """The times at which the element begins to slide."""
    for number, (a, b) in enumerate(pairwise(path)):
        begin, sign = Loop(number, path, stiffness, bound), np.sign(b - a)
        yield number + (sign * bound - begin) / stiffness / (b - a)
