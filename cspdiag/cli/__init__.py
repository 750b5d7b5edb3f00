"""cspdiag.cli"""
