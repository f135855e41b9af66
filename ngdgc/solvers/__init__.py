"""Iterations for the contact problem: one driver, one module per iteration."""

from ..discretization import Discretization
from .contraction import Contraction, EstimateContraction
from .multistart import MultiStart
from .nested import NestedNewtonSolver
from .newton import SemismoothNewtonSolver
from .uzawa import UzawaSolver

Discretization.defaultsolver = NestedNewtonSolver
