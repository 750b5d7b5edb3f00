"""The network as a graph, and as the text that other tools read."""

FORMATS = ("dot", "mermaid", "graphml")
ENDINGS = {"dot": "dot", "gv": "dot", "mmd": "mermaid", "mermaid": "mermaid", "graphml": "graphml"}
"""The formats by the endings of names; the first ending of a format is the usual one."""
