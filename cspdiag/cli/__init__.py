"""The command line, with one module for each verb. Only here are files written, results printed and exit
codes chosen.
"""
