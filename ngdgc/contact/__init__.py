"""Gamma_C alone: displacements and tractions at its quadrature points, and the laws there.

Here: the graph of the law, how the body answers tractions, how stiff both are.
Not here: iterations (`solvers`), and laws themselves (`problem`).
"""
