"""The methods of Tables 1 and 2, a row each: forms, penalties, liftings, numerical fluxes.

Here: all that makes one method differ from another, as blocks and in NGSolve's symbols.
Not here: contact, solvers, and integrals over single elements (`blocks`).
"""
