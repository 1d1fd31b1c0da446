"""Files of Abaqus, rewritten for meshio.

meshio knows few names of plane elements, takes the last of several blocks of nodes for
all nodes, counts the names of blocks of elements as if each block had another one, and
does not move instances of parts to their places.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from solver.refusal import RefusedError, Words

NUMBER = ";block "
"""Between the name of a block of elements and its number."""
ELEMENT = re.compile(r"CP[ES]([3468])[A-Z]*")
"""Plane elements of plane stress or strain, by the number of their nodes."""
KNOWN = {"3": "CPS3", "4": "CPS4", "6": "CPE6", "8": "S8R"}
"""Elements with as many nodes that meshio knows: the scene has its own plane state."""


def for_meshio(data: bytes) -> bytes:
    """Rewrite a file of Abaqus with elements that meshio knows, and one block of nodes.

    Each block of elements has a name, which ends with `NUMBER` and its number. Nothing
    else is in it: meshio follows what it takes for the name of another file.

    Raises
    ------
    RefusedError
        For a file of several parts, of one that is moved, or that includes others.
    """
    nodes = list[str]()
    rest = list[str]()
    heads = list[str]()
    for head, rows in _blocks(data.decode("utf-8", errors="replace")):
        keyword = head.partition(",")[0].strip().upper()
        heads.append(keyword)
        if keyword == "*INSTANCE" and rows:
            raise _of_parts("a part that is moved to its place")
        if keyword == "*INCLUDE":
            raise _of_parts("other files that it includes")
        if keyword == "*NODE":
            nodes += rows
            # A block of nodes with a name is equivalent to a set of these nodes.
            rest += _named_nodes(head, rows)
        elif keyword == "*ELEMENT":
            rest += [_with_known_element(head, heads.count(keyword)), *rows]
        elif keyword == "*NSET":
            rest += [head, *rows]
        elif keyword == "*ELSET" and all(_is_of_numbers(row) for row in rows):
            # meshio turns a set of sets into lists, which add no information.
            rest += [head, *rows]
    if heads.count("*PART") > 1 or heads.count("*INSTANCE") > 1:
        raise _of_parts("several parts")
    return "\n".join(["*NODE", *nodes, *rest, ""]).encode()


def _blocks(text: str) -> Iterator[tuple[str, list[str]]]:
    """Yield lines with keywords, and the lines of data below each, without comments."""
    head = ""
    rows = list[str]()
    for line in text.splitlines():
        if line.startswith("**") or not line.strip():
            continue
        if line.startswith("*"):
            if head:
                yield head, rows
            head = line
            rows = []
        elif head.rstrip().endswith(","):
            # A line of keywords may continue in the next one.
            head += line
        else:
            rows.append(line)
    if head:
        yield head, rows


def _with_known_element(head: str, number: int) -> str:
    """Keyword line of a block of elements, with an element type that meshio knows.

    `number` is that of the block.
    """
    kind = _option(head, "TYPE").upper()
    plane = ELEMENT.fullmatch(kind)
    if plane is not None:
        kind = KNOWN[plane[1]]
    return f"*ELEMENT, TYPE={kind}, ELSET={_option(head, 'ELSET')}{NUMBER}{number}"


def _named_nodes(head: str, rows: list[str]) -> list[str]:
    """Lines of a set with the nodes of a named block; none without a name."""
    name = _option(head, "NSET")
    if not name:
        return []
    numbers = [row.partition(",")[0] for row in rows]
    return [f"*NSET, NSET={name}", *numbers]


def _is_of_numbers(row: str) -> bool:
    """Check whether a line of data has only whole numbers."""
    return all(word.strip().isdigit() for word in row.split(",") if word.strip())


def _option(head: str, key: str) -> str:
    """Value of an option in a line of keywords; empty without one."""
    for word in head.split(",")[1:]:
        found, _, value = word.partition("=")
        if found.strip().upper() == key:
            return value.strip()
    return ""


def _of_parts(found: str) -> RefusedError:
    """Refusal of a file with parts and instances."""
    return RefusedError(
        "mesh",
        Words(f"with {found}"),
        "one mesh whose nodes are all at their places",
        "write one file without parts and assemblies (in Abaqus, an attribute of the "
        "model)",
    )
