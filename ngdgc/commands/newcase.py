"""The command `ngdgc new`: a case to begin with, which runs as it is and says what may be changed."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from ..exceptions import ProblemError
from .arguments import Commands
from .files import Files

TEMPLATE = '''"""A rubber block pressed and dragged over a rough plate.

Question: What do you want to know?  Here: where does the block slip?
Domain: a rectangle of 20 x 10 [mm]; boundaries "bottom", "right", "top", "left".
Problem: E = 5 MPa, nu = 0.45; the top is pressed down and dragged; friction coefficient 0.4 below.
What to look at: slip begins at the edges.
Source: who has done this before, or what is known exactly.

    ngdgc check {name}      what acts where, size, time and memory, a picture of the setting
    ngdgc run {name}        solve, and write report, pictures, VTK files and the solution into results/
"""

from ngsolve import CF, x, y  # noqa: F401: data may depend on the place: gap=0.01 * x**2, dirichlet={{"top": CF((0.1 * y, 0))}}

from ngdgc import (ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NestedNewtonSolver, NormalCompliance)
from ngdgc.meshes import RectangleMesh

UNITS = ("mm", "MPa")       # of all numbers below; they say what axes and reports are in, nothing is converted


def Mesh(n=16):
    """n: cells along a side, from --n."""
    return RectangleMesh(n, lower=(0, 0), upper=(20, 10))
    # A file of Gmsh, Abaqus or Netgen beside this one, whose groups are the regions (`ngdgc mesh part.msh` lists them):
    #   from pathlib import Path
    #   from ngdgc.meshes import ReadMesh
    #   return ReadMesh(Path(__file__).with_name("part.msh"))
    # A shape of netgen.occ, or of a STEP file, whose edges or faces have names:
    #   from netgen.occ import OCCGeometry
    #   from ngdgc.meshes import ShapeMesh
    #   return ShapeMesh(OCCGeometry("part.step").shape, maxh=20 / n, order=2)


def Problem():
    material = HookeMaterial(E=5, nu=0.45, plane="strain")      # or plane="stress"; in 3D without it
    foundation = Foundation(
        "bottom",                                   # the boundary that may touch; others are free unless they are named below
        NormalCompliance(stiffness=50),             # p_n = 50 r [MPa] at the penetration r [mm]
        friction=CoulombFriction(0.4),              # or TrescaFriction(bound); None: no friction
        gap=0)                                      # [mm] along the outward normal
    return ContactProblem(
        material, foundation,
        dirichlet={{"top": CF((1, -0.5))}},           # displacement [mm], all components
        # roller={{"left": 0}},                       # displacement along the normal alone, as on planes of symmetry
        # traction={{"right": CF((0.1, 0))}},         # force per area [MPa]
        # force={{"right": (1, 0)}},                  # total on a region [N/mm] in the plane, [N] in space
        # bodyforce=CF((0, -1e-5)),                 # force per volume [N/mm^3]
        units=UNITS)


def Main(*, method=InteriorPenalty(), order=2, n=16, solver=NestedNewtonSolver(), callback=None):
    """What `ngdgc run` calls, with its options --method, --order, --n and --solver; returns the solution."""
    disc = Discretization(Problem(), method, Mesh(n), order=order)
    return solver.Solve(disc, callback=callback)


def Compare(solution):
    """Numbers beside what they should be, at the end of a run; this function may be left out."""
    pressed = solution.Force("top")[1]
    return [("force on the plate [N/mm]", solution.normalforce, -pressed)]
'''


def AddNew(commands: Commands) -> None:
    """The parser of the command, added to those of the command line."""
    new = commands.add_parser("new", help="write a case to begin with, which you change",
                              description="Write a file with a small case that can be run at once; its comments say what may "
                              "be changed.")
    new.add_argument("case", help="the file to write, such as block.py; one that is there is kept")
    new.set_defaults(command=New)


def New(options: Namespace) -> int:
    """Write the file and say what comes next."""
    path = Path(options.case)
    if path.suffix != ".py":
        raise ProblemError(f"{options.case!r} is no name of a case; give one that ends in .py, such as block.py")
    if path.exists():
        raise ProblemError(f"{options.case} is there already and is kept; give another name")
    with Files(path.parent, option="name") as files:
        files.Text(path.name, TEMPLATE.format(name=options.case))
    print(f"next: ngdgc check {options.case}, change it in an editor, ngdgc run {options.case}")
    return 0
