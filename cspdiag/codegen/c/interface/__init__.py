"""The step interface of a C program: the one header that its users include, and what is behind it."""
