"""Writes fig_8_16_coulomb.csv and fig_8_16_coulomb_ramp.csv: the slideway of Fig 8.16 with Coulomb friction, solved in
physical units by SciPy, for crates/thesis/tests/thesis/fig_8_16_coulomb.rs.

    e' = v_i - v              w = K e              F = Fs max(u, 0)^2          Tc u' = (1 - min(|v| / VcL, 1)) - u
    slides (s = sign v):      M v' = w - f v - s F
    stands still (v = 0):     for as long as |w| <= F

Start e = 0, v = 0, u = 1, standing still. Every change (release, standstill, turning round, |v| passing VcL) is an
event at which the solution starts again, so that no step contains a kink; quantities are scaled to the size of
1. While it stands still, v is not solved for: it is 0. Needs numpy and scipy; run it in this folder.
"""

import csv

import numpy as np
from scipy.integrate import solve_ivp

SETTINGS = [
    {"v_start": 0.5e-3, "v_rate": 0.0},
    {"v_start": 1.5e-3},
    {"VcL": 1.27e-3, "Tc": 0.006, "v_start": -1e-3, "v_rate": -1.2e-3},
    {"VcL": 5.08e-3, "Tc": 0.0095, "v_rate": 2.4e-3, "v_start": 2e-3},
    {"VcL": 25.4e-3, "Tc": 0.025, "v_start": 3e-3, "K": 17.86e6, "M": 454.0},
    {"VcL": 10.16e-3, "Tc": 0.002, "v_rate": 0.0, "v_start": 1e-3, "f": 2e3, "Fs": 300.0},
    {"Tc": 0.5, "v_start": -1e-3, "v_rate": 10e-3, "K": 80e6, "M": 1000.0},
    {"v_start": 3e-3, "v_rate": -20e-3},
]
DEFAULTS = {"M": 433.0, "K": 45e6, "f": 10.7e3, "Fs": 771.0, "VcL": 2.54e-3, "Tc": 0.0065, "v_start": 0.0, "v_rate": 1.2e-3}
TIMES = np.arange(0, 301) * 1e-3
RAMP_TIMES = np.arange(0, 8467) * 1e-3
POSITION, VELOCITY = 1e-5, 1e-3
STUCK = 0


class Slideway:
    def __init__(self, setting):
        self.p = DEFAULTS | setting

    def command(self, t):
        return self.p["v_start"] + self.p["v_rate"] * t

    def friction(self, u):
        return self.p["Fs"] * max(u, 0.0) ** 2

    def rates(self, sign, fast):
        p = self.p

        def slides(t, y):
            e, v, u = y[0] * POSITION, y[1] * VELOCITY, y[2]
            share = 0.0 if fast else 1.0 - abs(v) / p["VcL"]
            force = p["K"] * e - p["f"] * v - sign * self.friction(u)
            return [(self.command(t) - v) / POSITION, force / p["M"] / VELOCITY, (share - u) / p["Tc"]]

        def stands(t, y):
            return [self.command(t) / POSITION, 0.0, (1.0 - y[2]) / p["Tc"]]

        return stands if sign == STUCK else slides

    def events(self, sign, fast):
        """What ends a stretch: the next (sign, fast) is worked out from the state there."""
        p = self.p

        def release(t, y):
            return (abs(p["K"] * y[0] * POSITION) - self.friction(y[2])) / p["Fs"]

        def stop(t, y):
            return sign * y[1]

        def passes(t, y):
            return abs(y[1]) * VELOCITY / p["VcL"] - 1.0

        release.direction, stop.direction, passes.direction = 1, -1, -1 if fast else 1
        ends = [release] if sign == STUCK else [passes] if fast else [stop, passes]
        for event in ends:
            event.terminal = True
        return ends

    def next(self, sign, fast, which, y):
        if sign == STUCK:
            return int(np.sign(y[0])), False
        if fast or which == 1:
            return sign, not fast
        y[1] = 0.0
        holds = abs(self.p["K"] * y[0] * POSITION) <= self.friction(y[2])
        return (STUCK if holds else -sign), False

    def solved(self, times):
        """Rows of t, e, v, u, whether it stands still; and the changes (t, sign, fast)."""
        rows, changes = [], []
        t, y, sign, fast = 0.0, np.array([0.0, 0.0, 1.0]), STUCK, False
        while True:
            left = times[len(rows):]
            run = solve_ivp(
                self.rates(sign, fast), (t, times[-1]), y, "DOP853", left,
                events=self.events(sign, fast), rtol=1e-12, atol=1e-13, max_step=5e-4,
            )
            rows += [(at, *state, sign == STUCK) for at, state in zip(run.t, np.array(run.y).T)]
            if run.status != 1:
                return rows, changes
            which = next(index for index, found in enumerate(run.t_events) if len(found))
            t, y = run.t_events[which][0], run.y_events[which][0].copy()
            sign, fast = self.next(sign, fast, which, y)
            changes.append((t, sign, fast))


def critical(times, velocity, command, threshold, window=40):
    """The command at the last sample from which 40 samples swing by more than the threshold, peak to peak."""
    windows = np.lib.stride_tricks.sliding_window_view(velocity, window)
    return command[np.nonzero(np.ptp(windows, axis=1) > threshold)[0][-1]]


with open("fig_8_16_coulomb.csv", "w", newline="") as file:
    table = csv.writer(file, lineterminator="\n")
    table.writerow(["case", "t", "v_o", "spring_force", "memory", "stands"])
    for number, setting in enumerate(SETTINGS):
        slideway = Slideway(setting)
        rows, changes = slideway.solved(TIMES)
        settings = ", ".join(f'("{k}", {v})' for k, v in setting.items())
        stops = sum(sign == STUCK for _, sign, _ in changes)
        turns = sum(a[1] == -b[1] != 0 for a, b in zip(changes, changes[1:]))
        print(f"&[{settings}],  // {len(changes)} changes, {stops} standstills, {turns} turned round at once")
        for t, e, v, u, stands in rows:
            spring = slideway.p["K"] * e * POSITION
            table.writerow([number, f"{t:.3f}", f"{v * VELOCITY:.10e}", f"{spring:.10e}", f"{u:.10e}", int(stands)])

slideway = Slideway({})
rows, changes = slideway.solved(RAMP_TIMES)
time, velocity = np.array([row[0] for row in rows]), np.array([row[2] for row in rows]) * VELOCITY
stands = np.array([row[4] for row in rows])
with open("fig_8_16_coulomb_ramp.csv", "w", newline="") as file:
    table = csv.writer(file, lineterminator="\n")
    table.writerow(["quantity", "value"])
    table.writerow(["samples standing still", stands.sum()])
    table.writerow(["standstills", sum(sign == STUCK for _, sign, _ in changes)])
    table.writerow(["least velocity", f"{velocity.min():.10e}"])
    for threshold in (0.1e-3, 0.25e-3, 0.5e-3):
        vc = critical(time, velocity, slideway.command(time), threshold)
        table.writerow([f"critical velocity at {threshold * 1e3:g} mm/s", f"{vc:.10e}"])
