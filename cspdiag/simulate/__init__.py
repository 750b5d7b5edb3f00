"""cspdiag.simulate"""
