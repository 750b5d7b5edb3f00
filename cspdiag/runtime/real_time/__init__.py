"""What runs against the clock need: preference by the operating system, and an account of how late instants were."""
