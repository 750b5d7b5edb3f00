"""The FMU target: the C of a program, or of an environment, below the functions of FMI 2.0 or 3.0."""
