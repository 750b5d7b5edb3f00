"""What a run has come to: names of its tasks, what it remembers, who is stuck in it, whether it recurs."""
