"""Writes NAME.reference.json for each problem NAME.json: its solution by SciPy, for the tests of the scaling.

The problems are those of this folder and of the folder problems of the repository. All references are in this folder.

Run it in an environment with numpy and scipy:

    python3 references.py             all problems
    python3 references.py lorenz ...  some problems

A reference has 11 equally spaced times from 0 to the end of the run. It has the values of every quantity at these times
and its largest magnitude in the run, all in the units of the problem. The script reads the equations of a problem
itself and shares no code with patchcord.

The method is DOP853 (order 8) with a relative tolerance of 1e-13 and an absolute tolerance of 1e-13 times the peak of
each state. The run is integrated piece by piece: from corner to corner of the drives, of functions such as abs, max,
limit and sign, and of tables. Delays use the method of steps. The delayed value of a quantity before the run is its
initial value.

Each solution is compared with a second one by RK45 (order 5) with the same tolerances. The script prints the largest
difference of any value and of any peak, as a share of the peak. If it exceeds 1e-8, the script fails and does not write
the reference.
"""

import json
import sys
import time
from pathlib import Path

import numpy as np

from reference_solver.integration import solve
from reference_solver.problem import Problem

FOLDER = Path(__file__).resolve().parent
# The folders of the problems.
FOLDERS = [FOLDER, FOLDER.parents[3] / "problems"]
ENDING = ".reference.json"
# The largest difference between the two solutions, as a share of the peak.
TOLERANCE = 1e-8


def main(selected):
    """Writes and verifies the references of the selected problems, or of all."""
    files = [path for folder in FOLDERS for path in folder.glob("*.json")]
    paths = sorted((path for path in files if not path.name.endswith(ENDING)), key=lambda path: path.stem)
    unknown = set(selected) - {path.stem for path in paths}
    if unknown:
        sys.exit(f"no problem of this name: {', '.join(sorted(unknown))}")
    differences = {path.stem: write_reference(path) for path in paths if not selected or path.stem in selected}
    worst = max(differences, key=differences.get)
    print(f"largest difference: {differences[worst]:.1e} of the peak in {worst}")
    failed = [name for name, difference in differences.items() if not difference <= TOLERANCE]
    if failed:
        sys.exit(f"above {TOLERANCE}: {', '.join(failed)}")


def write_reference(path):
    """Writes the reference of a problem. Returns its largest difference from the second solution."""
    begin = time.perf_counter()
    problem = Problem(path)
    solution = solve(problem, "DOP853", 1e-13, tests=12)
    second = solve(problem, "RK45", 1e-13, tests=4)
    values, peaks = np.abs(solution.values - second.values), np.abs(solution.peaks - second.peaks)
    difference = float(max(np.max(values / solution.peaks), np.max(peaks / solution.peaks)))
    if difference <= TOLERANCE:
        (FOLDER / (path.stem + ENDING)).write_text(text_of(problem, solution))
    print(f"{path.stem:28} {difference:8.1e}  {time.perf_counter() - begin:6.1f} s", flush=True)
    return difference


def text_of(problem, solution):
    """The JSON text of a reference, with one quantity a line."""
    rows = []
    for index, (quantity, unit) in enumerate(problem.units.items()):
        values = (solution.values[:, index] / unit.factor).tolist()
        row = {"unit": problem.unit_texts[quantity], "values": values, "peak": solution.peaks[index] / unit.factor}
        rows.append(f"    {json.dumps(str(quantity))}: {json.dumps(row, ensure_ascii=False)}")
    times = json.dumps(solution.times)
    return f'{{\n  "times": {times},\n  "quantities": {{\n' + ",\n".join(rows) + "\n  }\n}\n"


if __name__ == "__main__":
    main(sys.argv[1:])
