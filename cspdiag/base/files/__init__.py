"""Files: resources that ship with the code, caches, and how results are written."""
