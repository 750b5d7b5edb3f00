"""What can be said against a program once its shapes are known."""
