#!/usr/bin/env python3
"""Writes THIRD-PARTY-LICENSES: the packages in a release binary of patchcord, with their licences.

Run it in the repository after a change of Cargo.lock, when the sources of all packages are downloaded:

    .ci/third-party-licenses.py

A package counts as part of the binary if normal dependencies lead to it, on any platform and with the features of the
tests. So the list may have a few packages more than one binary. Procedural macros and build scripts are not in it.
With an argument, the output of `cargo metadata` is read from that file.
"""

import json
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TARGET = ROOT / "THIRD-PARTY-LICENSES"
FONT = ROOT / "crates/draw/src/plot/font/LICENSE.txt"
METADATA = ["cargo", "metadata", "--offline", "--locked", "--format-version", "1"]
# The repositories of packages that do not name theirs.
REPOSITORIES = dict.fromkeys(
    ["cranelift-assembler-x64", "wasmtime-internal-core"], "https://github.com/bytecodealliance/wasmtime"
)
# Beginnings of the names of files with licence texts, in lower case.
TEXT_FILES = ("licen", "copying", "unlicense", "notice")
RULE = "=" * 100
INTRODUCTION = """Licences of the third-party software in patchcord binaries

patchcord itself is licensed under MIT OR Apache-2.0: see LICENSE-MIT and LICENSE-APACHE.

This file is written by .ci/third-party-licenses.py from Cargo.lock, and a test compares it with Cargo.lock. It lists the
Rust packages that a binary contains on some platform. If a package offers MIT as one of several licences, it is used
under MIT, and only that text is reprinted. The last column has the numbers of the texts below.

A binary also contains the Rust standard library (MIT OR Apache-2.0, The Rust Project Developers). The licences of its
parts are in COPYRIGHT-library.html of each Rust toolchain. The font in pictures is a subset of DejaVu Sans: text 1.
"""


def metadata():
    if len(sys.argv) > 1:
        return json.loads(Path(sys.argv[1]).read_text())
    return json.loads(subprocess.run(METADATA, cwd=ROOT, check=True, capture_output=True).stdout)


def is_enabled(dependency, package, features):
    """Whether the enabled features of a package activate this entry of its dependencies."""
    if not dependency["optional"]:
        return True
    name = dependency["rename"] or dependency["name"]
    activated = [entry for feature in features for entry in package["features"].get(feature, [])]
    return name in features or any(entry == f"dep:{name}" or entry.startswith(f"{name}/") for entry in activated)


def in_binary(data):
    """The packages that normal dependencies of the root package lead to."""
    packages = {package["id"]: package for package in data["packages"]}
    nodes = {node["id"]: node for node in data["resolve"]["nodes"]}
    found, todo = {}, [data["resolve"]["root"]]
    while todo:
        identifier = todo.pop()
        if identifier in found:
            continue
        package, node = packages[identifier], nodes[identifier]
        found[identifier] = package
        normal = [entry for entry in package["dependencies"] if entry["kind"] is None]
        enabled = {entry["name"] for entry in normal if is_enabled(entry, package, node["features"])}
        for dependency in node["deps"]:
            target = packages[dependency["pkg"]]
            is_macro = any("proc-macro" in part["kind"] for part in target["targets"])
            if target["name"] in enabled and not is_macro:
                todo.append(target["id"])
    return [package for package in found.values() if package["source"]]


def repository(package):
    """The address of the repository of a package."""
    return package["repository"] or REPOSITORIES.get(package["name"], package["id"])


def text_files(package):
    """The files with the licence texts that apply: that of MIT alone if there is a choice."""
    folder = Path(package["manifest_path"]).parent
    files = sorted(file for file in folder.iterdir() if file.name.lower().startswith(TEXT_FILES))
    licence = (package["license"] or "").replace("/", " OR ")
    mit = [file for file in files if "mit" in file.name.lower() and "mit0" not in file.name.lower()]
    has_choice = "MIT" in licence.replace("(", " ").replace(")", " ").split() and " AND " not in licence
    notices = [file for file in files if file.name.lower().startswith("notice")]
    return mit + notices if has_choice and mit else files


def without_indentation(text):
    """The text in a form in which equal licences compare as equal."""
    return " ".join(text.split())


def listed(packages):
    """The rows of the table, and the texts with the packages that each applies to."""
    files = {package["id"]: text_files(package) for package in packages}
    by_repository = {}
    for package in packages:
        by_repository.setdefault(repository(package), []).extend(files[package["id"]])
    font = FONT.read_text()
    texts, rows = {without_indentation(font): (1, font, ["DejaVu Sans"])}, []
    for package in packages:
        # A package without a text has that of another package of its repository.
        own = files[package["id"]] or by_repository[repository(package)][:1]
        numbers = []
        for file in own:
            text = file.read_text(errors="replace")
            entry = texts.setdefault(without_indentation(text), (len(texts) + 1, text, []))
            entry[2].append(package["name"])
            numbers.append(entry[0])
        authors = "; ".join(package["authors"]) or "its authors"
        where = ", ".join(str(number) for number in sorted(set(numbers)))
        where = where or f"none in the package: {authors}, {repository(package)}"
        rows.append(f"{package['name']} {package['version']} | {package['license']} | {where}")
    return rows, sorted(texts.values())


def names(packages):
    """The name and the version of each package, one on a line."""
    return "\n".join(f"{package['name']} {package['version']}" for package in packages)


def main():
    data = metadata()
    everything = sorted(
        (package for package in data["packages"] if package["source"]),
        key=lambda package: (package["name"], package["version"]),
    )
    inside = {package["id"] for package in in_binary(data)}
    others = [package for package in everything if package["id"] not in inside]
    rows, texts = listed([package for package in everything if package["id"] in inside])
    table = "\n".join(rows)
    parts = [
        INTRODUCTION,
        f"{RULE}\nPackages in binaries: name version | licence | texts\n\n{table}\n",
        f"{RULE}\nPackages of Cargo.lock in no binary: for builds, tests and macros\n\n{names(others)}\n",
    ]
    for number, text, users in texts:
        body = "\n".join(line.rstrip() for line in text.strip().splitlines())
        parts.append(f"{RULE}\nText {number}: {', '.join(sorted(set(users)))}\n\n{body}\n")
    TARGET.write_text("\n".join(parts))


if __name__ == "__main__":
    main()
