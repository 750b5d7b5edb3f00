"""The Python target at ``-O1``: the same package, with processes as generators and their operations inlined."""
