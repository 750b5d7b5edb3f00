"""The Python target: packages at ``-O0`` (``plain``) and at ``-O1`` (``fast``)."""
