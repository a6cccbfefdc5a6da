"""Translates the equations of a problem into a Python function.

The function is `evaluate(t, y, modes, drives, past)`:

* y are the states, in the order of `problem.states`,
* `modes` has one number for each *guard*. A guard is an expression whose sign selects a branch, such as the argument of
  `abs`. The mode is 1 or -1 and fixes the branch, so the function is smooth across the corner. A mode of 0 is replaced
  by the sign of the guard,
* `drives` are functions of time, and `past(state, time)` is an earlier value of a state.

It returns the rates of the states, the guards and all quantities, in the order of `Program.quantities`.
"""

import numpy as np

from .notation import Binary, Call, Name, Negate, Number, names
from .problem import FUNCTIONS


class Program:
    """The compiled equations of a problem."""

    def __init__(self, problem):
        self.problem = problem
        self.quantities = list(problem.units)
        self.delays = set()
        self.guard_count, self.stored_count = 0, 0
        self.lines = []
        self._translate()
        source = "def evaluate(t, y, modes, drives, past):\n" + "".join(f"    {line}\n" for line in self.lines)
        scope = dict(FUNCTIONS) | {"solve": np.linalg.solve}
        exec(compile(source, f"<{problem.title}>", "exec"), scope)
        self.evaluate = scope["evaluate"]

    def _translate(self):
        """Writes the lines of the function, each after those whose values it needs."""
        problem = self.problem
        self.known = {*problem.states}
        self.lines.append(f"{''.join(_variable(state) + ', ' for state in problem.states)}= y")
        self.lines += [f"d_{name} = drives[{index}](t)" for index, name in enumerate(problem.drives)]
        definitions, equations = dict(problem.algebraic), list(problem.differential)
        while definitions or equations:
            if not (self._define(definitions) or self._solve_one(equations) or self._solve_block(equations)):
                raise ValueError(f"{problem.title}: the equations cannot be solved for {[*definitions]}, {equations}")
        rates = [_variable(Name(state.name, state.primes + 1)) for state in problem.states]
        guards = [f"g{index}" for index in range(self.guard_count)]
        outputs = [_variable(quantity) for quantity in self.quantities]
        self.lines.append("return " + ", ".join(f"[{', '.join(values)}]" for values in (rates, guards, outputs)))

    def _define(self, definitions):
        """Writes a definition whose right side is known. False if there is none."""
        for name, right in definitions.items():
            if not self._unknowns(right):
                self.lines.append(f"{_variable(name)} = {self._code(right)}")
                self.known.add(name)
                del definitions[name]
                return True
        return False

    def _solve_one(self, equations):
        """Solves an equation with one unknown, which is a highest derivative. False if there is none."""
        for sides in equations:
            unknowns = self._unknowns(*sides)
            if len(unknowns) == 1 and self._is_highest(*unknowns):
                (unknown,) = unknowns
                factors, rest = self._linear(Binary("-", *sides), unknowns)
                self.lines.append(f"{_variable(unknown)} = -({rest or '0.0'}) / ({factors[unknown]})")
                self.known.add(unknown)
                equations.remove(sides)
                return True
        return False

    def _solve_block(self, equations):
        """Solves all equations whose unknowns are highest derivatives, as a system of linear equations."""
        block = [sides for sides in equations if all(map(self._is_highest, self._unknowns(*sides)))]
        unknowns = sorted({name for sides in block for name in self._unknowns(*sides)}, key=str)
        if not block or len(unknowns) != len(block):
            return False
        rows, rests = [], []
        for sides in block:
            factors, rest = self._linear(Binary("-", *sides), unknowns)
            rows.append(f"[{', '.join(factors.get(unknown, '0.0') for unknown in unknowns)}]")
            rests.append(f"-({rest or '0.0'})")
            equations.remove(sides)
        variables = "".join(f"{_variable(unknown)}, " for unknown in unknowns)
        self.lines.append(f"{variables}= solve([{', '.join(rows)}], [{', '.join(rests)}]).tolist()")
        self.known.update(unknowns)
        return True

    def _unknowns(self, *nodes):
        """The quantities of expressions whose values are not known yet."""
        found = {name for node in nodes for name in names(node) if self._is_quantity(name)}
        return found - self.known

    def _is_quantity(self, name):
        return name.name in self.problem.orders or name in self.problem.algebraic

    def _is_highest(self, name):
        return self.problem.orders.get(name.name) == name.primes

    def _linear(self, node, unknowns):
        """An expression as a linear function: the code of the factor of each unknown, and that of the rest or None."""
        if not any(name in unknowns for name in names(node)):
            return {}, self._code(node)
        match node:
            case Name():
                return {node: "1.0"}, None
            case Negate(operand):
                return self._scaled(self._linear(operand, unknowns), "-{}")
            case Binary("+" | "-" as sign, left, right):
                first, second = self._linear(left, unknowns), self._linear(right, unknowns)
                return _added(first, second if sign == "+" else self._scaled(second, "-{}"))
            case Binary("*", left, right) if not any(name in unknowns for name in names(right)):
                return self._scaled(self._linear(left, unknowns), "{} * " + self._code(right))
            case Binary("*", left, right) if not any(name in unknowns for name in names(left)):
                return self._scaled(self._linear(right, unknowns), "{} * " + self._code(left))
            case Binary("/", left, right) if not any(name in unknowns for name in names(right)):
                return self._scaled(self._linear(left, unknowns), "{} / " + self._code(right))
        raise ValueError(f"{node} is not linear in {unknowns}")

    @staticmethod
    def _scaled(linear, form):
        """A linear function with each of its terms written into a form."""
        factors, rest = linear
        scaled = {name: f"({form.format(factor)})" for name, factor in factors.items()}
        return scaled, rest and f"({form.format(rest)})"

    def _code(self, node):
        """The Python expression of a known expression."""
        match node:
            case Number(value):
                return repr(value)
            case Name():
                return self._name(node)
            case Negate(operand):
                return f"(-{self._code(operand)})"
            case Binary("^", base, Number(value)) if value.is_integer():
                return f"({self._code(base)} ** {int(value)})"
            case Binary(sign, left, right):
                return f"({self._code(left)} {'**' if sign == '^' else sign} {self._code(right)})"
            case Call(name, arguments):
                if name == "delay":
                    return self._delay(*arguments)
                codes = [self._code(argument) for argument in arguments]
                if name in FUNCTIONS:
                    return f"{name}({', '.join(codes)})"
                codes = [self._stored(code) for code in codes]
                if name in self.problem.tables:
                    return self._table(self.problem.tables[name], *codes)
                return getattr(self, f"_{name}")(*codes)

    def _name(self, name):
        """The code of a name."""
        if name == Name("t"):
            return "t"
        if self._is_quantity(name):
            return _variable(name)
        if name.name in self.problem.drives:
            return f"d_{name.name}"
        return f"({self.problem.parameters[name.name]!r})"

    def _delay(self, delayed, time):
        """An earlier value of a state."""
        if delayed not in self.problem.states or any(map(self._is_quantity, names(time))):
            raise ValueError(f"only a state can be delayed, by a constant time, not {delayed} by {time}")
        code = self._code(time)
        self.delays.add(eval(code, dict(FUNCTIONS)))
        return f"past({self.problem.states.index(delayed)}, t - {code})"

    def _stored(self, code):
        """Writes a line that computes an argument, which is used several times. Returns its variable."""
        self.stored_count += 1
        self.lines.append(f"s{self.stored_count} = {code}")
        return f"s{self.stored_count}"

    def _guard(self, code):
        """Writes a guard, and returns the condition that its mode is positive."""
        index = self.guard_count
        self.guard_count += 1
        self.lines.append(f"g{index} = {code}")
        self.lines.append(f"if not modes[{index}]: modes[{index}] = 1 if g{index} >= 0.0 else -1")
        return f"modes[{index}] > 0"

    def _abs(self, x):
        return f"({x} if {self._guard(x)} else -{x})"

    def _sign(self, x):
        return f"(1.0 if {self._guard(x)} else -1.0)"

    def _step(self, x):
        return f"(1.0 if {self._guard(x)} else 0.0)"

    def _max(self, a, b):
        return f"({a} if {self._guard(f'{a} - {b}')} else {b})"

    def _min(self, a, b):
        return f"({b} if {self._guard(f'{a} - {b}')} else {a})"

    def _dead_zone(self, x, width):
        return f"({self._max(f'({x} - {width})', '0.0')} + {self._min(f'({x} + {width})', '0.0')})"

    def _limit(self, x, low, high):
        return self._min(self._stored(self._max(x, low)), high)

    def _table(self, table, x):
        """Straight lines: the first line, and the change of slope beyond each inner point."""
        inputs, values = table.inputs, table.values
        pairs = zip(zip(inputs, values), zip(inputs[1:], values[1:]))
        slopes = [(y1 - y0) / (x1 - x0) for (x0, y0), (x1, y1) in pairs]
        terms = [repr(values[0]), f"{slopes[0]!r} * ({x} - {inputs[0]!r})"]
        for point, before, after in zip(inputs[1:], slopes, slopes[1:]):
            distance = f"({x} - {point!r})"
            terms.append(f"({after - before!r} * {distance} if {self._guard(distance)} else 0.0)")
        return f"({' + '.join(terms)})"


def _variable(name):
    """The variable of a quantity or of one of its derivatives."""
    return f"q_{name.name}_{name.primes}"


def _added(first, second):
    """The sum of two linear functions."""
    factors = dict(first[0])
    for name, factor in second[0].items():
        factors[name] = f"({factors[name]} + {factor})" if name in factors else factor
    rests = [rest for rest in (first[1], second[1]) if rest is not None]
    return factors, f"({' + '.join(rests)})" if rests else None
