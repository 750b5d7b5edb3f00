"""Control laws and environments as readable Python."""
