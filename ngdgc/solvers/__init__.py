"""Iterations for the contact problem: one driver, which stops, records and raises, and a package or module per iteration.

Here: how coefficients and tractions are found.
Not here: what the equations are; solvers never ask which method they solve for.
"""

from .multistart import MultiStart
from .nested import NestedNewtonSolver
from .newton.solver import SemismoothNewtonSolver
from .uzawa.contraction import Contraction, EstimateContraction
from .uzawa.solver import UzawaSolver
