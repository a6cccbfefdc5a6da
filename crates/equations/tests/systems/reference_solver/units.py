"""Units and dimensions, as patch files write them: `N s/m`, `mm/s2`, `W/(m K)`, `1`.

A dimension is a tuple of the powers of kg, m, s, A and K. The powers are fractions, because roots halve them.
"""

import math
import re
from dataclasses import dataclass
from fractions import Fraction

NONE = (Fraction(0),) * 5
TIME = (Fraction(0), Fraction(0), Fraction(1), Fraction(0), Fraction(0))
# The position of the power of time in a dimension.
SECOND = 2

PREFIXES = {
    "": 1.0, "p": 1e-12, "n": 1e-9, "µ": 1e-6, "u": 1e-6, "m": 1e-3, "c": 1e-2, "k": 1e3, "M": 1e6, "G": 1e9,
}
# The size in SI units and the powers of kg, m, s, A and K. These symbols take a prefix.
PREFIXED = {
    "m": (1.0, 0, 1, 0, 0, 0),
    "g": (1e-3, 1, 0, 0, 0, 0),
    "s": (1.0, 0, 0, 1, 0, 0),
    "A": (1.0, 0, 0, 0, 1, 0),
    "K": (1.0, 0, 0, 0, 0, 1),
    "N": (1.0, 1, 1, -2, 0, 0),
    "Pa": (1.0, 1, -1, -2, 0, 0),
    "J": (1.0, 1, 2, -2, 0, 0),
    "W": (1.0, 1, 2, -3, 0, 0),
    "V": (1.0, 1, 2, -3, -1, 0),
    "Hz": (1.0, 0, 0, -1, 0, 0),
    "ohm": (1.0, 1, 2, -3, -2, 0),
    "F": (1.0, -1, -2, 4, 2, 0),
    "H": (1.0, 1, 2, -2, -2, 0),
    "C": (1.0, 0, 0, 1, 1, 0),
    "T": (1.0, 1, 0, -2, -1, 0),
    "l": (1e-3, 0, 3, 0, 0, 0),
    "rad": (1.0, 0, 0, 0, 0, 0),
}
# These symbols take no prefix. They take precedence over a prefixed symbol: `min` is the minute.
PLAIN = {
    "1": (1.0, 0, 0, 0, 0, 0),
    "%": (0.01, 0, 0, 0, 0, 0),
    "deg": (math.pi / 180.0, 0, 0, 0, 0, 0),
    "rpm": (math.pi / 30.0, 0, 0, -1, 0, 0),
    "kg": (1.0, 1, 0, 0, 0, 0),
    "min": (60.0, 0, 0, 1, 0, 0),
    "h": (3600.0, 0, 0, 1, 0, 0),
}
TOKEN = re.compile(r"\s*(?:(?P<symbol>[A-Za-zµ%]+|1)(?P<power>\d*)|(?P<sign>[/()]))")


@dataclass(frozen=True)
class Unit:
    """The size of a unit in SI units, and its dimension."""

    factor: float
    dimension: tuple

    def times(self, other, power=1):
        """The product of this unit and a power of another unit."""
        return Unit(self.factor * other.factor**power, product(self.dimension, other.dimension, power))


def product(a, b, power=1):
    """The dimension of a x b^power."""
    return tuple(own + power * others for own, others in zip(a, b))


def raised(dimension, power):
    """A dimension raised to a power."""
    return tuple(own * Fraction(power) for own in dimension)


def parse_unit(text):
    """Reads a unit. A slash divides by the factor after it."""
    tokens, at = [], 0
    while at < len(text.rstrip()):
        match = TOKEN.match(text, at)
        if match is None:
            raise ValueError(f"{text!r} is not a unit")
        tokens.append(match)
        at = match.end()
    unit, rest = _factors(tokens, text)
    if rest:
        raise ValueError(f"{text!r} has a parenthesis too many")
    return unit


def _factors(tokens, text):
    """The product of the factors up to a closing parenthesis, and the tokens from there on."""
    unit, power = Unit(1.0, NONE), 1
    while tokens and tokens[0]["sign"] != ")":
        first, tokens = tokens[0], tokens[1:]
        if first["sign"] == "/":
            power = -1
            continue
        if first["sign"] == "(":
            factor, tokens = _factors(tokens, text)
            if not tokens:
                raise ValueError(f"a parenthesis of {text!r} is not closed")
            tokens = tokens[1:]
        else:
            factor = Unit(1.0, NONE).times(_symbol(first["symbol"], text), int(first["power"] or 1))
        unit, power = unit.times(factor, power), 1
    return unit, tokens


def _symbol(name, text):
    """The unit of a symbol with an optional prefix."""
    if name in PLAIN:
        return _unit(PLAIN[name])
    for prefix, size in PREFIXES.items():
        if name.startswith(prefix) and name[len(prefix):] in PREFIXED:
            return Unit(size, NONE).times(_unit(PREFIXED[name[len(prefix):]]))
    raise ValueError(f"{name!r} in {text!r} is not a unit")


def _unit(row):
    """The unit of a row of the tables above."""
    return Unit(row[0], tuple(Fraction(power) for power in row[1:]))
