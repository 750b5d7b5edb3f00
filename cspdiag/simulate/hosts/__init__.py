"""Runs a program that several hosts share: each has a place, which is a part of the program."""
