"""A problem on a mesh: described, checked, frozen.

Here: what is given to a method and what follows from it: space, matrix, load, Gamma_C, what holds the body, how it answers.
Not here: solving, and what is asked of a solution; the public class, which does both, is in `ngdgc.discretization`.
"""
