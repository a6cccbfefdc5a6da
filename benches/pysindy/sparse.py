"""Sparse regression by pysindy: the rows of a case, in the weak form or by derivatives, and the models that an optimiser finds."""

import numpy as np
import pysindy as ps

from terms import blocks, grids, rate, savgol, states


class Weak:
    """Means over pysindy's test functions in place of values, and of derivatives: its weights, worked out once for a length."""

    kept = {}

    def __init__(self, n, dt, half):
        if (n, half) not in Weak.kept:
            np.random.seed(1)                       # centres of the test functions are drawn
            library = ps.WeakPDELibrary(function_library=ps.IdentityLibrary(), spatiotemporal_grid=np.arange(n) * 1.0, K=3 * n // half,
                                        H_xt=half + 0.01, p=3)
            unit = np.eye(n)
            values = np.asarray(library.fit(unit).transform(ps.AxesArray(unit, {"ax_time": 0, "ax_coord": 1})))
            size = values.sum(axis=1)[:, None]
            Weak.kept[n, half] = values / size, library.convert_u_dot_integral(unit) / size
        self.values, rates = Weak.kept[n, half]
        self.rates = rates / dt

    def value(self, columns):
        return self.values @ columns

    def rate(self, column):
        return self.rates @ column

    def target(self, block):
        return self.rates @ block["state"]


class Plain:
    """Values and derivatives of smoothed signals; the target's is smoothed over the same window once more."""

    def __init__(self, t, window):
        self.t, self.window = t, window

    def value(self, columns):
        return columns

    def rate(self, column):
        return rate(column, self.t)

    def target(self, block):
        return savgol(block["smooth"], self.t, self.window)[0]


def part(s, g, block, form):
    """Target, base and terms of an equation, without what is at rest: there solid friction balances and obeys no formula."""
    base = list(block["base"].values())
    rest = (np.abs(s["v"]) < 1.5 * g["slow"]) * 1.0 if "v" in s else 0 * s["t"]
    every = form.value(np.column_stack(base + list(block["terms"].values()) + [block["beside"], rest]))
    rates = [form.rate(column) for column in block["rates"].values()]
    moves = every[:, -1] < 0.25
    if moves.sum() < 30:
        moves[:] = True
    terms = np.column_stack([every[:, len(base):-2]] + rates)
    return (form.target(block) - every[:, -2])[moves], every[moves, :len(base)], terms[moves]


def rows(case, s, g, form):
    """Those of all equations, each in units of what its base leaves."""
    own = blocks(case, s, g)
    parts = [part(s, g, block, form) for block in own]
    y, base, terms = (np.concatenate([p[k] for p in parts]) for k in range(3))
    if "weights" not in g:
        g["base"] = fitted(base, y)
        g["weights"] = [1 / np.std(y - base @ g["base"]) for y, base, _ in parts]
        g["peak"] = peak(s, own[0], case.half)
        return rows(case, s, g, form)
    weight = np.concatenate([np.full(len(p[0]), w) for p, w in zip(parts, g["weights"])])
    keys = list(own[0]["terms"]) + [(name, (at, "rate")) for name, at in own[0]["rates"]]
    return y * weight, base * weight[:, None], terms * weight[:, None], keys, list(own[0]["base"])


def fitted(columns, y):
    size = np.linalg.norm(columns, axis=0)
    size[size == 0] = 1
    return np.linalg.lstsq(columns / size, y, rcond=None)[0] / size


def peak(s, block, half):
    """The frequency at which the base leaves most of what test functions let through."""
    base, n, dt = np.column_stack(list(block["base"].values()) or [0 * s["t"]]), len(s["t"]), s["dt"]
    y = rate(block["smooth"], s["t"]) - block["beside"]
    left = y - base @ fitted(base, y)
    test = (1 - np.linspace(-1, 1, 2 * half + 1) ** 2) ** 3
    power = np.abs(np.fft.rfft((left - left.mean()) * np.hanning(n), 8 * n) * np.fft.rfft(test, 8 * n)) ** 2
    frequency = np.fft.rfftfreq(8 * n, dt)
    return frequency[12 + np.argmax(power[12:])]      # no slower than one and a half waves in the record


# ---- sparse regression

def optimisers(how):
    """Each gives sparse models of columns of norm 1: along its own path, or for thresholds one after the other."""
    greedy = dict(max_iter=4, alpha=1e-9, unbias=False)
    if how == "FROLS":
        return [ps.FROLS(**greedy)]
    if how == "SSR":
        return [ps.SSR(max_iter=10**6, alpha=1e-4)]
    if how == "ensemble":
        return [ps.EnsembleOptimizer(ps.FROLS(**greedy), bagging=True, n_models=20)]
    if how == "STLSQ":
        return [ps.STLSQ(threshold=at, alpha=1e-3, unbias=False) for at in np.geomspace(0.01, 1, 25)]
    return [ps.SR3(reg_weight_lam=at**2 / 20, relax_coeff_nu=10, max_iter=100) for at in np.geomspace(0.03, 1, 16)]


def supports(terms, y, how):
    """The sets of terms that the optimiser goes through, of at most six."""
    found, terms, y = [], terms / np.linalg.norm(terms, axis=0), (y / np.linalg.norm(y))[:, None]
    for optimiser in optimisers(how):
        if how == "SR3":
            optimiser.initial_guess = np.zeros((1, terms.shape[1]))
        np.random.seed(1)
        optimiser.fit(terms, y)
        models = optimiser.history_ if how in ("FROLS", "SSR") else [optimiser.coef_]
        if how == "ensemble":                       # terms in the order of how many models have them
            often = np.mean(np.array(optimiser.coef_list)[:, 0] != 0, axis=0)
            models = [np.where(often >= np.sort(often)[-k], often, 0) for k in (1, 2, 3, 4)]
        for model in models:
            support = tuple(np.flatnonzero(np.abs(np.ravel(model)) > 1e-12))
            if 0 < len(support) <= 6 and support not in found:
                found.append(support)
    return found


def distinct(terms, left):
    """Terms of which the base leaves something, and which are not the same as another."""
    size, kept = np.linalg.norm(terms, axis=0), []
    rest = np.linalg.norm(left, axis=0)
    unit = left / np.where(rest > 0, rest, 1)
    for i in np.flatnonzero(rest > 1e-2 * size):
        if not any(abs(unit[:, i] @ unit[:, j]) > 0.99999 for j in kept):
            kept.append(i)
    return np.array(kept, int)


def models(case, how):
    """Every sparse model with its gain on the training record and on the other, and the share that the base leaves."""
    sides, g = [], None
    for record in case.records:
        s = states(case, record, how["smooth"], how["form"] == "weak")
        form = Weak(len(s["t"]), s["dt"], case.half) if how["form"] == "weak" else Plain(s["t"], s["window"])
        g = g or grids(case, s)
        sides.append(rows(case, s, g, form))
    (y, base, terms, keys, names), (y2, base2, terms2, _, _) = sides
    q = np.linalg.qr(base)[0] if base.shape[1] else np.zeros((len(y), 1))
    rest, left = y - q @ (q.T @ y), terms - q @ (q.T @ terms)   # the base's own terms are in every model, without a penalty
    own = distinct(terms, left)
    before, found = [rest @ rest, np.sum((y2 - base2 @ fitted(base, y)) ** 2)], []
    for support in supports(left[:, own], rest, how["optimiser"]):
        chosen = own[list(support)]
        here, there = np.column_stack([base, terms[:, chosen]]), np.column_stack([base2, terms2[:, chosen]])
        c = fitted(here, y)
        after = [np.sum((y - here @ c) ** 2), np.sum((y2 - there @ c) ** 2)]
        gain = [len(record["t"]) / case.half * np.log(b / a) for record, b, a in zip(case.records, before, after)]
        share = np.abs(c[base.shape[1]:]) * np.linalg.norm(left[:, chosen], axis=0)
        found.append(dict(terms=[keys[i] for i in chosen], c=c[base.shape[1]:], share=share, base=dict(zip(names, c)), gain=gain))
    return found, np.sqrt(before[0] / (y @ y))
