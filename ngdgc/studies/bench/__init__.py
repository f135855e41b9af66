"""Benchmarks: what things cost beside the factorisation of the matrix.

Here: solutions, assembly, other codes, and the page.
Not here: its figure (`plots`).
"""
