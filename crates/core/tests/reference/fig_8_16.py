"""Writes fig_8_16.csv: the slideway of Fig 8.16 solved in physical units by SciPy, for crates/core/tests/scipy.rs.

    e' = v_i - v              w = K e              F = Fs max(u, 0)^2
    d  = w - F (w > F),  w + F (w < -F),  0 otherwise
    M v' = d - f v            Tc u' = (1 - min(|v| / VcL, 1)) - u

Start e = 0, v = 0, u = 1. Solved with steps of at most 20 us, so that no kink is stepped over, in quantities scaled
to the size of 1. Needs numpy and scipy; run it in this folder.
"""

import csv

import numpy as np
from scipy.integrate import solve_ivp

SETTINGS = [
    {"VcL": 2.54e-3, "Tc": 0.0065, "v_rate": 1.2e-3},
    {"VcL": 1.27e-3, "Tc": 0.006, "v_rate": 1.2e-3, "v_start": 1e-3},
    {"VcL": 5.08e-3, "Tc": 0.0095, "v_rate": 2.4e-3, "v_start": 2e-3},
    {"VcL": 25.4e-3, "Tc": 0.025, "v_rate": 1.2e-3, "v_start": 3e-3, "K": 17.86e6, "M": 454.0},
    {"VcL": 10.16e-3, "Tc": 0.002, "v_rate": 0.0, "v_start": 1e-3, "f": 2e3, "Fs": 300.0},
    {"VcL": 2.54e-3, "Tc": 0.5, "v_rate": 1.2e-3, "v_start": -1e-3, "K": 80e6, "M": 1000.0},
]
DEFAULTS = {"M": 433.0, "K": 45e6, "f": 10.7e3, "Fs": 771.0, "v_start": 0.0}
TIMES = np.arange(0, 201) * 1e-3
POSITION, VELOCITY = 1e-5, 1e-3


def rates(p):
    def right_hand_side(t, y):
        e, v, u = y[0] * POSITION, y[1] * VELOCITY, y[2]
        spring, solid = p["K"] * e, p["Fs"] * max(u, 0.0) ** 2
        force = spring - solid if spring > solid else spring + solid if spring < -solid else 0.0
        command = p["v_start"] + p["v_rate"] * t
        share = 1.0 - min(abs(v) / p["VcL"], 1.0)
        return [(command - v) / POSITION, (force - p["f"] * v) / p["M"] / VELOCITY, (share - u) / p["Tc"]]

    return right_hand_side


with open("fig_8_16.csv", "w", newline="") as file:
    table = csv.writer(file, lineterminator="\n")
    table.writerow(["case", "t", "v_o", "spring_force", "memory"])
    for number, setting in enumerate(SETTINGS):
        p = DEFAULTS | setting
        solved = solve_ivp(
            rates(p), (0, TIMES[-1]), [0, 0, 1], "DOP853", TIMES, rtol=1e-11, atol=1e-12, max_step=2e-5
        )
        print(f"// case {number}:", " ".join(f"--set {k}={v}" for k, v in setting.items()))
        for t, e, v, u in zip(solved.t, *solved.y):
            table.writerow([number, f"{t:.3f}", f"{v * VELOCITY:.10e}", f"{p['K'] * e * POSITION:.10e}", f"{u:.10e}"])
