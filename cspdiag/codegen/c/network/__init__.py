"""The C files that build the network and compile the environment in."""
