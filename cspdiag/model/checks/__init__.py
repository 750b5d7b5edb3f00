"""The rules for definitions, one module for each family."""
