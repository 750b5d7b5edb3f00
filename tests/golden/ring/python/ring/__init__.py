"""A token goes round through `cells` cells."""
