"""Places for boxes, ports, lines and labels."""
