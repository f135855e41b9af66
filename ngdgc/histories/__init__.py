"""Load histories: states along a time, each an increment from the one before, from which slip counts.

Here: how a body is led through its states, their forces and energies, and a history kept in a folder.
Not here: the iteration inside an increment (`solvers`), what is recorded of that (`solution.history`), figures (`plots`).
"""
