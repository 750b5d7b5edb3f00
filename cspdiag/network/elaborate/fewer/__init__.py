"""Whether a program of many elements has mistakes only if the same program with fewer elements has some.

Checks judge an element by what it is: where the text declares it, where in the composition it runs, and the elements
that it is connected to. So if the elements of two programs that differ in sizes alone have the same neighbourhoods,
and neither indexes nor arguments fail in the larger one, no check can find anything in the larger one that it does not
find in the smaller one. Where that cannot be seen from the text, nothing is claimed, and every element is checked.
"""
