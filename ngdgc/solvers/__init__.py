"""Iterations for the contact problem: one driver, one module per iteration."""

from .contraction import Contraction, EstimateContraction
from .newton import SemismoothNewtonSolver
from .uzawa import UzawaSolver
