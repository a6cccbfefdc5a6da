"""Derives the dimension of an expression, with the rules of the formulas of patchcord.

The operands of a sum must agree in dimension. A literal number is a pure number, except that a literal 0 fits every
dimension. The arguments of sin, exp and so on are pure numbers.
"""

from fractions import Fraction

from .notation import Binary, Call, Name, Negate, Number
from .units import NONE, product, raised

# Functions whose arguments agree in dimension. The value has the same dimension.
SAME = ("abs", "min", "max", "dead_zone", "limit")


def dimension_of(node, scope):
    """The dimension of an expression; None for an expression of literal numbers only.

    `scope.dimension(name)` is the dimension of a name, `scope.time` that of the time, and `scope.tables` has the
    dimensions of the argument and of the value of each table.
    """
    match node:
        case Number():
            return None
        case Name():
            return scope.dimension(node)
        case Negate(operand):
            return dimension_of(operand, scope)
        case Binary("+" | "-", left, right):
            return agreed([left, right], scope)
        case Binary("^", base, exponent):
            return _power(base, exponent, scope)
        case Binary(sign, left, right):
            a, b = dimension_of(left, scope), dimension_of(right, scope)
            return None if a is None and b is None else product(a or NONE, b or NONE, 1 if sign == "*" else -1)
        case Call(name, arguments):
            return _call(name, arguments, scope)


def agreed(nodes, scope):
    """The common dimension of several expressions."""
    found = [dimension_of(node, scope) for node in nodes if node != Number(0.0)]
    if any((dimension or NONE) != (found[0] or NONE) for dimension in found[1:]):
        raise ValueError(f"{nodes} differ in dimension")
    return next((dimension for dimension in found if dimension is not None), None)


def _power(base, exponent, scope):
    """The dimension of a power. The exponent of a quantity with a unit is a literal number."""
    dimension = dimension_of(base, scope)
    _require_pure(exponent, scope)
    if dimension is None or dimension == NONE:
        return dimension
    match exponent:
        case Number(value):
            return raised(dimension, Fraction(value))
        case Negate(Number(value)):
            return raised(dimension, -Fraction(value))
    raise ValueError(f"the exponent {exponent} must be a number")


def _call(name, arguments, scope):
    """The dimension of the value of a function."""
    if name in SAME:
        return agreed(arguments, scope)
    if name == "delay":
        if (dimension_of(arguments[1], scope) or NONE) != scope.time:
            raise ValueError(f"the delay {arguments[1]} is not a time")
        return dimension_of(arguments[0], scope)
    if name in scope.tables:
        taken, given = scope.tables[name]
        if (dimension_of(arguments[0], scope) or NONE) != taken:
            raise ValueError(f"the argument of the table {name} has the wrong dimension")
        return given
    if name == "sqrt":
        dimension = dimension_of(arguments[0], scope)
        return dimension and raised(dimension, Fraction(1, 2))
    if name == "atan2":
        agreed(arguments, scope)
    elif name in ("sign", "step"):
        dimension_of(arguments[0], scope)
    else:
        _require_pure(arguments[0], scope)
    return NONE


def _require_pure(node, scope):
    """Fails unless an expression is a pure number."""
    if (dimension_of(node, scope) or NONE) != NONE:
        raise ValueError(f"{node} must be a pure number")
