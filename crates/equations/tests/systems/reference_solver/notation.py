"""Reads equations and formulas into trees.

    equation := sum "=" sum
    sum      := product { ( "+" | "-" ) product }
    product  := signed { [ "*" | "/" ] signed }
    signed   := "-" signed | power
    power    := primary [ "^" signed ]
    primary  := number | name | name "(" sum { "," sum } ")" | "(" sum ")"

A product may have no sign: `m x''`, `2 k (a + b)`. Such a product after a division, as in `a / b c`, is ambiguous and
an error. A name followed by a parenthesis is a call if it is the name of a function or of a table, otherwise a factor.
"""

import math
import re
from dataclasses import dataclass

# The functions and their numbers of arguments.
ARGUMENTS = {
    "sqrt": 1, "sin": 1, "cos": 1, "tan": 1, "atan": 1, "atan2": 2, "exp": 1, "ln": 1, "log10": 1, "tanh": 1,
    "abs": 1, "min": 2, "max": 2, "sign": 1, "step": 1, "dead_zone": 2, "limit": 3, "delay": 2,
}
TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|(?P<name>[A-Za-z_]\w*'*)|(?P<sign>[-+*/^(),=]))"
)


@dataclass(frozen=True)
class Number:
    """A number without a sign."""

    value: float


@dataclass(frozen=True)
class Name:
    """A parameter, a drive, the time `t` or a quantity, with the number of its derivatives by time."""

    name: str
    primes: int = 0

    def __str__(self):
        return self.name + "'" * self.primes


@dataclass(frozen=True)
class Negate:
    """A minus sign before an operand."""

    operand: object


@dataclass(frozen=True)
class Binary:
    """One of + - * / ^ between two operands."""

    sign: str
    left: object
    right: object


@dataclass(frozen=True)
class Call:
    """A function or a table of arguments."""

    name: str
    arguments: tuple


def parse_equation(text, tables):
    """Reads an equation. Returns the trees of its two sides."""
    parser = _Parser(text, tables)
    left = parser.sum()
    parser.take_required("=")
    right = parser.sum()
    parser.end()
    return left, right


def parse_formula(text):
    """Reads a formula, such as the initial value of a quantity."""
    parser = _Parser(text, ())
    tree = parser.sum()
    parser.end()
    return tree


def names(node):
    """All names in a tree, in the order of the text."""
    match node:
        case Name():
            return [node]
        case Negate(operand):
            return names(operand)
        case Binary(_, left, right):
            return names(left) + names(right)
        case Call(_, arguments):
            return [name for argument in arguments for name in names(argument)]
    return []


class _Parser:
    """A recursive-descent parser. Each rule of the grammar is one method."""

    def __init__(self, text, tables):
        self.text, self.tables, self.at = text, tables, 0
        self.tokens = []
        position = 0
        while position < len(text.rstrip()):
            token = TOKEN.match(text, position)
            if token is None:
                raise ValueError(f"unexpected character in {text!r} at {position}")
            self.tokens.append(token)
            position = token.end()

    def peek(self, group):
        """The text of the next token if it is of this kind."""
        return self.tokens[self.at][group] if self.at < len(self.tokens) else None

    def take(self, *signs):
        """Consumes the next token if it is one of these signs."""
        sign = self.peek("sign")
        if sign not in signs:
            return None
        self.at += 1
        return sign

    def take_required(self, sign):
        """Consumes a sign that must follow."""
        if not self.take(sign):
            raise ValueError(f"{sign!r} is missing in {self.text!r}")

    def end(self):
        """Fails unless all tokens are consumed."""
        if self.at < len(self.tokens):
            raise ValueError(f"unexpected {self.tokens[self.at][0].strip()!r} in {self.text!r}")

    def sum(self):
        left = self.product()
        while sign := self.take("+", "-"):
            left = Binary(sign, left, self.product())
        return left

    def product(self):
        left, is_after_division = self.signed(), False
        while True:
            if sign := self.take("*", "/"):
                left, is_after_division = Binary(sign, left, self.signed()), is_after_division or sign == "/"
            elif self.peek("number") or self.peek("name") or self.peek("sign") == "(":
                if is_after_division:
                    raise ValueError(f"ambiguous product without a sign after a division in {self.text!r}")
                left = Binary("*", left, self.power())
            else:
                return left

    def signed(self):
        return Negate(self.signed()) if self.take("-") else self.power()

    def power(self):
        base = self.primary()
        return Binary("^", base, self.signed()) if self.take("^") else base

    def primary(self):
        if self.take("("):
            inner = self.sum()
            self.take_required(")")
            return inner
        number, name = self.peek("number"), self.peek("name")
        if number is None and name is None:
            raise ValueError(f"an operand is missing in {self.text!r}")
        self.at += 1
        if number is not None:
            return Number(float(number))
        if name in ARGUMENTS or name in self.tables:
            return self.call(name)
        plain = name.rstrip("'")
        return Number(math.pi) if name == "pi" else Name(plain, len(name) - len(plain))

    def call(self, name):
        self.take_required("(")
        arguments = [self.sum()]
        while self.take(","):
            arguments.append(self.sum())
        self.take_required(")")
        if len(arguments) != ARGUMENTS.get(name, 1):
            raise ValueError(f"{name} has {len(arguments)} arguments in {self.text!r}")
        return Call(name, tuple(arguments))
