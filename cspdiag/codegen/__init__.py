"""cspdiag.codegen"""
