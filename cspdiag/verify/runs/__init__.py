"""The state of a run: names of its tasks, what it remembers, which tasks are stuck, whether it recurs."""
