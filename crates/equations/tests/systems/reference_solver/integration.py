"""Integrates a problem piece by piece, so that no step reaches across a corner.

A corner is a time that is known before the run, or the zero of a guard, which is located within a step. Between corners
the branches of the equations are fixed. After each step the guards are evaluated at several times within the step. If a
guard has left its branch, the step is cut at the zero of the guard, and the run continues there on the other branch.
"""

from bisect import bisect_right
from dataclasses import dataclass

import numpy as np
from scipy.integrate import DOP853, RK45, solve_ivp
from scipy.optimize import brentq, minimize_scalar

from .program import Program

METHODS = {"DOP853": DOP853, "RK45": RK45}
# The number of values of a reference.
SAMPLES = 11
# Each delay makes a corner one derivative smoother. A method of order 8 does not notice the corners after this many.
ECHOES = 9
# Largest steps as a share of the shortest delay. Earlier states are interpolated within steps, with a lower order.
DELAY_SHARE = {"DOP853": 1 / 40, "RK45": 1 / 400}
# A guard that changes its branch more often than this at one time has no branch to continue on.
MOST_CHANGES = 50
# Times that differ by less than this share of the run are equal.
SAME_TIME = 1e-13
# A maximum between two tests is located if it exceeds the tests by this share,
LEAST_BULGE = 1e-12
# and if it exceeds the peak so far when the parabola through the tests is wrong by this share.
PARABOLA_ERROR = 1e-4


@dataclass(frozen=True)
class Accuracy:
    """The method of a run, its relative tolerance, the absolute tolerance of each state, and the tests of each step."""

    method: str
    relative: float
    absolute: list
    tests: int


@dataclass(frozen=True)
class Solution:
    """The times, the values of all quantities at them, and the largest magnitudes in the run, in SI units."""

    times: list
    values: np.ndarray
    peaks: np.ndarray


def solve(problem, method, tolerance, tests):
    """Solves a problem. The absolute tolerance of a state is `tolerance` times its peak."""
    program = Program(problem)
    sizes = [problem.units[state].factor for state in problem.states]
    coarse = Run(program, Accuracy("DOP853", 1e-7, [1e-9 * size for size in sizes], tests)).complete()
    indices = [program.quantities.index(state) for state in problem.states]
    absolute = [tolerance * coarse.peaks[index] for index in indices]
    return Run(program, Accuracy(method, tolerance, absolute, tests)).complete()


class Run:
    """A run of a program from time 0 to its end."""

    def __init__(self, program, accuracy):
        self.program, self.problem, self.accuracy = program, program.problem, accuracy
        self.t, self.y = 0.0, np.array(self.problem.initial, dtype=float)
        self.modes = [0] * program.guard_count
        self.drives = []
        # The interpolation within each step, and the time at which it begins, for delays.
        self.begins, self.pieces = [], []
        self.peaks = [Peak() for _ in program.quantities]
        self.changes = 0

    def complete(self):
        """Runs to the end."""
        times = [self.problem.end * index / (SAMPLES - 1) for index in range(SAMPLES)]
        self.corners = set(times)
        for drive in self.problem.drives.values():
            self.corners.update(drive.corners)
        self._add_echoes(0.0)
        self._enter(self._next_corner())
        values = [self._evaluate(self.t, self.y)[2]]
        while len(values) < SAMPLES:
            corner = self._next_corner()
            self._enter(corner)
            while self.t < corner:
                self._span(corner)
            if times[len(values)] <= self.t + SAME_TIME * self.problem.end:
                values.append(self._evaluate(self.t, self.y)[2])
        return Solution(times, np.array(values), np.array([peak.value for peak in self.peaks]))

    def _next_corner(self):
        """The next corner that is not equal to the present time."""
        least = SAME_TIME * self.problem.end
        return min(corner for corner in self.corners if corner > self.t + least)

    def _enter(self, corner):
        """Selects the pieces of the drives and the branches of the equations after a corner."""
        middle = 0.5 * (self.t + corner)
        self.drives = [drive.piece(middle) for drive in self.problem.drives.values()]
        self.modes = [0] * len(self.modes)
        self._evaluate(self.t, self.y)

    def _evaluate(self, t, y):
        """The rates, the guards and the quantities."""
        return self.program.evaluate(t, y, self.modes, self.drives, self._past)

    def _rates(self, t, y):
        """The rates. The solver rejects a trial step that leads to rates that are not numbers."""
        try:
            return self._evaluate(t, y.tolist())[0]
        except (OverflowError, ValueError, ZeroDivisionError):
            return [np.nan] * len(y)

    def _past(self, state, time):
        """An earlier value of a state. Before the run it is the initial value."""
        if time <= 0.0:
            return self.problem.initial[state]
        return self.pieces[bisect_right(self.begins, time) - 1](time)[state]

    def _add_echoes(self, time):
        """Adds the times at which a corner leaves the delays."""
        for delay in self.program.delays:
            self.corners.update(time + count * delay for count in range(1, ECHOES + 1))

    def _span(self, corner):
        """Integrates up to a corner, or up to the first zero of a guard before it."""
        options = {"rtol": self.accuracy.relative, "atol": self.accuracy.absolute}
        if self.program.delays:
            options["max_step"] = DELAY_SHARE[self.accuracy.method] * min(self.program.delays)
        solver = METHODS[self.accuracy.method](self._rates, self.t, self.y, corner, **options)
        while solver.status == "running":
            begin, state = solver.t, solver.y.copy()
            # A rejected trial step has an error that is not a number.
            with np.errstate(invalid="ignore"):
                message = solver.step()
            if solver.status == "failed":
                raise ArithmeticError(f"{self.problem.title} at {solver.t}: {message}")
            step = Step(self, begin, state, solver.t, solver.y.copy(), solver.dense_output(), options)
            zero = step.first_zero()
            if zero is not None:
                self._change_branch(step, *zero)
                return
            self._accept(step)

    def _accept(self, step):
        """Moves to the end of a step and records it."""
        if self.program.delays:
            self.begins.append(step.begin)
            self.pieces.append(step.dense)
        for index, peak in enumerate(self.peaks):
            peak.read(step, index)
        self.t, self.y = step.end, step.end_state

    def _change_branch(self, step, guard, time):
        """Moves to the zero of a guard and continues on its other branch."""
        self.changes = 0 if time > self.t + SAME_TIME * self.problem.end else self.changes + 1
        if self.changes > MOST_CHANGES:
            raise ArithmeticError(f"{self.problem.title} at {time}: a guard has no branch to continue on")
        if time > step.begin:
            self._accept(step.cut(time))
            self._add_echoes(time)
        self.modes[guard] = -self.modes[guard]


class Step:
    """A step of the solver, with the guards and the quantities at several times within it."""

    def __init__(self, run, begin, state, end, end_state, dense, options):
        self.run, self.begin, self.state, self.end, self.end_state = run, begin, state, end, end_state
        self.dense, self.options = dense, options
        self.times = np.linspace(begin, end, run.accuracy.tests + 1)
        states = [state, *dense(self.times[1:-1]).T, end_state]
        results = [run._evaluate(time, state.tolist()) for time, state in zip(self.times, states)]
        self.guards = np.array([guards for _, guards, _ in results])
        self.quantities = np.array([quantities for _, _, quantities in results])

    def first_zero(self):
        """The first guard that leaves its branch within the step, and the time. None if no guard does."""
        signed = self.guards * np.array(self.run.modes)
        outside = signed[1:] < 0.0
        if not outside.any():
            return None
        first = int(np.argmax(outside.any(axis=1)))
        zeros = [(self._zero(guard, first), int(guard)) for guard in np.flatnonzero(outside[first])]
        time, guard = min(zeros)
        return guard, time

    def _zero(self, guard, interval):
        """The time at which a guard is zero within an interval between two tests."""
        low, high = self.times[interval], self.times[interval + 1]
        if self.guards[interval, guard] * self.run.modes[guard] <= 0.0:
            return low
        if self._guard(guard, high, self.dense(high)) * self.run.modes[guard] >= 0.0:
            return high
        coarse = brentq(lambda time: self._guard(guard, time, self.dense(time)), low, high, xtol=1e-15 * high)
        return self._refined(guard, coarse)

    def _refined(self, guard, time):
        """Improves a zero by Newton's method on states that the solver computes, not its interpolation."""
        distance = 1e-3 * (self.end - self.begin)
        low, high = max(time - distance, self.begin), min(time + distance, self.end)
        slope = (
            self._guard(guard, high, self.dense(high)) - self._guard(guard, low, self.dense(low))
        ) / (high - low)
        for _ in range(2):
            change = self._guard(guard, time, self._state(time)) / slope if slope else 0.0
            # A guard that only touches zero has no slope, and the correction is not meaningful.
            if not abs(change) < distance:
                break
            time = min(max(time - change, self.begin), self.end)
        return time

    def _guard(self, guard, time, state):
        return self.run._evaluate(time, state.tolist())[1][guard]

    def _state(self, time):
        """The state at a time within the step, by a run of the solver from the begin of the step."""
        if time <= self.begin:
            return self.state
        method = METHODS[self.run.accuracy.method]
        return solve_ivp(self.run._rates, (self.begin, time), self.state, method, **self.options).y[:, -1]

    def maximum(self, index, low, high):
        """The largest magnitude of a quantity between two times."""

        def negative(time):
            return -abs(self.run._evaluate(time, self.dense(time).tolist())[2][index])

        options = {"xatol": 1e-6 * (high - low)}
        return -minimize_scalar(negative, bounds=(low, high), method="bounded", options=options).fun

    def cut(self, time):
        """The step up to a time within it."""
        return Step(self.run, self.begin, self.state, time, self._state(time), self.dense, self.options)


class Peak:
    """The largest magnitude of a quantity in a run."""

    def __init__(self):
        self.value = 0.0

    def read(self, step, index):
        """Reads the tests of a step. If a maximum between the tests may be larger than the value, it is located."""
        values = np.abs(step.quantities[:, index])
        largest = int(np.argmax(values))
        middle = min(max(largest, 1), len(values) - 2)
        estimate = vertex(*values[middle - 1:middle + 2])
        is_between = estimate > values[largest] * (1.0 + LEAST_BULGE)
        self.value = max(self.value, values[largest])
        if is_between and estimate * (1.0 + PARABOLA_ERROR) > self.value:
            self.value = max(self.value, step.maximum(index, step.times[middle - 1], step.times[middle + 1]))


def vertex(before, middle, after):
    """The maximum of the parabola through three equally spaced values, if it is between them; otherwise 0."""
    slope, curvature = 0.5 * (after - before), before - 2.0 * middle + after
    if curvature >= 0.0 or abs(slope) > -curvature:
        return 0.0
    return middle - 0.5 * slope**2 / curvature
