"""cspdiag.model"""
