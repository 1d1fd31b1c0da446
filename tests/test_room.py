"""Code keeps to one thought a line, by rules that the linter does not know."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
WORD = 12
"""Largest number of characters of a short word."""
SUBJECTS = """
    anybody anything everybody everything he how it none nobody nothing one she so
    somebody something that there these they this those what when where whether which
    who whoever
"""
"""Words that begin no docstring, as they name no subject."""
Comprehension = ast.ListComp | ast.SetComp | ast.DictComp | ast.GeneratorExp
Documented = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef


def is_short(side: ast.expr) -> bool:
    """Check whether a side of a conditional expression is one short word."""
    if isinstance(side, ast.UnaryOp):
        side = side.operand
    is_word = isinstance(side, ast.Name | ast.Attribute | ast.Constant)
    return is_word and len(ast.unparse(side)) <= WORD


def is_truth(node: ast.expr) -> bool:
    """Check whether an expression is a truth value, by its form or its name."""
    if isinstance(node, ast.Call):
        node = node.func
    if isinstance(node, ast.Attribute):
        return node.attr.lstrip("_").startswith(("is_", "has_", "can_"))
    if isinstance(node, ast.Name):
        return node.id == "bool" or node.id.startswith(("is_", "has_", "can_"))
    is_not = isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not)
    return is_not or isinstance(node, ast.Compare | ast.BoolOp)


def is_sequence(node: ast.expr) -> bool:
    """Check whether an expression is a written list, tuple or text."""
    if isinstance(node, ast.Constant):
        return isinstance(node.value, str | bytes)
    return isinstance(node, ast.List | ast.Tuple | ast.JoinedStr)


def nests_conditions(node: ast.AST) -> bool:
    """Check for a conditional expression inside another one."""
    if not isinstance(node, ast.IfExp):
        return False
    inner = [each for each in ast.walk(node) if isinstance(each, ast.IfExp)]
    return len(inner) > 1


def is_conditional_statement(node: ast.AST) -> bool:
    """Check for a conditional expression of more than words that is all of a line."""
    if not isinstance(node, ast.Assign | ast.AnnAssign | ast.AugAssign | ast.Return):
        return False
    value = node.value
    if not isinstance(value, ast.IfExp):
        return False
    return not (is_short(value.body) and is_short(value.orelse))


def assigns_a_tuple(node: ast.AST) -> bool:
    """Check for several assignments in one statement."""
    if not isinstance(node, ast.Assign) or not isinstance(node.value, ast.Tuple):
        return False
    return any(isinstance(target, ast.Tuple | ast.List) for target in node.targets)


def has_two_loops(node: ast.AST) -> bool:
    """Check for a comprehension with more than one loop."""
    return isinstance(node, Comprehension) and len(node.generators) > 1


def has_two_conditions(node: ast.AST) -> bool:
    """Check for a comprehension with more than one condition."""
    if not isinstance(node, ast.comprehension):
        return False
    are_joined = any(isinstance(condition, ast.BoolOp) for condition in node.ifs)
    return are_joined or len(node.ifs) > 1


def unpacks_two(node: ast.AST) -> bool:
    """Check for a dictionary written from more than one other."""
    return isinstance(node, ast.Dict) and node.keys.count(None) > 1


def multiplies_by_truth(node: ast.AST) -> bool:
    """Check for a sequence times a truth value."""
    if not isinstance(node, ast.BinOp) or not isinstance(node.op, ast.Mult):
        return False
    sides = [(node.left, node.right), (node.right, node.left)]
    return any(is_sequence(first) and is_truth(second) for first, second in sides)


def unpacks_a_comprehension(node: ast.AST) -> bool:
    """Check for a generator or another comprehension behind a star."""
    return isinstance(node, ast.Starred) and isinstance(node.value, Comprehension)


def maps_a_lambda(node: ast.AST) -> bool:
    """Check for `map` of what a comprehension says."""
    if not isinstance(node, ast.Call) or not node.args:
        return False
    is_map = isinstance(node.func, ast.Name) and node.func.id == "map"
    return is_map and isinstance(node.args[0], ast.Lambda)


def names_no_subject(node: ast.AST) -> bool:
    """Check for a docstring whose first word is a pronoun."""
    if not isinstance(node, Documented):
        return False
    text = ast.get_docstring(node) or "."
    first = text.split()[0].strip(",.:;").lower()
    return first in SUBJECTS.split()


RULES: dict[str, Callable[[ast.AST], bool]] = {
    "Conditional expressions are not nested.": nests_conditions,
    "`if` is a statement, unless both sides are one short word.": (
        is_conditional_statement
    ),
    "One assignment a statement.": assigns_a_tuple,
    "A comprehension has one loop.": has_two_loops,
    "A comprehension has at most one condition.": has_two_conditions,
    "No two `**` in one literal: join dictionaries by `|`.": unpacks_two,
    "Never a sequence times a truth value.": multiplies_by_truth,
    "Never an unpacked generator: give it a name.": unpacks_a_comprehension,
    "Never `map` of what a comprehension says.": maps_a_lambda,
    "The first word of a docstring names its subject.": names_no_subject,
}
KINDS = (
    ast.Assign,
    ast.AnnAssign,
    ast.AugAssign,
    ast.Return,
    ast.IfExp,
    ast.comprehension,
    ast.Dict,
    ast.BinOp,
    ast.Starred,
    ast.Call,
    *Comprehension.__args__,
    *Documented.__args__,
)
"""Kinds of nodes that the rules look at."""
BAD = {
    "Conditional expressions are not nested.": "f(a if b else c if d else e)",
    "`if` is a statement, unless both sides are one short word.": (
        "limit = largest if most is None else most // dearer"
    ),
    "One assignment a statement.": "length, force = 1e-3, 1e2",
    "A comprehension has one loop.": "[cell for row in table for cell in row]",
    "A comprehension has at most one condition.": "[a for a in b if a and a.c]",
    "No two `**` in one literal: join dictionaries by `|`.": "{**SMALL, **changes}",
    "Never a sequence times a truth value.": "widths = [half] * is_offset + full",
    "Never an unpacked generator: give it a name.": "max(*(a.size for a in b))",
    "Never `map` of what a comprehension says.": "list(map(lambda a: a + 1, b))",
    "The first word of a docstring names its subject.": '"""What a run is worth."""',
}
"""A line that breaks each rule, and no other."""
GOOD = '''"""Sizes of the pieces of a rod, (n_pieces,)."""
rows, columns = matrix.shape
sign = -1.0 if is_left else 1.0
widths = [half] * count
settings = SMALL | changes
found = [piece.size for piece in pieces if piece.is_whole]
if is_offset:
    widths = [half, *widths]
'''


def findings(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Lines of a module that break a rule, with the rule."""
    for node in ast.walk(tree):
        # Seven nodes in eight are of none of the kinds that rules look at.
        if not isinstance(node, KINDS):
            continue
        for rule, breaks in RULES.items():
            if breaks(node):
                yield line_of(node), rule


def line_of(node: ast.AST) -> int:
    """Line of a node; that of a docstring for a node that has one."""
    if isinstance(node, Documented):
        return node.body[0].lineno
    if isinstance(node, ast.comprehension):
        return node.target.lineno
    return getattr(node, "lineno", 1)


def files() -> Iterator[Path]:
    """Files of the engine, the page and the tests."""
    for folder in ("solver", "app", "tests"):
        yield from sorted((ROOT / folder).rglob("*.py"))


def test_every_file_gives_each_thought_a_line() -> None:
    found = []
    for path in files():
        tree = ast.parse(path.read_text(encoding="utf-8"))
        name = path.relative_to(ROOT)
        found += [f"{name}:{line}: {rule}" for line, rule in sorted(findings(tree))]
    assert not found, "\n".join(found)


@pytest.mark.parametrize("rule", RULES)
def test_a_line_that_breaks_a_rule_is_found_with_it(rule: str) -> None:
    assert set(findings(ast.parse(BAD[rule]))) == {(1, rule)}


def test_lines_that_break_no_rule_are_left_alone() -> None:
    assert list(findings(ast.parse(GOOD))) == []
