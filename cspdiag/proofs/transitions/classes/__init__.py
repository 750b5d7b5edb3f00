"""What is known of the classes of a network before any process is explored."""
