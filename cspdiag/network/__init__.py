"""cspdiag.network"""
