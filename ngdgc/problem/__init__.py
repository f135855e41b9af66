"""The continuous problem (2.3)-(2.9): materials, laws of contact and friction, foundations.

Here: what the paper says before it has a mesh, and what the theory asks of it.
Not here: meshes, orders, matrices.
"""
