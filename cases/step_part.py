"""A bearing block from a STEP file, screwed down on a soft pad.

Question: Which part of the load on a bearing goes through the pad below it, and which through its screws?
Domain: the solid in step_part.step, beside this file: a block of 100 x 30 x 12 [mm] and on it a bearing with a bore of radius
    14; the names of its faces, "pad", "screw", "bore" and "free", are in the file.
Problem: aluminium, E = 70000, nu = 0.33 [N/mm^2]; the walls of the screw holes are fixed; 6 kN downwards in the bore; pad
    p_n = 300 r, friction coefficient 0.4.
What to look at: pad and screws share the load like springs side by side: on a pad ten times as soft, or as stiff, they change
    roles.  The pad is pressed under the bearing, less at the screws.
Source: balance of forces; the file was written by `Write`.
Ask: How large does the stiffness of the pad have to be to carry half of the load?  Which screw carries most, and why?  What
    is the part of the load through the pad if the pad ends below the bearing?
"""

from math import pi
from pathlib import Path

from netgen.occ import Box, Cylinder, OCCGeometry, Pnt, Y, Z
from ngsolve import CF

from ngdgc import (ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NestedNewtonSolver, NormalCompliance)
from ngdgc.meshes import ShapeMesh

FILE = Path(__file__).with_name("step_part.step")
LOAD, RADIUS, DEPTH, HEIGHT = 6e3, 14.0, 30.0, 34.0     # [N], and of the bore [mm]


def Write(path=FILE):
    """Make the solid with netgen.occ, name its faces and write it as a STEP file; returns the solid."""
    bearing = Cylinder(Pnt(50, 0, HEIGHT), Y, r=24, h=DEPTH) + Box(Pnt(26, 0, 6), Pnt(74, DEPTH, HEIGHT))
    part = Box(Pnt(0, 0, 0), Pnt(100, DEPTH, 12)) + bearing - Cylinder(Pnt(50, -1, HEIGHT), Y, r=RADIUS, h=DEPTH + 2)
    for place in (12, 88):
        part -= Cylinder(Pnt(place, DEPTH / 2, -1), Z, r=4, h=14)
    for face in part.faces:
        x, y, z = face.center
        inside = abs(y - DEPTH / 2) < 1e-6
        face.name = ("pad" if z < 1e-6 else "screw" if inside and min(abs(x - 12), abs(x - 88)) < 1e-6 and abs(z - 6) < 1e-6
                     else "bore" if inside and abs(x - 50) < 1e-6 and abs(z - HEIGHT) < 1e-6 else "free")
    part.WriteStep(str(path))
    return part


def Problem(stiffness=300):
    foundation = Foundation("pad", NormalCompliance(stiffness), friction=CoulombFriction(0.4))
    return ContactProblem(HookeMaterial(E=70000, nu=0.33), foundation, dirichlet={"screw": CF((0, 0, 0))},
                          traction={"bore": CF((0, 0, -LOAD / (2 * pi * RADIUS * DEPTH)))}, units=("mm", "N/mm^2"))


def Mesh(n=10, order=2):
    """Elements of at most the n-th part of the block's length, their boundary of degree `order`."""
    return ShapeMesh(OCCGeometry(str(FILE)).shape, 100 / n, order=order)


def Main(*, method=InteriorPenalty(), order=2, n=10, stiffness=300, solver=NestedNewtonSolver(), callback=None):
    disc = Discretization(Problem(stiffness), method, Mesh(n, order), order=order)
    return solver.Solve(disc, callback=callback)


def PadShare(solution):
    """Force on the pad over the load, no unit."""
    return solution.normalforce / LOAD


def Compare(solution):
    """Balance of the vertical forces; the share of the pad is `PadShare`."""
    screws = sum(resultant.force[2] for resultant in solution.Resultants() if resultant.kind == "dirichlet")
    return [("force of screws and pad [N]", float(screws) + solution.normalforce, LOAD)]
