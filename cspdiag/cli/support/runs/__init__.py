"""What a person is told of a run: while it goes on, where simulated time stands still, and when it has ended."""
