"""The storeys of the house, which modules and docs are held to."""

# The house, from the ground: who stands on a line imports only from lines above it, and within a package nobody in a circle.
STOREYS = ["contracts", "tools", "exceptions", "data", "problem", "mesh", "meshes", "linear", "blocks", "methods",
           "contact", "discrete", "solution", "solvers", "distributed", "discretization", "histories", "estimates",
           "exact", "conformance", "errors", "traces", "theory", "__init__", "cases", "export", "plots", "studies",
           "exercises", "commands", "cli"]
