"""What is known about a text while it is edited, without the types of any protocol: the language server and the studio
answer with it.
"""
