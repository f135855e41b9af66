"""Meshes from files of other programs.

Here: one module a format, which says what the file holds; `building` makes a mesh of it.
Not here: what is wrong with a mesh that there is, see `mesh.checks`.
"""
