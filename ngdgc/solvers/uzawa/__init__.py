"""The Uzawa iteration of Xiao, Wang, Han 2018, section 4, and its acceleration.

Here: its steps, and how fast they contract.
Not here: what other iterations use too (`solvers`).
"""
