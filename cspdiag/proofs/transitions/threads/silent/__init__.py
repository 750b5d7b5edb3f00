"""What a thread does on its own: silent steps, of which it needs no choice and nobody else sees."""
