"""Fig 8.16 wired from blocks of PathSim.

pathsim_fig_8_16.py method=RKDP54 setting=1e-6 for=2 out=FILE prints the duration of solving in s and writes v_o every 1 ms. The
setting is the tolerance, or the step in s with method=RK4. The position is in 10 um and the velocity in mm/s.
"""

import sys
import time

import numpy as np
from pathsim import Connection, Simulation
from pathsim import solvers
from pathsim.blocks import Abs, Adder, Amplifier, Clip, Function, Integrator, Pow, Scope, Source

words = dict(word.split("=", 1) for word in sys.argv[1:])
duration, setting, method = float(words["for"]), float(words["setting"]), words["method"]
K, M, F, FS, VCL, TC, V_RATE = 45e6, 433.0, 10.7e3, 771.0, 2.54e-3, 0.0065, 1.2e-3
POSITION, VELOCITY = 1e-5, 1e-3

command = Source(lambda t: V_RATE / VELOCITY * t)
difference, to_position, error = Adder("+-"), Amplifier(VELOCITY / POSITION), Integrator(0.0)
spring = Amplifier(K * POSITION)
square, level = Pow(exponent=2), Amplifier(FS)
dead_zone = Function(lambda w, force: w - force if w > force else w + force if w < -force else 0.0)
viscous, force, acceleration = Amplifier(F * VELOCITY), Adder("+-"), Amplifier(1 / (M * VELOCITY))
velocity = Integrator(0.0)
speed, by_vcl, limited = Abs(), Amplifier(VELOCITY / VCL), Clip(0.0, 1.0)
rest = Source(lambda t: 1.0)
lagging, per_tc, memory = Adder("+--"), Amplifier(1 / TC), Integrator(1.0)
scope = Scope(sampling_period=1e-3)
blocks = [command, difference, to_position, error, spring, square, level, dead_zone, viscous, force, acceleration, velocity,
          speed, by_vcl, limited, rest, lagging, per_tc, memory, scope]
cords = [
    Connection(command, difference[0]),
    Connection(velocity, difference[1], viscous, speed, scope),
    Connection(difference, to_position), Connection(to_position, error), Connection(error, spring),
    Connection(memory, square, lagging[2]), Connection(square, level),
    Connection(spring, dead_zone[0]), Connection(level, dead_zone[1]),
    Connection(dead_zone, force[0]), Connection(viscous, force[1]),
    Connection(force, acceleration), Connection(acceleration, velocity),
    Connection(speed, by_vcl), Connection(by_vcl, limited),
    Connection(rest, lagging[0]), Connection(limited, lagging[1]), Connection(lagging, per_tc), Connection(per_tc, memory),
]
solver = getattr(solvers, method)
fixed = method == "RK4"
options = {} if fixed else {"tolerance_lte_abs": setting, "tolerance_lte_rel": setting}
machine = Simulation(blocks, cords, dt=setting if fixed else 2e-5, Solver=solver, log=False, **options)
start = time.perf_counter()
machine.run(duration, adaptive=not fixed)
seconds = time.perf_counter() - start
t, (v,) = scope.read()
rows = np.arange(round(duration / 1e-3)) * 1e-3
(np.interp(rows, t, v) * VELOCITY).astype(float).tofile(words["out"])
print(f'{{"seconds": {seconds:.9f}}}')
