"""Text of a mesh as Abaqus and CalculiX have it."""

ABAQUS = """*NODE, NSET=all
1, 0, 0, 0
2, 1, 0, 0
3, 1, 1, 0
4, 0, 1, 0
5, 0, 1, 0
6, 1, 1, 0
7, 1, 2, 0
8, 0, 2, 0
*ELEMENT, TYPE=CPS4, ELSET=lower
1, 1, 2, 3, 4
*ELEMENT, TYPE=CPS4, ELSET=upper
2, 5, 6, 7, 8
*NSET, NSET=upper all
5, 6, 7, 8
*NSET, NSET=master
3, 4
*NSET, NSET=slave
5, 6
*NSET, NSET=bottom
1, 2
*NSET, NSET=top
7, 8
"""
"""Two squares of a metre on each other, with names of elements and of nodes."""
