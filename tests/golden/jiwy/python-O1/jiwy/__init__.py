"""The pan-and-tilt end-effector: both joints at the same time, each at its own sample period."""
