"""A lug with fillets and holes, bolted onto a gasket and pulled: a part made with Netgen's OpenCascade geometry.

Question: Does the foot of the lug lift off its gasket, or slip, when it is pulled obliquely?
Domain: a foot of 80 x 50 x 10 [mm] with two bolt holes and, for the washers, raised rings around them; on it, with fillets, a
    lug with a hole at the height 38.
Problem: steel, E = 210000, nu = 0.3 [N/mm^2]; each bolt presses its ring with 10 kN, the pull in the hole of the lug is
    (1.5, 0, 14) kN; gasket p_n = 20 r, friction coefficient 0.3.
What to look at: nothing but the gasket holds the part: of 20 kN there are 6 left to press it, and these act 9.5 mm off the
    middle.  A rigid foot would lift off nowhere, as its core reaches to 80/6 = 13.3 mm; the elastic one bends too.
Source: balance of forces and moments; a part of this project.
Ask: At which bolt force does the foot lift off somewhere?  Does it slip first, or lift off?  Which of the two would a rigid
    foot tell you wrong?
"""

from netgen.occ import Box, Cylinder, Pnt, Y, Z

from ngdgc import (ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NestedNewtonSolver, NormalCompliance)
from ngdgc.meshes import ShapeMesh

BOLTS, BORE, RING, EYE, HEIGHT, THICKNESS = (12, 68), 4.0, 9.0, 8.0, 38.0, 12.0     # two places x, radii, the lug's hole [mm]
TENSION, PULL = 10e3, (1.5e3, 0.0, 14e3)


def Part():
    """The solid, with names of its faces: "gasket", "bolt", "eye" and "free"."""
    foot, lug = Box(Pnt(0, 0, 0), Pnt(80, 50, 10)), Box(Pnt(25, 19, 5), Pnt(55, 19 + THICKNESS, 52))
    part = foot + lug
    corners = [edge for edge in part.edges
               if abs(edge.center.z - 10) < 1e-6 and 1 < edge.center.x < 79 and 1 < edge.center.y < 49]
    part = part.MakeFillet(corners, 6)
    for place in BOLTS:
        part += Cylinder(Pnt(place, 25, 5), Z, r=RING, h=6)
    for place in BOLTS:
        part -= Cylinder(Pnt(place, 25, -1), Z, r=BORE, h=13)
    part -= Cylinder(Pnt(40, 0, HEIGHT), Y, r=EYE, h=50)
    for face in part.faces:
        x, y, z = face.center
        face.name = ("gasket" if z < 1e-6 else "bolt" if abs(z - 11) < 1e-6
                     else "eye" if abs(x - 40) < 1e-6 and abs(z - HEIGHT) < 1e-6 and abs(y - 25) < 1e-6 else "free")
    return part


def Problem(coefficient=0.3):
    foundation = Foundation("gasket", NormalCompliance(stiffness=20), friction=CoulombFriction(coefficient))
    return ContactProblem(HookeMaterial(E=210000, nu=0.3), foundation, force={"bolt": (0, 0, -2 * TENSION), "eye": PULL},
                          units=("mm", "N/mm^2"))


def Mesh(n=8, order=2):
    """Elements of at most the n-th part of the foot's length, their boundary of degree `order`."""
    return ShapeMesh(Part(), 80 / n, order=order)


def Main(*, method=InteriorPenalty(), order=2, n=8, solver=NestedNewtonSolver(), callback=None):
    disc = Discretization(Problem(), method, Mesh(n, order), order=order)
    return solver.Solve(disc, callback=callback)


def Compare(solution):
    """Balance: what the bolts press and the pull takes away, and where that acts."""
    force = 2 * TENSION - PULL[2]
    pressed = solution.weights * solution.pressure
    return [("force on the gasket [N]", solution.normalforce, force),
            ("friction force [N]", float(solution.weights @ solution.friction[:, 0]), -PULL[0]),
            ("centre of the pressure [mm]", float(pressed @ solution.points[:, 0] / pressed.sum()),
             40 + PULL[0] * HEIGHT / force)]
