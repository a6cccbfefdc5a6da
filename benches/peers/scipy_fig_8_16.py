"""Fig 8.16 with SciPy.

scipy_fig_8_16.py method=DOP853 setting=1e-8 for=2 out=FILE prints the duration of solving in s and writes v_o every 1 ms. The
setting is the tolerance. The equations are those of slideway.h, with position and velocity scaled to the order of 1.
"located-DOP853" ends a solution at every kink and starts the next piece there. The other methods ignore kinks.
"""

import sys
import time

import numpy as np
from scipy.integrate import solve_ivp

words = dict(word.split("=", 1) for word in sys.argv[1:])
duration, setting = float(words["for"]), float(words["setting"])
K, M, F, FS, VCL, TC, V_RATE = 45e6, 433.0, 10.7e3, 771.0, 2.54e-3, 0.0065, 1.2e-3
POSITION, VELOCITY = 1e-5, 1e-3
times = np.arange(round(duration / 1e-3)) * 1e-3
rest = [0.0, 0.0, 1.0]


def without_location(method):
    """The velocity in m/s by one solution over all kinks."""
    def rates(t, y):
        w, v, u = K * POSITION * y[0], VELOCITY * y[1], y[2]
        level = FS * max(u, 0.0) ** 2
        d = w - level if w > level else w + level if w < -level else 0.0
        share = 1.0 - min(abs(v) / VCL, 1.0)
        return [(V_RATE * t - v) / POSITION, (d - F * v) / M / VELOCITY, (share - u) / TC]

    return solve_ivp(rates, (0, duration), rest, method, times, rtol=setting, atol=setting).y[1] * VELOCITY


def with_location(method):
    """The velocity in m/s by one solution per piece: side of the dead zone, sign of v, whether |v| exceeds VcL."""
    piece = {"side": 0, "sign": 1, "beyond": False}

    def rates(t, y):
        w, v, u = K * POSITION * y[0], VELOCITY * y[1], y[2]
        side = piece["side"]
        d = w - side * FS * u * u if side else 0.0
        share = 0.0 if piece["beyond"] else 1.0 - piece["sign"] * v / VCL
        return [(V_RATE * t - v) / POSITION, (d - F * v) / M / VELOCITY, (share - u) / TC]

    def plus(t, y):
        return K * POSITION * y[0] - FS * y[2] ** 2

    def minus(t, y):
        return K * POSITION * y[0] + FS * y[2] ** 2

    def sign(t, y):
        # At rest the table keeps its direction.
        return y[1] or piece["sign"] * 1e-300

    def corner(t, y):
        return piece["sign"] * y[1] * VELOCITY - VCL

    kinks = [plus, minus, sign, corner]
    for kink in kinks:
        kink.terminal = True

    def set_directions():
        side = piece["side"]
        plus.direction = -1 if side > 0 else 1
        minus.direction = 1 if side < 0 else -1
        sign.direction = -piece["sign"]
        corner.direction = -1 if piece["beyond"] else 1

    t, y, velocities = 0.0, rest, []
    while t < duration:
        set_directions()
        # Longer steps would miss kinks that are passed twice within one step.
        options = {"max_step": 5e-4, "rtol": setting, "atol": setting}
        part = solve_ivp(rates, (t, duration), y, method, dense_output=True, events=kinks, **options)
        end = part.t[-1]
        inside = times[(times >= t) & (times < end)]
        if len(inside):
            velocities.append(part.sol(inside)[1])
        t, y = end, part.y[:, -1]
        kinks_met = [index for index, events in enumerate(part.t_events) if len(events)]
        if part.status != 1:
            break
        if 0 in kinks_met:
            piece["side"] = 0 if piece["side"] > 0 else 1
        if 1 in kinks_met:
            piece["side"] = 0 if piece["side"] < 0 else -1
        if 2 in kinks_met:
            piece["sign"] = -piece["sign"]
        if 3 in kinks_met:
            piece["beyond"] = not piece["beyond"]
    return np.concatenate(velocities) * VELOCITY


method = words["method"]
start = time.perf_counter()
velocity = with_location(method[8:]) if method.startswith("located-") else without_location(method)
seconds = time.perf_counter() - start
velocity.astype(float).tofile(words["out"])
print(f'{{"seconds": {seconds:.9f}}}')
