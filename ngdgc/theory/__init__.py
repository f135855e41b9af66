"""Lemmas 3.1 to 3.4 of Xiao, Wang, Han 2018, and uniqueness, as tools for a problem on a mesh.

Here: constants and residuals that the theory speaks of.
Not here: what a discretisation needs of them to be safe (`methods/coercivity`).
"""
