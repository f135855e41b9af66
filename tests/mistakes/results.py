"""Mistakes with solutions, pictured or compared, as in `mistakes`."""

import numpy as np
from mistakes import Block, Disc
from ngsolve import CF, Grad, VoxelCoefficient
from problems import Example

from ngdgc import EstimateError, Solve
from ngdgc.errors import EnergyError, L2Error, StrainError
from ngdgc.export import Animation
from ngdgc.plots import ComparisonFigure, DeformedFigure, ErrorFigure, SettingFigure

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
    (lambda _: DeformedFigure(Disc()), "solution is Discretization( | a ContactSolution | which Solve(disc) returns"),
    (lambda _: SettingFigure(Solve(Disc())),
     "disc is ContactSolution( | a Discretization | that of a solution is solution.disc"),
    (lambda _: Animation([]), "given are 0 | of one dimension and order | give load steps of one Discretization"),
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
