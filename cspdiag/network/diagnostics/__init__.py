"""What can be wrong with channels, compositions, periods and environments."""
