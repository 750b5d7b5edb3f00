"""The command line: one file a verb. Only here are files written, results printed and exit codes chosen."""
