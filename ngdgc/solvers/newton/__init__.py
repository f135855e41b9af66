"""The semismooth Newton method on the graph of the contact law, and what makes it cheap.

Here: equations at the points, remembered products, corrections in the whole space.
Not here: what other iterations use too (`solvers`).
"""
