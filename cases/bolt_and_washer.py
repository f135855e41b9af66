"""A bolt, its washer and a plate: three bodies of revolution pressed together by the preload.

Question: How does the force of a bolt spread, from its head through the washer into the plate?
Domain: half sections of a bolt of 6 mm with a head of 10 mm and 4 mm high, a washer of 12 mm and 1.6 mm thick, and a plate of
    24 mm and 8 mm thick with a hole of 6.6 mm, z = 0 below it.
Problem: steel, E = 210000, nu = 0.3 [N/mm^2]; the bolt's end is pulled down with 5000 N, the plate stands on a foundation; the
    joints "head" and "seat" press with p_n = 1e7 r and rub with the coefficient 0.15.
What to look at: every joint carries the preload, in the washer most of it near the hole; on the foundation the pressure is
    spread over a cone, and outside of it the plate lifts off.
Source: G. Niemann, Maschinenelemente, on the cone of pressure under bolts; the forces are those of equilibrium.
Ask: Which part of the seat opens without the washer?  How stiff are plate and washer together, from the preload and the means
    of u_z at "under" and below?  What does a washer of 3 mm change in the largest pressure on the plate?
"""

from netgen.occ import Glue, MoveTo

from ngdgc import (ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty, Joint,
                   NestedNewtonSolver, NormalCompliance)
from ngdgc.meshes import ShapeMesh

SHAFT, HOLE, HEAD, WASHER, PLATE = 3.0, 3.3, 5.0, 6.0, 12.0         # radii [mm]
THICK, HEIGHT, TALL = 8.0, 1.6, 4.0        # of plate, washer and head [mm]
PRELOAD, FRICTION = 5000.0, 0.15


def Problem(preload=PRELOAD, coefficient=FRICTION):
    law, friction = NormalCompliance(1e7), CoulombFriction(coefficient)
    pressed = [Joint("head", law, friction=friction), Joint("seat", law, friction=friction),
               Foundation("ground", law, friction=friction)]
    return ContactProblem(HookeMaterial(E=210000, nu=0.3), pressed, force={"end": (0, -preload)}, axisymmetric=True,
                          units=("mm", "N/mm^2"))


def Mesh(n=4):
    """About n elements through the washer."""
    top = THICK + HEIGHT
    plate = MoveTo(HOLE, 0).Rectangle(PLATE - HOLE, THICK).Face()
    washer = MoveTo(HOLE, THICK).Rectangle(WASHER - HOLE, HEIGHT).Face()
    bolt = MoveTo(0, 0).Rectangle(SHAFT, top).Face() + MoveTo(0, top).Rectangle(HEAD, TALL).Face()
    parts = {"plate": plate, "washer": washer, "bolt": bolt}
    for name, part in parts.items():
        part.faces.name = name
    body = Glue(list(parts.values()))
    for edge in body.edges:
        r, z, _ = edge.center
        inside = HOLE < r < HEAD
        edge.name = ("head" if inside and abs(z - top) < 1e-9 else "seat" if HOLE < r < WASHER and abs(z - THICK) < 1e-9
                     else "ground" if r > HOLE and z < 1e-9 else "end" if z < 1e-9 else "free")
        if edge.name in ("head", "seat"):
            edge.maxh = HEIGHT / n
    return ShapeMesh(body, PLATE / 8)


def Main(*, method=InteriorPenalty(), order=2, n=4, solver=NestedNewtonSolver(), callback=None):
    return solver.Solve(Discretization(Problem(), method, Mesh(n), order=order), callback=callback)


def Compare(solution):
    return [("force of the head on the washer [N]", float(solution.Force("head", material="washer")[1]), -PRELOAD),
            ("force of the washer on the plate [N]", float(solution.Force("seat", material="plate")[1]), -PRELOAD),
            ("force of the ground [N]", float(solution.Force("ground")[1]), PRELOAD)]
