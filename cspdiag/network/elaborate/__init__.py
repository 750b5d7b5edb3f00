"""From definitions to shapes: evaluates sizes, unrolls replicators, resolves references."""
