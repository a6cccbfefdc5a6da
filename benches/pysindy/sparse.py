"""Sparse regression with pysindy: the equations of a case in weak form or with derivatives, and the models that an optimiser finds."""

import numpy as np
import pysindy as ps

from terms import blocks, grids, rate, savgol, states


class Weak:
    """The weak form: weighted means over test functions of pysindy instead of values and derivatives. `cache` keeps the weights."""

    cache = {}

    def __init__(self, n, dt, half):
        if (n, half) not in Weak.cache:
            np.random.seed(1)                       # the centres of the test functions are random
            library = ps.WeakPDELibrary(function_library=ps.IdentityLibrary(), spatiotemporal_grid=np.arange(n) * 1.0, K=3 * n // half,
                                        H_xt=half + 0.01, p=3)
            unit = np.eye(n)
            values = np.asarray(library.fit(unit).transform(ps.AxesArray(unit, {"ax_time": 0, "ax_coord": 1})))
            size = values.sum(axis=1)[:, None]
            Weak.cache[n, half] = values / size, library.convert_u_dot_integral(unit) / size
        self.values, rates = Weak.cache[n, half]
        self.rates = rates / dt

    def value(self, columns):
        return self.values @ columns

    def rate(self, column):
        return self.rates @ column

    def target(self, block):
        return self.rates @ block["state"]


class Plain:
    """Values and derivatives of smoothed signals. The derivative of the target is smoothed a second time over the same window."""

    def __init__(self, t, window):
        self.t, self.window = t, window

    def value(self, columns):
        return columns

    def rate(self, column):
        return rate(column, self.t)

    def target(self, block):
        return savgol(block["smooth"], self.t, self.window)[0]


def equation(s, g, block, form):
    """Target, base and terms of an equation. Samples at rest are omitted, because solid friction balances there without a formula."""
    base = list(block["base"].values())
    rest = (np.abs(s["v"]) < 1.5 * g["slow"]) * 1.0 if "v" in s else 0 * s["t"]
    values = form.value(np.column_stack(base + list(block["terms"].values()) + [block["known_term"], rest]))
    rates = [form.rate(column) for column in block["rates"].values()]
    is_moving = values[:, -1] < 0.25
    if is_moving.sum() < 30:
        is_moving[:] = True
    terms = np.column_stack([values[:, len(base):-2]] + rates)
    return (form.target(block) - values[:, -2])[is_moving], values[is_moving, :len(base)], terms[is_moving]


def rows(case, s, g, form):
    """The rows of all equations, each scaled by the residual of its base. The first call also sets up `g` from the training record."""
    equations = blocks(case, s, g)
    parts = [equation(s, g, block, form) for block in equations]
    y, base, terms = (np.concatenate([p[k] for p in parts]) for k in range(3))
    if "weights" not in g:
        g["base"] = fitted(base, y)
        g["weights"] = [1 / np.std(y - base @ g["base"]) for y, base, _ in parts]
        g["peak"] = peak(s, equations[0], case.half)
        return rows(case, s, g, form)
    weight = np.concatenate([np.full(len(p[0]), w) for p, w in zip(parts, g["weights"])])
    keys = list(equations[0]["terms"]) + [(name, (at, "rate")) for name, at in equations[0]["rates"]]
    return y * weight, base * weight[:, None], terms * weight[:, None], keys, list(equations[0]["base"])


def fitted(columns, y):
    """The coefficients of a least-squares fit, with columns scaled to norm 1."""
    size = np.linalg.norm(columns, axis=0)
    size[size == 0] = 1
    return np.linalg.lstsq(columns / size, y, rcond=None)[0] / size


def peak(s, block, half):
    """The frequency of the largest residual of the base, weighted by the spectrum of the test functions."""
    base, n, dt = np.column_stack(list(block["base"].values()) or [0 * s["t"]]), len(s["t"]), s["dt"]
    y = rate(block["smooth"], s["t"]) - block["known_term"]
    residual = y - base @ fitted(base, y)
    test = (1 - np.linspace(-1, 1, 2 * half + 1) ** 2) ** 3
    power = np.abs(np.fft.rfft((residual - residual.mean()) * np.hanning(n), 8 * n) * np.fft.rfft(test, 8 * n)) ** 2
    frequency = np.fft.rfftfreq(8 * n, dt)
    return frequency[12 + np.argmax(power[12:])]      # at least one and a half periods in the record


# ---- sparse regression

def optimisers(how):
    """The optimisers. Each gives sparse models for columns of norm 1, along its path or for one threshold."""
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
    """The sets of at most six terms that the optimisers find."""
    found, terms, y = [], terms / np.linalg.norm(terms, axis=0), (y / np.linalg.norm(y))[:, None]
    for optimiser in optimisers(how):
        if how == "SR3":
            optimiser.initial_guess = np.zeros((1, terms.shape[1]))
        np.random.seed(1)
        optimiser.fit(terms, y)
        models = optimiser.history_ if how in ("FROLS", "SSR") else [optimiser.coef_]
        if how == "ensemble":                       # terms in the order of the number of models that contain them
            often = np.mean(np.array(optimiser.coef_list)[:, 0] != 0, axis=0)
            models = [np.where(often >= np.sort(often)[-k], often, 0) for k in (1, 2, 3, 4)]
        for model in models:
            support = tuple(np.flatnonzero(np.abs(np.ravel(model)) > 1e-12))
            if 0 < len(support) <= 6 and support not in found:
                found.append(support)
    return found


def distinct(terms, left):
    """Indices of terms that the base does not explain and that are not collinear with an earlier term."""
    size, kept = np.linalg.norm(terms, axis=0), []
    rest = np.linalg.norm(left, axis=0)
    unit = left / np.where(rest > 0, rest, 1)
    for i in np.flatnonzero(rest > 1e-2 * size):
        if not any(abs(unit[:, i] @ unit[:, j]) > 0.99999 for j in kept):
            kept.append(i)
    return np.array(kept, int)


def models(case, how):
    """All sparse models with their gains on the training and the test record, and the residual of the base as a share of the target."""
    records, g = [], None
    for record in case.records:
        s = states(case, record, how["smooth"], how["form"] == "weak")
        form = Weak(len(s["t"]), s["dt"], case.half) if how["form"] == "weak" else Plain(s["t"], s["window"])
        g = g or grids(case, s)
        records.append(rows(case, s, g, form))
    (y, base, terms, keys, names), (y2, base2, terms2, _, _) = records
    q = np.linalg.qr(base)[0] if base.shape[1] else np.zeros((len(y), 1))
    # Projected out of target and terms, because every model contains the base without a penalty.
    residual, projected = y - q @ (q.T @ y), terms - q @ (q.T @ terms)
    usable = distinct(terms, projected)
    before, candidates = [residual @ residual, np.sum((y2 - base2 @ fitted(base, y)) ** 2)], []
    for support in supports(projected[:, usable], residual, how["optimiser"]):
        chosen = usable[list(support)]
        train, test = np.column_stack([base, terms[:, chosen]]), np.column_stack([base2, terms2[:, chosen]])
        c = fitted(train, y)
        after = [np.sum((y - train @ c) ** 2), np.sum((y2 - test @ c) ** 2)]
        gain = [len(record["t"]) / case.half * np.log(b / a) for record, b, a in zip(case.records, before, after)]
        share = np.abs(c[base.shape[1]:]) * np.linalg.norm(projected[:, chosen], axis=0)
        candidates.append(dict(terms=[keys[i] for i in chosen], c=c[base.shape[1]:], share=share, base=dict(zip(names, c)), gain=gain))
    return candidates, np.sqrt(before[0] / (y @ y))
