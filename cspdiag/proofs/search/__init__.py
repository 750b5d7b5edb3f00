"""Search through global states: breadth first, by stubborn sets, towards candidates."""
