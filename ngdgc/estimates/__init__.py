"""How wrong a solution is, and meshes that follow from it.

Here: estimates of errors from a computed solution alone, of the energy and of forces, and the loop of solving and refining.
Not here: errors against exact solutions (`errors`), and how one mesh is solved on (`solvers`).
"""
