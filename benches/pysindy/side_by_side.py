"""The hidden cases with pysindy: the effects that sparse regression names, judged as benches/gap judges `patchcord gap`.

    pip install pysindy==2.1.0
    cd benches/hidden && cc -O2 *.c -o hidden -lm && ./hidden --seed 7 --out DIR --patches ../../crates/ident/tests/systems
    python benches/pysindy/side_by_side.py DIR            prints the tables of docs/side-by-side.md
    python benches/pysindy/side_by_side.py DIR 41-50      some cases
    python benches/pysindy/side_by_side.py DIR --choose   selects the best penalty for these cases and prints the tables with it

Further words replace settings of CHOSEN: form=plain uses derivatives instead of integrals; smooth=spline; optimiser=STLSQ, SR3, SSR or
ensemble; penalty=10. With clean=DIR, a folder made by `hidden --clean`, noise=0.1 reduces the noise to a tenth. CHOSEN was selected on
200 cases of seed 8.

The versions were Python 3.11, pysindy 2.1.0 (MIT), derivative 0.6.3, scikit-learn 1.9.1, numpy 2.4.6 and scipy 1.17.1. patchcord does
not need them.
"""

import json
import sys
import time
import warnings
from collections import Counter
from itertools import product
from pathlib import Path

import numpy as np

from sparse import models
from terms import C, Case, columns

warnings.filterwarnings("ignore")

CHOSEN = {
    "form": "weak", "smooth": "savgol", "optimiser": "FROLS", "width": 1.0,
    "penalty": 16.0,     # required gain of a term, in logarithms of the number of independent rows
    "confirmed": 0.0,    # required gain on the test record
    "least": 0.15,       # an effect is named if its contribution is at least this share of the largest
    "floor": 0.0,        # smallest residual of the base, as a share of the target, at which an effect is named; for records without noise
    "noise": 1.0, "clean": "",
}
LIBRARY = Path(__file__).parents[2] / "patches/effects"
PATCHCORD_PAGE = Path(__file__).parents[2] / "docs/hidden-effects.md"
BANDS = {"0.3 ... 1": (0, 1), "1 ... 3": (1, 3), "above 3": (3, np.inf)}


# ---- names

PARTS_OF = {("coulomb-friction", "stribeck-friction"), ("coulomb-friction", "friction-memory"), ("stribeck-friction", "friction-memory"),
            ("coulomb-friction", "presliding-stiffness")}


def select_model(candidates, records, how):
    """The model with the largest penalised gain on the training record among those that the test record confirms. May be None."""
    selected, best_score, confirmed = None, 0.0, how["confirmed"]
    for model in candidates:
        score = model["gain"][0] - how["penalty"] * len(model["terms"]) * np.log(records)
        if score > best_score and model["gain"][1] > confirmed:
            selected, best_score, confirmed = model, score, model["gain"][1] + how["confirmed"]
    return selected


def named_effects(model, how):
    """The effects with sufficient contributions. A part of another named effect is omitted, and so is the smaller of lag and delay."""
    if model is None:
        return []
    share = Counter()
    for (name, _), contribution in zip(model["terms"], model["share"]):
        share[name] = max(share[name], contribution)
    names = [name for name, contribution in share.most_common() if contribution >= how["least"] * max(share.values())]
    names = [name for name in names if not any((name, other) in PARTS_OF for other in names)]
    if {"time-delay", "actuator-lag"} <= set(names):
        names.remove(min("time-delay", "actuator-lag", key=lambda name: share[name]))
    return names


def judgement(truth, names):
    """The judgement of the named effects, as in benches/gap/case_result.rs."""
    hidden = [] if truth == "none" else truth.split("+")
    if not names:
        return "refused" if hidden else "right"
    if not hidden:
        return "false alarm"
    if all(name in hidden for name in names):
        return "right" if len(names) == len(hidden) else "half"
    return "wrong"


def aliases():
    """Pairs of effects that some data cannot distinguish, according to patches/effects."""
    listed = {path.stem: json.loads(path.read_text()).get("aliases", {}) for path in LIBRARY.glob("*.json")}
    return {(a, b) for a in listed for b in listed[a]} | {(b, a) for a in listed for b in listed[a]}


# ---- the parameter of the named effect

# Effects whose parameter is a coefficient over that of the inertia.
FORCES = {"coulomb-friction": "Fc", "viscous-friction": "c", "asymmetric-viscous-friction": "d", "quadratic-drag": "c", "cubic-stiffness": "k3",
          "load-dependent-friction": "mu", "constant-bias": "b", "drift": "r", "leak": "g", "stribeck-friction": "dF"}
# Effects whose parameter is the number inside the strongest term.
INSIDE = {"saturation": "L", "overflow": "L", "hard-stop": "xs", "friction-memory": "Tc", "presliding-stiffness": "D"}
# Effects whose parameter is the number inside the strongest term times the relative size of the term.
BY_SIZE = {"drive-dead-zone": "b", "time-delay": "T", "actuator-lag": "T", "backlash": "w"}


def number(at):
    """The number inside a term, from its key."""
    while isinstance(at, tuple):
        at = at[0]
    return float(at)


def estimate(name, model, case):
    """Name and estimate of the first parameter of an effect (see FORCES, INSIDE and BY_SIZE)."""
    terms = [(at, c, share) for (other, at), c, share in zip(model["terms"], model["c"], model["share"]) if other == name]
    per, (at, c, _) = model["base"].get("1/M", 1.0), max(terms, key=lambda term: term[2])
    if name in FORCES:
        return FORCES[name], sum(c for _, c, _ in terms) / per
    if name in INSIDE:
        return INSIDE[name], abs(number(at)) if name != "hard-stop" else number(at)
    if name == "periodic-disturbance":
        return "f", abs(number(at))
    if name == "mass-change":
        return "r", 1 / (1 + c) - 1
    drive = C * per if case.family == "slide" else model["base"].get("ku", per)
    size = c / drive if not isinstance(at, tuple) else -c if at[1] == "rate" else c
    return "b" if name == "backlash" and case.family != "slide" else BY_SIZE[name], number(at) * size


def parameter_error(truth, model, case):
    """The relative error of the estimated parameter. None if its true value is unknown or 0."""
    true_values, (name, value) = truth["effects"][0]["parameters"], estimate(truth["truth"], model, case)
    return abs(value / true_values[name]["value"] - 1) if name in true_values and true_values[name]["value"] else None


# ---- cases and tables

KINDS = NOTHING, ONE, TWO, UNKNOWN = "nothing", "an effect", "two effects", "an effect that the library does not have"


def kind(truth):
    """The kind of a case, as on docs/hidden-effects.md."""
    if truth == "none":
        return NOTHING
    return UNKNOWN if truth.startswith("unknown") else TWO if "+" in truth else ONE


def reduce_noise(case, folder, share):
    """Reduces the noise of the records to a share. Without noise, sigma is unknown (0 or None)."""
    for record, name in zip(case.records, ("train.csv", "test.csv")):
        clean = columns(folder / name)
        record.update({output: clean[output] + share * (record[output] - clean[output]) for output in case.outputs})
    case.sigma = {output: sigma and share and sigma * share for output, sigma in case.sigma.items()}


class CaseResult:
    """A case with all its models. The named effects depend on the penalty."""

    def __init__(self, folder, number, how):
        began = time.time()
        self.number, self.case = number, Case(folder / f"{number:04d}")
        self.case.half = round(self.case.half * how["width"])
        if how["clean"]:
            reduce_noise(self.case, Path(how["clean"]) / f"{number:04d}", how["noise"])
        self.candidates, self.base_residual = models(self.case, how)
        self.truth = json.loads((folder / f"truth/{number:04d}.json").read_text())
        self.seconds, self.what, self.egnr = time.time() - began, self.truth["truth"], self.truth["egnr"]
        self.kind, self.records = kind(self.what), len(self.case.records[0]["t"]) / self.case.half
        del self.case.records
        self.judge(how)

    def judge(self, how):
        """Selects a model and names its effects. Returns the judgement."""
        self.model = select_model(self.candidates, self.records, how) if self.base_residual >= how["floor"] else None
        self.names = named_effects(self.model, how)
        self.judgement = judgement(self.what, self.names)
        return self.judgement

    def line(self):
        names = "+".join(self.names)
        return f"{self.number:04d} {self.case.system:<20} {self.what:<44} {self.egnr:7.2f}  {names:<44} {self.judgement} {self.seconds:.1f} s"


def score(cases, how):
    """The criterion of --choose: right names minus wrong names. A false alarm counts three."""
    count = Counter((case.kind, case.judge(how)) for case in cases)
    right = count[ONE, "right"] + count[TWO, "right"] + count[TWO, "half"] / 2
    wrong = count[ONE, "wrong"] + count[TWO, "wrong"] + count[UNKNOWN, "wrong"] / 2
    return right - wrong - 3 * count[NOTHING, "false alarm"]


def choose(cases, how):
    """The settings with the largest score on a grid."""
    grid = product((2, 4, 6, 8, 10, 12, 14, 16, 20, 24), (0, 4, 8, 12, 20, 30), (0.15, 0.3, 0.5, 0.8))
    floors = (0.0, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2) if how["noise"] == 0 else (0.0,)
    tried = [how | dict(zip(("penalty", "confirmed", "least"), map(float, point)), floor=floor) for point in grid for floor in floors]
    return max(tried, key=lambda settings: score(cases, settings))


JUDGEMENTS = ("right", "half", "refused", "wrong", "false alarm")


def judgement_table(cases):
    """The table of judgements, as on docs/hidden-effects.md. pysindy gives no ambiguous verdicts."""
    text = "| hidden | gap over noise | cases | right | one of two | refused | wrong name | false alarm |\n|---|---|---|---|---|---|---|---|\n"
    for wanted, (band, (low, high)) in product(KINDS, BANDS.items()):
        if wanted == NOTHING:
            if low > 0:
                continue
            band, high = "", np.inf
        selected = [case for case in cases if case.kind == wanted and low <= case.egnr < high]
        cells = [str(sum(case.judgement == wanted_judgement for case in selected)) for wanted_judgement in JUDGEMENTS]
        text += f"| {wanted} | {band} | {len(selected)} | {' | '.join(cells)} |\n"
    return text


def percent(cases, holds):
    """The share of cases for which a condition holds."""
    cases = list(cases)
    return f"{100 * sum(map(holds, cases)) / max(len(cases), 1):.1f} %"


def figures(cases):
    """The rates of docs/hidden-effects.md for pysindy, by label."""
    none, single, pairs, unknown = [[case for case in cases if case.kind == wanted] for wanted in KINDS]
    alias_pairs, rates = aliases(), {}

    def right(case):
        return case.judgement == "right"

    def wrong(case):
        return case.judgement == "wrong"

    def wrong_without_aliases(case):
        return wrong(case) and not all(any(a == b or (a, b) in alias_pairs for b in case.what.split("+")) for a in case.names)

    for band, (low, high) in reversed(BANDS.items()):
        rates[f"right name, gap over noise {band}"] = percent((case for case in single if low <= case.egnr < high), right)
    rates["wrong name, aliases merged"] = percent(single + pairs, wrong_without_aliases)
    rates["wrong name, aliases not merged"] = percent(single + pairs, wrong)
    rates["false alarm when nothing is missing"] = percent(none, lambda case: not right(case))
    rates["unknown effect called by a library name"] = percent(unknown, wrong)
    rates["both of a pair named, gap over noise above 3"] = percent((case for case in pairs if case.egnr >= 3), right)
    return rates


def patchcord_figures():
    """The rates of patchcord on docs/hidden-effects.md, by label."""
    rows = (line.strip("| \n").split(" | ") for line in PATCHCORD_PAGE.read_text().splitlines() if line.startswith("| "))
    return {row[0]: row[1] for row in rows if len(row) == 2}


def measures(cases):
    """The table of rates of pysindy and of patchcord."""
    rates, times, patchcord = figures(cases), [case.seconds for case in cases], patchcord_figures()
    clear = [case for case in cases if case.kind == ONE and case.egnr >= 3 and case.judgement == "right"]
    errors = [parameter_error(case.truth, case.model, case.case) for case in clear]
    errors = np.array([error for error in errors if error is not None])
    if len(errors):
        off, near = 100 * np.median(errors), 100 * np.mean(errors <= 0.1)
        rates["parameter of the named effect, gap over noise above 3"] = f"{off:.0f} % off (median of {len(errors)}), within 10 % in {near:.0f} %"
    rates["time for a case, on one core"] = f"{np.median(times):.1f} s (median), {max(times):.0f} s at most"
    rows = "".join(f"| {label} | {figure} | {patchcord[label]} |\n" for label, figure in rates.items())
    return "| measure | pysindy | patchcord |\n|---|---|---|\n" + rows


def penalty_table(cases, how):
    """The rates of pysindy with several penalties."""
    table = {}
    for penalty in (4.0, 8.0, 16.0, 32.0):
        for case in cases:
            case.judge(how | {"penalty": penalty})
        table[penalty] = figures(cases)
    for case in cases:
        case.judge(how)
    rows = "".join(f"| {label} | {' | '.join(rates[label] for rates in table.values())} |\n" for label in table[4.0])
    return f"| penalty | {' | '.join(f'{penalty:.0f}' for penalty in table)} |\n|---|---|---|---|---|\n" + rows


def verdict_table(cases):
    """The named effects for every hidden effect or pair, with their counts."""
    answers = {}
    for case in cases:
        answers.setdefault(case.what, Counter())[" + ".join(sorted(case.names)) or "nothing"] += 1
    text = "| hidden | cases | named |\n|---|---|---|\n"
    for what, counts in sorted(answers.items()):
        named = ", ".join(f"{name} {count}" for name, count in counts.most_common())
        text += f"| {what} | {sum(counts.values())} | {named} |\n"
    return text


def main(folder, *words):
    how, numbers = dict(CHOSEN), range(1, sum(path.name.isdigit() for path in Path(folder).iterdir()) + 1)
    for word in words:
        if "=" in word:
            key, value = word.split("=")
            how[key] = type(how[key])(value)
        elif word[0].isdigit():
            first, last = word.split("-")
            numbers = range(int(first), int(last) + 1)
    cases = []
    for number in numbers:
        cases.append(CaseResult(Path(folder), number, how))
        print(cases[-1].line(), flush=True)
    if "--choose" in words:
        how = choose(cases, how)
        print("chosen:", how, "score", score(cases, how))
    print("", measures(cases), penalty_table(cases, how), judgement_table(cases), verdict_table(cases), sep="\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
