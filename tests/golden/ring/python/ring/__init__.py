"""A token circulates through `cells` cells."""
