"""A problem: the content of a NAME.json, read and checked. All values are in SI units."""

import json
import math
import re
from dataclasses import dataclass

from .dimensions import agreed, dimension_of
from .drives import KINDS, SETTINGS
from .notation import Binary, Call, Name, Negate, Number, names, parse_equation, parse_formula
from .units import NONE, SECOND, TIME, parse_unit, product

# Units with an angle. A frequency in such a unit is not a number of cycles per second.
ANGULAR = re.compile(r"\b(rad|deg|rpm)\b")
# Plain functions of one or two numbers.
FUNCTIONS = {
    "sqrt": math.sqrt, "sin": math.sin, "cos": math.cos, "tan": math.tan, "atan": math.atan, "atan2": math.atan2,
    "exp": math.exp, "ln": math.log, "log10": math.log10, "tanh": math.tanh,
}


@dataclass(frozen=True)
class Table:
    """A curve of straight lines in SI units. The outermost lines continue, as in a function generator."""

    inputs: tuple
    values: tuple


class Problem:
    """The equations, the values and the units of a problem.

    `states` are the quantities that are integrated, each as a `Name` with its primes. `algebraic` are the definitions
    of other quantities, and `differential` the equations for the highest derivatives, as pairs of sides.
    """

    def __init__(self, path):
        content = json.loads(path.read_text())
        self.title = content["title"]
        self.end = content["run"]["for"]
        rows = content.get("parameters", {})
        self.parameters = {name: _si(row["value"], row["unit"]) for name, row in rows.items()}
        self.dimensions = {name: parse_unit(row["unit"]).dimension for name, row in rows.items()}
        self.angular = {name for name, row in rows.items() if ANGULAR.search(row["unit"])}
        self.units = {_quantity(text): parse_unit(row["unit"]) for text, row in content["quantities"].items()}
        self.unit_texts = {_quantity(text): row["unit"] for text, row in content["quantities"].items()}
        self.drive_units = {name: parse_unit(row["unit"]) for name, row in content.get("drives", {}).items()}
        rows = content.get("tables", {})
        self.table_units = {name: (parse_unit(row["in"]), parse_unit(row["out"])) for name, row in rows.items()}
        self.time = self._dimension_of_time()
        self.tables = {name: self._table(name, row["points"]) for name, row in rows.items()}
        self.drives = {name: self._drive(row) for name, row in content.get("drives", {}).items()}
        self._read_equations(content)
        self.initial = [self._initial(state, content["quantities"]) for state in self.states]

    def _dimension_of_time(self):
        """The dimension of time. If no unit of the problem contains a time, time is a pure number, too."""
        units = [*self.units.values(), *self.drive_units.values()]
        units += [unit for pair in self.table_units.values() for unit in pair]
        dimensions = [unit.dimension for unit in units] + list(self.dimensions.values())
        return TIME if any(dimension[SECOND] for dimension in dimensions) else NONE

    def _table(self, name, points):
        """A table with its points in SI units."""
        (taken, given), (inputs, values) = self.table_units[name], zip(*points)
        if list(inputs) != sorted(set(inputs)):
            raise ValueError(f"the points of the table {name} do not ascend")
        return Table(tuple(x * taken.factor for x in inputs), tuple(y * given.factor for y in values))

    def _drive(self, row):
        """A drive. A setting that is a bare number is in the unit of the drive, or in seconds."""
        unit = parse_unit(row["unit"])
        places = {
            "value": unit.dimension, "time": self.time, "frequency": product(NONE, self.time, -1),
            "rate": product(unit.dimension, self.time, -1), "angle": NONE, "share": NONE,
        }
        settings = {}
        for name, place in SETTINGS[row["kind"]].items():
            if name not in row:
                continue
            factor = unit.factor if place in ("value", "rate") else 1.0
            if place == "plain":
                settings[name] = [(time, value * unit.factor) for time, value in row[name]]
            else:
                settings[name] = self._setting(row[name], places[place], factor)
            if place == "frequency" and isinstance(row[name], str):
                self._require_cycles(row[name])
        unknown = set(row) - set(settings) - {"kind", "unit", "note"}
        if unknown:
            raise ValueError(f"unknown settings {unknown} of a {row['kind']}")
        return KINDS[row["kind"]](self.end, **settings)

    def _require_cycles(self, formula):
        """Fails if a formula of a frequency has a parameter with an angle. patchcord divides such a formula by 2 pi."""
        if any(str(name) in self.angular for name in names(parse_formula(formula))):
            raise ValueError(f"the frequency {formula!r} has a parameter with an angle: use one in Hz")

    def _setting(self, value, dimension, factor):
        """The value of a number or a formula. A formula of literal numbers is in the unit of its place."""
        if not isinstance(value, str):
            return value * factor
        tree = parse_formula(value)
        found = dimension_of(tree, _Parameters(self.dimensions))
        if found is not None and found != dimension:
            raise ValueError(f"{value!r} has the wrong dimension")
        return evaluate(tree, self.parameters) * (factor if found is None else 1.0)

    def _read_equations(self, content):
        """Sorts the equations into definitions and differential equations, and checks names and dimensions."""
        equations = [parse_equation(text, self.tables) for text in content["equations"]]
        self.orders = {}
        for name in (name for sides in equations for side in sides for name in names(side)):
            if name.primes:
                self.orders[name.name] = max(name.primes, self.orders.get(name.name, 0))
        self.states = [Name(name, primes) for name, order in self.orders.items() for primes in range(order)]
        self.algebraic, self.differential = {}, []
        for left, right in equations:
            self._check(left, right)
            if isinstance(left, Name) and left.name not in self.orders:
                if left in self.algebraic:
                    raise ValueError(f"{left} is defined twice")
                self.algebraic[left] = right
            else:
                self.differential.append((left, right))
        if set(self.units) != {*self.states, *self.algebraic}:
            raise ValueError(f"quantities and equations differ: {set(self.units) ^ {*self.states, *self.algebraic}}")
        if len(self.differential) != len(self.orders):
            raise ValueError(f"{len(self.differential)} differential equations for {len(self.orders)} unknowns")

    def _check(self, left, right):
        """Checks the names and the dimensions of an equation."""
        for name in names(left) + names(right):
            self.dimension(name)
        agreed([left, right], _Equations(self))

    def dimension(self, name):
        """The dimension of a name in an equation."""
        if name == Name("t"):
            return self.time
        if Name(name.name) in self.units:
            own = product(self.units[Name(name.name)].dimension, self.time, -name.primes)
            if name in self.units and self.units[name].dimension != own:
                raise ValueError(f"the unit of {name} is not that of the derivative")
            return own
        if name.primes == 0 and name.name in self.drives:
            return self.drive_units[name.name].dimension
        if name.primes == 0 and name.name in self.dimensions:
            return self.dimensions[name.name]
        raise ValueError(f"{name} is unknown")

    def _initial(self, state, quantities):
        """The initial value of a state."""
        unit = self.units[state]
        return self._setting(quantities[str(state)]["initial"], unit.dimension, unit.factor)


@dataclass(frozen=True)
class _Parameters:
    """The names of a formula of a setting: parameters only."""

    dimensions: dict
    time = TIME
    tables = {}

    def dimension(self, name):
        return self.dimensions[str(name)]


class _Equations:
    """The names of an equation."""

    def __init__(self, problem):
        self.dimension, self.time = problem.dimension, problem.time
        self.tables = {
            name: (taken.dimension, given.dimension) for name, (taken, given) in problem.table_units.items()
        }


def evaluate(node, values):
    """The value of a formula of numbers, names and plain functions."""
    match node:
        case Number(value):
            return value
        case Name():
            return values[str(node)]
        case Negate(operand):
            return -evaluate(operand, values)
        case Binary(sign, left, right):
            a, b = evaluate(left, values), evaluate(right, values)
            match sign:
                case "+":
                    return a + b
                case "-":
                    return a - b
                case "*":
                    return a * b
                case "/":
                    return a / b
            return a**b
        case Call(name, arguments):
            return FUNCTIONS[name](*(evaluate(argument, values) for argument in arguments))


def _si(value, unit):
    """A value in SI units."""
    return value * parse_unit(unit).factor


def _quantity(text):
    """The name of a quantity with its primes."""
    plain = text.rstrip("'")
    return Name(plain, len(text) - len(plain))
