"""cspdiag.syntax"""
