"""cspdiag.runtime"""
