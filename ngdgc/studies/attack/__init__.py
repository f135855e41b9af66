"""Public names under attack: called with wrong, extreme and hostile values.

Here: what is called, with what, and what may come of it.
Not here: inputs that end or hang other software.
"""
