"""What users see of a run: its progress, a standstill of simulated time, and how it ended."""
