"""What assistants that write programs may do with the programs of a folder: the Model Context Protocol."""
