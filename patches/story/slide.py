"""Writes train-1.csv ... test-3.csv: a slide with the friction of Fig 8.16, pulled by short jogs, as instruments would read it.

    e' = v_i - v              w = K (e + x_i)      F = Fs max(u, 0)^2
    d  = w - F (w > F),  w + F (w < -F),  0 otherwise
    M v' = d - f v            Tc u' = (1 - min(|v| / VcL, 1)) - u

By Runge and Kutta with steps of 5 us; it shares nothing with the emulator. Noise is normal, by the generator of Python's
`random` with the seeds below. Run it in this folder.
"""

import random

M, K, F, FS, VCL, TC = 433.0, 45e6, 10.7e3, 771.0, 10.16e-3, 0.0065
INTERVAL, STEPS = 1e-3, 200
# Standard deviations of position error, velocity and spring force, in m, m/s and N.
NOISE = (0.2e-6, 0.05e-3, 5.0)
# Samples of a jog: at rest, up, steady, down, at rest again until the end. Before each the spring is let slack.
REST, RAMP, STEADY, ALL = 5, 10, 30, 71
# The position command moves this much further, in um, while the velocity command returns to 0.
NUDGE = 10.0
TRAIN, TEST = [4.0, -7.0, 10.0, -5.0], [-6.0, 8.5, -3.0]


def commands(speed):
    """Velocity, and a nudge of position at the end of the jog, sample by sample."""
    up = [speed * step / RAMP for step in range(RAMP)]
    jog = [0.0] * REST + up + [speed] * STEADY + [speed - part for part in up]
    nudge = [0.0] * (REST + RAMP + STEADY) + [NUDGE * step / RAMP for step in range(RAMP)]
    rest = ALL - len(jog)
    return [(v * 1e-3, x * 1e-6) for v, x in zip(jog + [0.0] * rest, nudge + [NUDGE] * rest)]


def rates(command, state):
    (v_i, x_i), (e, v, u) = command, state
    w, friction = K * (e + x_i), FS * max(u, 0.0) ** 2
    d = w - friction if w > friction else w + friction if w < -friction else 0.0
    return v_i - v, (d - F * v) / M, (1.0 - min(abs(v) / VCL, 1.0) - u) / TC


def step(state, begin, middle, end, h):
    along = lambda slope, part: [own + part * h * rate for own, rate in zip(state, slope)]
    first = rates(begin, state)
    second = rates(middle, along(first, 0.5))
    third = rates(middle, along(second, 0.5))
    fourth = rates(end, along(third, 1.0))
    mean = [(a + 2 * b + 2 * c + d) / 6 for a, b, c, d in zip(first, second, third, fourth)]
    return along(mean, 1.0)


def write(name, speed, noise):
    drive, state = commands(speed), [0.0, 0.0, 1.0]
    with open(name, "w", newline="") as file:
        file.write("# v_in: mm/s\n# x_in: um\n# e: um\n# v: mm/s\n# w: N\nt,v_in,x_in,e,v,w\n")
        for sample, (now, then) in enumerate(zip(drive, drive[1:] + drive[-1:])):
            (v_i, x_i), (e, v, _) = now, state
            seen = (e + x_i, v, K * (e + x_i))
            e, v, w = (own + noise.gauss(0.0, sigma) for own, sigma in zip(seen, NOISE))
            row = [f"{sample * INTERVAL:.3f}", f"{v_i * 1e3:.3f}", f"{x_i * 1e6:.1f}"]
            file.write(",".join([*row, f"{e * 1e6:.2f}", f"{v * 1e3:.3f}", f"{w:.1f}"]) + "\n")
            at = lambda part: [a + (b - a) * part / STEPS for a, b in zip(now, then)]
            for part in range(STEPS):
                state = step(state, at(part), at(part + 0.5), at(part + 1), INTERVAL / STEPS)


for use, speeds, seed in (("train", TRAIN, 1), ("test", TEST, 2)):
    noise = random.Random(seed)
    for number, speed in enumerate(speeds, 1):
        write(f"{use}-{number}.csv", speed, noise)
