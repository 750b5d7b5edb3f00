"""What drawings are made of: shapes and texts with places."""
