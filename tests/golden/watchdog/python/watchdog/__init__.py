"""Switches the heater off when the thermometer is lost, and tries again; the third time it
gives up.
"""
