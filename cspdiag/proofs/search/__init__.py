"""Searches through global states: breadth first, with stubborn sets, towards candidates."""
