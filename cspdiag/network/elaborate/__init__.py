"""From definitions to shapes: sizes evaluated, replicators unrolled, references resolved."""
