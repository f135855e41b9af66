"""Linear equations of a body: which inverse solves them, and iterative inverses.

Here: whatever sees a matrix, its space and its material.
Not here: contact, and how a matrix is assembled.
"""
