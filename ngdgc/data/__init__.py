"""What users give as functions: converted, evaluated on boundaries, differentiated.

Here: numbers, tuples and CoefficientFunctions as data, and the regions that they are given on.
Not here: what the data mean; that is said by the storeys above, from `problem` on.
"""
