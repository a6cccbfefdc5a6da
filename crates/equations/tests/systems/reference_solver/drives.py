"""The drives: functions of time with corners, as the elements of patchcord define them.

A drive is smooth between its corners. `piece` returns the function that holds on the smooth piece around a time. So a
step of the solver that ends at a jump does not read the value after the jump. `corners` are the times between the
pieces, at least up to the end of the run.
"""

import math
from bisect import bisect_right

# The settings of each kind, and the place of each. "value" has the unit of the drive; "time", "frequency" and "rate"
# are in seconds, cycles per second and units per second; "angle" and "share" are pure numbers; "plain" is no formula.
SETTINGS = {
    "step": {"height": "value", "at": "time"},
    "sine": {"amplitude": "value", "frequency": "frequency", "phase": "angle", "offset": "value"},
    "square": {"amplitude": "value", "frequency": "frequency", "duty": "share", "phase": "angle", "offset": "value"},
    "pulse": {"height": "value", "begin": "time", "width": "time", "period": "time"},
    "ramp": {"start": "value", "rate": "rate", "turn": "time"},
    "triangle": {"amplitude": "value", "frequency": "frequency", "offset": "value"},
    "chirp": {"amplitude": "value", "from": "frequency", "to": "frequency", "time": "time", "phase": "angle",
              "offset": "value"},
    "table": {"points": "plain"},
}


class Step:
    """0 before a time, a height from then on."""

    def __init__(self, end, height, at=0.0):
        self.height, self.corners = height, [at]

    def piece(self, inside):
        height = self.height if inside >= self.corners[0] else 0.0
        return lambda t: height


class Sine:
    """A sine wave about an offset."""

    def __init__(self, end, amplitude, frequency, phase=0.0, offset=0.0):
        self.corners = []
        self.wave = lambda t: offset + amplitude * math.sin(2.0 * math.pi * frequency * t + phase)

    def piece(self, inside):
        return self.wave


class Square:
    """A square wave about an offset. It rises at the phase 0."""

    def __init__(self, end, amplitude, frequency, duty=0.5, phase=0.0, offset=0.0):
        self.high, self.low = offset + amplitude, offset - amplitude
        self.frequency, self.duty, self.cycles = frequency, duty, phase / (2.0 * math.pi)
        count = math.ceil(end * frequency + abs(self.cycles)) + 2
        self.corners = [
            (number + edge - self.cycles) / frequency for number in range(-1, count) for edge in (0.0, duty)
        ]

    def piece(self, inside):
        value = self.high if (self.frequency * inside + self.cycles) % 1.0 < self.duty else self.low
        return lambda t: value


class Pulse:
    """A rectangular pulse, once or repeated."""

    def __init__(self, end, height, width, begin=0.0, period=None):
        self.height, self.begin, self.width, self.period = height, begin, width, period
        count = 1 if period is None else math.ceil(end / period) + 1
        self.corners = [begin + number * (period or 0.0) + edge for number in range(count) for edge in (0.0, width)]

    def piece(self, inside):
        since = inside - self.begin
        if self.period is not None and since >= 0.0:
            since %= self.period
        value = self.height if 0.0 <= since < self.width else 0.0
        return lambda t: value


class Ramp:
    """A ramp from a start value, which may reverse at a given time."""

    def __init__(self, end, rate, start=0.0, turn=None):
        self.start, self.rate, self.corners = start, rate, [] if turn is None else [turn]

    def piece(self, inside):
        if self.corners and inside > self.corners[0]:
            return lambda t: self.start + self.rate * (2.0 * self.corners[0] - t)
        return lambda t: self.start + self.rate * t


class Triangle:
    """A triangular wave about an offset. It rises at 0."""

    def __init__(self, end, amplitude, frequency, offset=0.0):
        self.amplitude, self.frequency, self.offset = amplitude, frequency, offset
        self.corners = [(half / 2.0 + 0.25) / frequency for half in range(math.ceil(2.0 * end * frequency) + 1)]

    def piece(self, inside):
        half_periods = math.floor(2.0 * (self.frequency * inside + 0.25))
        slope = 1.0 if half_periods % 2 == 0 else -1.0
        return lambda t: self.offset + slope * self.amplitude * (4.0 * self.frequency * t - 2.0 * half_periods)


class Chirp:
    """A sine wave whose frequency rises or falls linearly and then stays."""

    def __init__(self, end, amplitude, time, phase=0.0, offset=0.0, **frequencies):
        self.amplitude, self.time, self.phase, self.offset = amplitude, time, phase, offset
        self.first, self.last, self.corners = frequencies["from"], frequencies["to"], [time]

    def piece(self, inside):
        change = (self.last - self.first) / (2.0 * self.time)
        if inside < self.time:
            return lambda t: self.wave((self.first + change * t) * t)
        swept = (self.first + change * self.time) * self.time
        return lambda t: self.wave(swept + self.last * (t - self.time))

    def wave(self, cycles):
        """The value after a number of cycles."""
        return self.offset + self.amplitude * math.sin(2.0 * math.pi * cycles + self.phase)


class Table:
    """Straight lines through points in time, constant before and after them."""

    def __init__(self, end, points):
        self.corners, self.values = [list(column) for column in zip(*points)]

    def piece(self, inside):
        after = bisect_right(self.corners, inside)
        if after in (0, len(self.corners)):
            value = self.values[max(after - 1, 0)]
            return lambda t: value
        (t0, t1), (v0, v1) = self.corners[after - 1:after + 1], self.values[after - 1:after + 1]
        return lambda t: v0 + (v1 - v0) * ((t - t0) / (t1 - t0))


KINDS = {
    "step": Step, "sine": Sine, "square": Square, "pulse": Pulse, "ramp": Ramp, "triangle": Triangle, "chirp": Chirp,
    "table": Table,
}
