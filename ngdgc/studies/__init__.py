"""Many solutions: orders of convergence, locking, Table 3, random problems, what solvers take.

Here: functions that run a study and say what it found, as text, table or page.
Not here: arguments of the command line (`commands`), figures (`plots`).
"""
