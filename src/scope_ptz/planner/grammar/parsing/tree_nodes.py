"""Nodes of the parse tree, and the base class of its visitors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from scope_ptz.planner.grammar.lexing.lexer import Lexeme
from scope_ptz.planner.grammar.parsing.chart import Branch, Leaf


class Node:
    """A branch of the parse tree, with the methods that visitors need."""

    __slots__ = ("branch",)

    def __init__(self, branch: Branch) -> None:
        self.branch = branch

    @property
    def name(self) -> str:
        return self.branch.name

    def branches(self, *names: str) -> list[Node]:
        """Return the children that are rules, filtered by name if any names are given."""
        return [Node(c) for c in self.branch.children if isinstance(c, Branch) and (not names or c.name in names)]

    def leaves(self, kind: str | None = None) -> list[Leaf]:
        """Return the children that are terminals, filtered by kind if a kind is given."""
        return [c for c in self.branch.children if isinstance(c, Leaf) and kind in (None, c.kind)]

    def leaf_kinds(self) -> list[str]:
        """Return the kinds of the child terminals."""
        return [leaf.kind for leaf in self.leaves()]

    def has(self, *kinds: str) -> bool:
        """Return whether a child terminal is of one of the kinds."""
        return any(leaf.kind in kinds for leaf in self.leaves())

    def all_leaves(self) -> list[Leaf]:
        """Return every terminal below the node, in order."""
        out: list[Leaf] = []
        for child in self.branch.children:
            out.extend([child] if isinstance(child, Leaf) else Node(child).all_leaves())
        return out

    def position(self, name: str) -> int:
        """Return the index, among all children, of the first child with the given name; -1 if there is none."""
        for i, child in enumerate(self.branch.children):
            if (child.name if isinstance(child, Branch) else child.kind) == name:
                return i
        return -1


class TreeVisitor:
    """Base class of the visitors that build results from a parse tree. A subclass has one method for each rule.

    Attributes:
        source: The text of the instruction.
        lexemes: The lexemes of the sentence.
        upper_case: Whether the text is all upper case. If so, descriptions are converted to lower case.
    """

    def __init__(self, text: str, lexemes: Sequence[Lexeme]) -> None:
        self.source = text
        self.lexemes = lexemes
        self.upper_case = text.isupper()

    def visit(self, node: Node) -> Any:
        """Return the result for a node, built by the method for its rule."""
        name = {"visit": "visit_places", "raise": "raise_it", "if": "if_"}.get(node.name, node.name)
        return getattr(self, name)(node)

    def number(self, node: Node) -> float:
        """Return the value of the node's number."""
        leaf = next(leaf for leaf in node.leaves() if leaf.kind in {"NUM", "ORDINAL"})
        return self.lexemes[leaf.index].value

    def fraction(self, node: Node) -> float:
        """Return the value of the node's fraction. An ordinal such as "third" means one third."""
        lexeme = self.lexemes[node.leaves("FRACTION")[0].index]
        return 1 / lexeme.value if "ORDINAL" in lexeme.kinds else lexeme.value

    def words_of(self, leaf: Leaf) -> str:
        """Return the text of a leaf in lower case."""
        lexeme = self.lexemes[leaf.index]
        return self.source[lexeme.start : lexeme.end].lower()

    def repeat_count(self, node: Node) -> int:
        """Return the number of repetitions that a word stands for: 3 for "thrice" or "a few times", otherwise 2."""
        words = " ".join(self.words_of(leaf) for leaf in node.leaves("TWICE"))
        return 3 if "thrice" in words or "few" in words else 2

    def text(self, leaves: Sequence[Leaf]) -> str:
        """Return the original words from the first to the last of the leaves."""
        if not leaves:
            return ""
        start = self.lexemes[leaves[0].index].start
        end = self.lexemes[leaves[-1].index].end
        words = " ".join(self.source[start:end].split())
        return words.lower() if self.upper_case else words
