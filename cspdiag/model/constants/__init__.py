"""Values that are known before the program runs."""
