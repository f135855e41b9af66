"""Dense blocks: integrals over elements and facets in batches of numpy, and the operators of the methods made of them.

Here: reference elements, geometry, integrals, and the sparse matrix they are put into.
Not here: which operators a method consists of; NGSolve's symbols.
"""
