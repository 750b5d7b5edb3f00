"""What can be wrong with names, types, units and equations."""
