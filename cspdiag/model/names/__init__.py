"""What every name means."""
