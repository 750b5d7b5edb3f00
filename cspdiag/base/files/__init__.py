"""Files: what ships beside the code, what is kept between runs, and how results are written."""
