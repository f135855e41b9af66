"""What knows nothing of bodies and meshes.

Here: numbers and names as arguments, the calls of public names, tables, formulas in words, processors and memory.
Not here: anything that takes a mesh, a material or a solution.
"""
