"""Writes fig_8_04_bode.csv: frequency responses of the linear slideway of Fig 8.4 by SciPy, for tests/linear.

    M v' = K e - f v      e' = v_i - v, and e jumps with x_i      x' = v

Columns: frequency in Hz; ratio and phase in rad of v_o on v_i, of the spring force K e on v_i (N per m/s), of x on x_i.
Needs numpy and scipy; run it in this folder.
"""

import csv

import numpy as np
from scipy import signal

M, K, F = 454.0, 17.86e6, 17.86e3

BELOW = [M / K, F / K, 1]
SYSTEMS = [([1], BELOW), ([M, F], BELOW), ([1], BELOW)]

frequencies = np.concatenate([np.logspace(0, 3, 31), [31.0, 31.56, 31.6, 32.0]])
omega = 2 * np.pi * np.sort(frequencies)
columns = [signal.freqresp(signal.TransferFunction(*system), omega)[1] for system in SYSTEMS]

with open("fig_8_04_bode.csv", "w", newline="") as file:
    table = csv.writer(file, lineterminator="\n")
    table.writerow(["hz", "v_o", "v_o_phase", "spring_force", "spring_force_phase", "x_o", "x_o_phase"])
    for row, w in enumerate(omega):
        numbers = [part for column in columns for part in (abs(column[row]), np.angle(column[row]))]
        table.writerow([repr(float(w / 2 / np.pi))] + [f"{number:.13e}" for number in numbers])
