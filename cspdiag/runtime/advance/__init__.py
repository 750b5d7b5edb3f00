"""How runs advance: virtual time, and runs that their caller continues."""
