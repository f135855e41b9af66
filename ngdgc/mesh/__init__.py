"""What is asked of a mesh: facets, sides, quadrature on its boundaries, coarser meshes of the same body.

Here: whatever holds for every method, and what is wrong with a mesh.
Not here: materials, methods, spaces of displacements; how meshes are made is in `ngdgc.meshes`.
"""
