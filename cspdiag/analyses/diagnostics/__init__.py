"""What the analyses find, in words for people."""
