"""Steps of a composition as C statements, one file for each kind."""
