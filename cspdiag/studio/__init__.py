"""The studio: a page on which a program is written, drawn, proved and run."""
