"""Control laws and environments in place: assignments within the code of the process that runs them."""
