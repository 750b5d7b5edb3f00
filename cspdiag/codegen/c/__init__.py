"""The C target: C99 without a heap, a pair of files a class."""
