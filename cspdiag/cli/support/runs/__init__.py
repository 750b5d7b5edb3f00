"""What users see of a run: its progress, where simulated time stands still, and its end."""
