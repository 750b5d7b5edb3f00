"""What optimized code calls."""
