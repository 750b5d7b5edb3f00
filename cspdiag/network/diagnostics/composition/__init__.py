"""What is said of compositions: alternatives, parallels, sequences, and runs that do not come to what follows."""
