"""Mistakes with solutions, pictured or compared, as in `mistakes`."""

import numpy as np
from mistakes import Block, Disc
from ngsolve import CF, Grad, VoxelCoefficient, x
from problems import Example

from ngdgc import EstimateError, Solve
from ngdgc.errors import EnergyError, L2Error, StrainError
from ngdgc.export import Animation, WriteSeries
from ngdgc.plots import ComparisonFigure, DeformedFigure, ErrorFigure, FieldFigure, LineFigure, MeshFigure, SettingFigure

RESULTS = [
    # Pictures.
    (lambda _: ComparisonFigure([]), "solutions is [] | a dictionary of ContactSolutions by their labels | give"),
    (lambda _: ComparisonFigure({"plane": Solve(Disc()), "solid": Solve(Block())}),
     "solution 'solid' has | the first one | compare solutions of one problem"),
    (lambda _: ComparisonFigure({"IP": Disc()}),
     "solution 'IP' is Discretization( | a ContactSolution | which Solve(disc) returns"),
    (lambda _: Animation([Solve(Disc()), Example()]), "solution 2 is ContactProblem( | a ContactSolution | give"),
    (lambda _: DeformedFigure(Solve(Disc()), scale="large"), "scale is 'large' | a number | 1 for the displacement as it is"),
    (lambda _: ErrorFigure(Solve(Disc()), estimate=0.1),
     "estimate is 0.1 | an ErrorEstimate | which EstimateError(solution) returns"),
    (lambda _: ErrorFigure(Solve(Disc()), estimate=EstimateError(Solve(Disc(n=3)))),
     "estimate has indicators of 18 elements | has 8 | give the estimate of this solution"),
    (lambda _: FieldFigure(Solve(Disc()), "vonmisses"), "no field 'vonmisses' | choose one of | did you mean 'vonmises'?"),
    (lambda _: FieldFigure(Solve(Disc()), 3), "field is 3 | a CoefficientFunction | or one of displacement, ux, uy, vonmises"),
    (lambda _: FieldFigure(solution := Solve(Disc()), solution.gfu), "field has 2 components | give one of them | or Norm"),
    (lambda _: FieldFigure(Solve(Disc()), 2 * Solve(Disc(n=3)).gfu[0]),
     "field has a GridFunction on another mesh, of 18 elements | which has 8 | give a field on solution.disc.mesh"),
    (lambda _: FieldFigure(Solve(Disc()), 1 / (x - x)), "field of your own | is not a finite real number | look for"),
    (lambda _: FieldFigure(solution := Solve(Disc()), solution.disc.mesh.BoundaryCF({"left": 1})),
     "field of your own | cannot be evaluated in the elements | give a CoefficientFunction that has values there"),
    (lambda _: FieldFigure(Solve(Disc()), view=(0, 0)), "view is (0, 0) | the body is plane | leave it out"),
    (lambda _: MeshFigure(Disc()), "mesh is Discretization( | an ngsolve.Mesh | ReadMesh(file) returns"),
    (lambda _: MeshFigure(Disc().mesh, view=(0, 0)), "view is (0, 0) | the mesh is plane | leave it out"),
    (lambda _: FieldFigure(Solve(Disc()), limits=(2, 1)), "limits is (2, 1) | the lowest and the highest | give"),
    (lambda _: FieldFigure(Solve(Block()), cut=((0, 0, 0), (0, 0, 0))), "cut is | whose normal is 0 | give"),
    (lambda _: FieldFigure(Solve(Block()), cut=((0, 0, 9), (0, 0, 1))),
     "a plane that does not meet the body | extends from (0.0, 0.0, 0.0) to (1.0, 1.0, 1.0) | give another one"),
    (lambda _: LineFigure(Solve(Disc()), (2, 0), (2, 1)), "the line from (2.0, 0.0) to (2.0, 1.0) | meets no element | give"),
    (lambda _: LineFigure(Solve(Disc()), (0, 0), (0, 0)), "a and b are both (0.0, 0.0) | two ends of a line | give"),
    (lambda _: DeformedFigure(Disc()), "solution is Discretization( | a ContactSolution | which Solve(disc) returns"),
    (lambda _: SettingFigure(Solve(Disc())),
     "disc is ContactSolution( | a Discretization | that of a solution is solution.disc"),
    (lambda _: Animation([Solve(Disc())], field=x), "field is | a function of one state | give the name of a field"),
    (lambda _: Animation([]), "given are 0 | of one dimension and order | give load steps of one Discretization"),
    (lambda _: WriteSeries([], "series"), "solutions is [] | a list of ContactSolutions | give a LoadHistory with a state"),
    (lambda _: WriteSeries([Solve(Disc())] * 2, "series", times=(1, 1)), "times is (1, 1) | 2 increasing numbers | give"),
    (lambda _: Solve(Disc()).At(9, 9), "point (9.0, 9.0) lies in no element | from (0.0, 0.0) to (1.0, 1.0) | give a point of"),
    # Errors against other displacements.
    (lambda _: EnergyError(solution := Solve(Disc()), Grad(solution.gfu)[0, :]),
     "the displacement has no symbolic derivative | an expression of x, y, z and GridFunctions | give"),
    (lambda _: EnergyError(Solve(Disc()), (VoxelCoefficient((0, 0), (1, 1), np.eye(2)), 0)),
     "the displacement has no symbolic derivative | an expression of x, y, z and GridFunctions | give"),
    (lambda _: L2Error(solution := Solve(Disc()), solution),
     "displacement is a ContactSolution | a CoefficientFunction | that of a solution is solution.gfu"),
    (lambda _: L2Error(Solve(Disc()), (0, 0, 0)), "displacement has 3 components | on a mesh of dimension 2 | give 2"),
    (lambda _: StrainError(Solve(Disc()), CF((1, 0))), "displacement has no strain | relative to it | take EnergyError")]
