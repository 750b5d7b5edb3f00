"""cspdiag.analyses"""
