"""Gamma_C alone: displacements and tractions at its quadrature points, and the laws there.

Here: the graph of the law, and how stiff law and body are at the points.
Not here: iterations (`solvers`), laws themselves (`problem`), how the body answers tractions (`discrete`).
"""
