"""Exercises of the notebooks, and the checker that grades answers."""
