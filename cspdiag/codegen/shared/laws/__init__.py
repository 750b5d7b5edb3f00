"""What generators ask of control laws."""
