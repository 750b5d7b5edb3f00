"""The common part of the verbs: output, progress, failures, time limits."""
