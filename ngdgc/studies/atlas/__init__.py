"""The atlas of solvers: what all iterations take on a grid of problems.

Here: the runs, and their page.
Not here: its figure (`plots`).
"""
