"""FMUs: files of a program or an environment for other simulators."""
