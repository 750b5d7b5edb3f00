"""The precision that a program computes in."""
