"""What was found: fields, forces, report; kept in a folder and read again.

Here: whatever is computed of one solution, for every method.
Not here: figures (`plots`), comparisons with exact solutions (`ngdgc.errors`), studies of many.
"""
