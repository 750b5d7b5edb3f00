"""The last philosopher takes the right fork first, so that no circle of waiting can close."""
