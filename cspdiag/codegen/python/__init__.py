"""The Python target: the package at ``-O0`` (``plain``) and at ``-O1`` (``fast``)."""
