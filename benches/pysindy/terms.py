"""The input of pysindy: states from measured outputs, and the effects of patches/effects as terms of states, drive and time.

A term is a column. Its key is (effect, number), where the number is the parameter inside the term (a level, a time, a position) from a
grid. Effects on the drive (delay, lag, play, limits) are terms, because the drive is known. Memory and presliding of friction are
computed along the estimated velocity. There are no terms for static friction that grows at rest, a stop with restitution, and a limit
of a level, because they are not functions of the states.
"""

import json
from pathlib import Path

import numpy as np
import pysindy as ps
from scipy.interpolate import splev, splrep
from scipy.signal import lfilter

A1, A2, C = 0.02, 0.03, 12e3                    # known: areas of the tanks in m2, damping of the slide's drive in N s/m
HALF = {"slide": 13, "axis": 48, "heater": 38}      # half the width of a test function in samples; 32 for other systems
# Tried windows of the smoothing filter, in samples.
WINDOWS = (5, 7, 9, 13, 17, 25, 33, 49, 65, 97)


class Case:
    """An experiment of `patchcord gap` with its records."""

    def __init__(self, folder):
        experiment = json.loads((Path(folder) / "experiment.json").read_text())
        patch = json.loads(Path(experiment["patch"]).read_text())
        self.system = Path(experiment["patch"]).stem
        self.family, self.drive, self.fit = self.system.split("-")[0], next(iter(experiment["drives"])), experiment["fit"]
        self.outputs = list(experiment["outputs"])
        self.sigma = {name: output.get("sigma") for name, output in experiment["outputs"].items()}
        self.offset = any(output.get("offset") for output in experiment["outputs"].values())
        self.value = {name: parameter["value"] for name, parameter in patch["parameters"].items()}
        self.half = HALF.get(self.family, 32)
        self.records = [columns(Path(folder) / name) for name in ("train.csv", "test.csv")]


def columns(path):
    """The columns of a CSV file by name."""
    with open(path) as file:
        names = file.readline().strip().split(",")
    return dict(zip(names, np.loadtxt(path, delimiter=",", skiprows=1).T))


# ---- derivatives

def smoothed(y, t, sigma, kind):
    """Derivative, smoothed signal and window: the widest smoothing with residuals no larger than the noise."""
    sigma = sigma or np.std(np.diff(y, 4)) / np.sqrt(70)
    if kind == "spline":
        method = ps.SINDyDerivative(kind="spline", s=len(y) * sigma**2, order=4)
        return method._differentiate(y, t), splev(t, splrep(t, y, k=4, s=len(y) * sigma**2)), 9
    best = None
    for window in WINDOWS:
        rate, smooth = savgol(y, t, window)
        if best and np.sqrt(np.mean((y - smooth) ** 2)) > 1.05 * sigma:
            break
        best = rate, smooth, window
    return best


def savgol(y, t, window):
    """Derivative and signal by a Savitzky-Golay filter of third order."""
    method = ps.SmoothedFiniteDifference(smoother_kws={"window_length": window, "polyorder": 3})
    return method._differentiate(y[:, None], t)[:, 0], method.smoothed_x_[:, 0]


def rate(y, t):
    """The derivative by finite differences of sixth order."""
    return ps.FiniteDifference(order=6)._differentiate(y[:, None], t)[:, 0]


def states(case, record, kind, weak):
    """The states of a record: smoothed ones for nonlinear terms, "raw" ones for the left side, "straight" ones for linear terms."""
    t, u = record["t"], record[case.drive]
    s = {"t": t, "u": u, "dt": t[1] - t[0], "end": t[-1]}
    for name in case.outputs:
        s["d" + name], s[name], s["window"] = smoothed(record[name], t, case.sigma[name], kind)
        s["raw " + name] = record[name]
        s["straight " + name] = record[name] if weak else s[name]
    if case.family in ("slide", "axis", "oscillator") and "v" not in case.outputs:
        place, sign, base = ("x_error", -1, u) if case.family == "slide" else ("x", 1, 0)
        s["v"], s["raw v"] = base + sign * s["d" + place], base + sign * rate(record[place], t)
    if "v" in s:
        s["straight v"] = s["raw v"] if weak else s["v"]
        name = "v" if "v" in case.outputs else place
        sigma, w = case.sigma[name] or np.std(np.diff(record[name], 4)) / np.sqrt(70), s["window"]
        s["v sigma"] = sigma * (1.5 / np.sqrt(w) if name == "v" else np.sqrt(75 / w**3) / s["dt"])
    if "h2" in s:
        s["straight dh2"] = rate(record["h2"], t) if weak else s["dh2"]
    return s


# ---- pieces of terms

def play(u, half):
    """The play operator."""
    out, at = np.empty_like(u), u[0]
    for i, now in enumerate(u):
        at = out[i] = min(max(at, now - half), now + half)
    return out


def bristle(distance, reach):
    """Dahl friction: approaches +-1 over the distance `reach`."""
    out, at = np.zeros_like(distance), 0.0
    for i, step in enumerate(np.diff(distance)):
        at = out[i + 1] = np.sign(step) - (np.sign(step) - at) * np.exp(-abs(step) / reach)
    return out


def lagged(u, samples):
    """First-order lag of a signal that is linear between samples."""
    decay = np.exp(-1 / samples)
    now = 1 - samples * (1 - decay)
    return lfilter([now, 1 - now - decay], [1, -decay], u, zi=[u[0] * (1 - now)])[0]


def delayed(u, samples):
    """The signal delayed by a number of samples."""
    n = np.arange(len(u))
    return np.interp(n - samples, n, u)


def integral(y, dt):
    """The integral by the trapezoidal rule."""
    return np.concatenate([[0], np.cumsum((y[1:] + y[:-1]) / 2 * dt)])


# ---- terms

def drive_terms(case, s, g):
    """Terms for effects on the drive: the difference between the changed and the measured drive."""
    u, dt, terms = s["u"], s["dt"], {}
    for level in g["u"] * np.array([0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9]):
        terms["saturation", level] = np.clip(u, -level, level) - u
    for level in g["u rms"] * np.array([0.03, 0.06, 0.1, 0.15, 0.25, 0.4]):
        terms["drive-dead-zone", level] = -np.clip(u, -level, level)
        if case.family != "slide":
            terms["backlash", 2 * level] = play(u, level) - u
    for samples in (0.5, 1, 2, 3, 4, 6, 8, 12, 16, 24):
        terms["time-delay", samples * dt] = delayed(u, samples) - u
        terms["actuator-lag", samples * dt] = lagged(u, samples) - u
    if case.family == "slide":
        for half in g["reach"] * np.array([0.03, 0.06, 0.1, 0.2, 0.3, 0.5]):
            terms["backlash", 2 * half] = np.gradient(play(integral(u, dt), half), dt) - u
    return terms


def time_terms(s, g):
    """Terms of time: bias, drift, periodic disturbance."""
    t, terms = s["t"], {("constant-bias", 0): np.ones_like(s["t"]), ("drift", 0): s["t"]}
    if "peak" in g:
        terms["periodic-disturbance", g["peak"]] = np.sin(2 * np.pi * g["peak"] * t)
        terms["periodic-disturbance", -g["peak"]] = np.cos(2 * np.pi * g["peak"] * t)
    return terms


def friction_terms(case, s, g, sign, force):
    """Terms of velocity. `sign` is a smooth sign of the velocity, `force` that of the drive."""
    v, speed, dt, terms = s["v"], np.abs(s["v"]), s["dt"], {}
    falling = "Fs" in case.value
    if not falling:
        for slow in g["v"] * np.array([0.07, 0.14, 0.28, 0.56]):
            terms["stribeck-friction", slow] = -sign * np.exp(-speed / slow)
    if "Fc" not in case.value and not falling:
        terms["coulomb-friction", 0] = -sign
    if "f" not in case.value and "c" not in case.value:
        terms["viscous-friction", 0] = -s["straight v"]
    terms["asymmetric-viscous-friction", 0], terms["quadratic-drag", 0] = -speed, -v * speed
    terms["load-dependent-friction", 0] = -np.abs(force) * sign
    slow = case.value["VcL"] if falling else 0.3 * g["v"]
    level = np.clip(1 - speed / slow, 0, None) ** 2 if falling else np.exp(-speed / slow)
    for samples in (3, 8, 20, 50):
        terms["friction-memory", samples * dt] = -sign * (lagged(level, samples) - level * falling)
    for reach in g["v"] * 100 * dt * np.array([0.003, 0.01, 0.03, 0.1, 0.3]):
        terms["presliding-stiffness", reach] = -bristle(integral(v, dt), reach) + sign * ("Fc" in case.value)
    return terms


def position_terms(case, s, g):
    """Terms of position: cubic stiffness, stops."""
    if case.family == "slide":
        return {("cubic-stiffness", 0): -s["x_error"] ** 3}
    x, (low, high), terms = s["x"], g["x"], {}
    if case.family == "oscillator":
        terms["cubic-stiffness", 0] = -x**3
    for inside in (high - low) * np.array([0.03, 0.06, 0.1, 0.15, 0.2, 0.3]):
        terms["hard-stop", high - inside] = -np.maximum(x - high + inside, 0)
        terms["hard-stop", low + inside] = np.maximum(low + inside - x, 0)
    return terms


def mechanical(case, s, g):
    """M v' = force of the drive - friction. The drive of a slide gives a velocity, so the rates of drive terms are terms, too."""
    v, u, base = s["v"], s["u"], {}
    sign, slide = np.tanh(v / g["slow"]), case.family == "slide"
    if slide:
        e, damped = s["straight x_error"], C * (u - s["straight v"])
        force = case.value["K"] * s["x_error"] + C * (u - v)
        base = {"K": e, "1/M": damped} if "K" in case.fit else {"1/M": case.value["K"] * e + damped}
    else:
        force = u
        base = {"1/M": u} if "M" in case.fit else {}
    if "f" in case.value or "c" in case.value:
        base["f"] = -s["straight v"]
    if "k" in case.value:
        base["k"] = -s["straight x"]
    if "Fc" in case.value:
        base["Fc"] = -sign
    if "Fs" in case.value:
        for fold in (0.5, 1, 2):
            base[f"Fs {fold}"] = -sign * np.clip(1 - np.abs(v) / (fold * case.value["VcL"]), 0, None) ** 2
    terms = friction_terms(case, s, g, sign, force) | position_terms(case, s, g) | time_terms(s, g)
    known = 1 if "M" in case.fit else case.value["M"]
    known_term = 0 * u if "M" in case.fit else u
    if "M" not in case.fit:
        terms["mass-change", 0] = u
    elif "base" in g:
        for share in (0.15, 0.2, 0.25, 0.3, 0.35, 0.4):
            terms["mass-change", share * g["end"]] = (s["t"] > share * g["end"]) * sum(c * b for c, b in zip(g["base"], base.values()))
    drives = drive_terms(case, s, g)
    return [dict(state=known * s["raw v"], smooth=known * v, known_term=known_term, base=base, terms=terms | drives, rates=drives if slide else {})]


def vessel(case, s, g):
    """One tank, A h' = ku u, or a heated body, T' = (P - G T) / C."""
    name, heated = case.outputs[0], case.family == "heater"
    h, size, base = s["straight " + name], 1 if heated else A1, {"1/M" if heated else "ku": s["u"]}
    terms = time_terms(s, g) | drive_terms(case, s, g)
    if "G" in case.value:
        base["G"] = -h
    else:
        terms["leak", 0] = -h
        terms["leak", 1] = -np.sqrt(np.maximum(s[name], 0))
    return [dict(state=size * s["raw " + name], smooth=size * s[name], known_term=0 * h, base=base, terms=terms, rates={})]


def overflow_terms(h, top, inflow):
    """Overflow: the excess above a brim leaves, or the whole inflow while the level is above it."""
    levels = top * (1 - np.array([0.01, 0.03, 0.06, 0.1, 0.15, 0.2, 0.3, 0.4]))
    return {("overflow", x): -np.maximum(h - x, 0) for x in levels} | {("overflow", -x): -1.0 * (h > x) * inflow for x in levels}


def upper_terms(case, s, g, h):
    """Terms of the upper tank. Its inflow is that of the fitted base."""
    inflow, top = s["u"], h.max()
    if "base" in g:                                 # fitted to the training record, which is the first
        top = g.setdefault("h1", top)
        outlet = g["base"][1] if len(case.outputs) == 2 else 1 / case.value["R1"]
        inflow = np.maximum(g["base"][0] * s["u"] - outlet * h, 0)
    return {("leak", 0): -h, ("leak", 1): -np.sqrt(np.maximum(h, 0))} | overflow_terms(h, top, inflow) | drive_terms(case, s, g)


def two_tanks(case, s, g):
    """Both levels are measured: two balances that share a resistance."""
    h1, h2, none = s["h1"], s["h2"], 0 * s["u"]
    upper, time = upper_terms(case, s, g, h1), time_terms(s, g)
    spilt = {(name, (at, "below")): -term for (name, at), term in upper.items() if name == "overflow"}
    below = {(name, (at, "below")): term for (name, at), term in time.items()} | spilt
    first = upper | time | {key: none for key in below}
    second = {key: none for key in upper | time} | below
    base = [{"ku": s["u"], "R1": -s["straight h1"], "R2": none}, {"ku": none, "R1": s["straight h1"], "R2": -s["straight h2"]}]
    return [dict(state=A1 * s["raw h1"], smooth=A1 * h1, known_term=none, base=base[0], terms=first, rates={}),
            dict(state=A2 * s["raw h2"], smooth=A2 * h2, known_term=none, base=base[1], terms=second, rates={})]


def lower_tank(case, s, g):
    """Only the lower level is measured, and R1 is known: one equation of second order. The upper level is R1 times the flow."""
    whole, R1 = case.value["A1"] * case.value["A2"] * case.value["R1"], case.value["R1"]
    h, dh, raw = s["h2"], s["dh2"], s["raw h2"]
    h1 = R1 * (A2 * dh + h * g["base"][1]) if "base" in g else h
    base = {"ku": s["u"], "R2": -(A1 * R1 * s["straight dh2"] + s["straight h2"])}
    terms = upper_terms(case, s, g, h1) | time_terms(s, g)
    return [dict(state=whole * rate(raw, s["t"]) + A2 * raw, smooth=whole * dh + A2 * h, known_term=0 * h, base=base, terms=terms, rates={})]


def blocks(case, s, g):
    """The equations of the base with their terms: rate of `state` = base + terms + rates of `rates` + `known_term`."""
    if "v" in s:
        equations = mechanical(case, s, g)
    elif case.family != "tanks":
        equations = vessel(case, s, g)
    else:
        equations = two_tanks(case, s, g) if len(case.outputs) == 2 else lower_tank(case, s, g)
    for k in range(len(equations) * case.offset):         # an offset of a sensor adds a constant to each equation
        for block in equations:
            block["base"][f"offset {k}"] = np.ones_like(s["t"]) * (block is equations[k])
    return equations


def grids(case, s):
    """The scales of the numbers inside terms, from the training record."""
    g = {"u": np.max(np.abs(s["u"])), "u rms": np.sqrt(np.mean(s["u"] ** 2)), "end": s["end"]}
    if "v" in s:
        top = np.max(np.abs(s["v"]))
        g["v"], g["slow"] = np.sqrt(np.mean(s["v"] ** 2)), np.clip(2 * s["v sigma"], 0.003 * top, 0.1 * top)
    if "x" in s:
        g["x"] = s["x"].min(), s["x"].max()
    if "x_error" in s:
        g["reach"] = np.ptp(s["x_error"])
    return g
