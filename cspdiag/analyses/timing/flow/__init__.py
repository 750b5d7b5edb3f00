"""What threads do: from wait to wait, what they compute, and what they follow."""
