"""What the verbs have in common: output, progress, failures, time limits."""
