#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
"""Prints the paper's tables with our figures beside the published ones, and draws its figures.

Usage: paper_tables.py FOLDER
Reads  FOLDER/SET/*/report.json, each the report of some methods on the data set SET (`curvereg evaluate`)
Writes FOLDER/tables.txt (what it prints), FOLDER/figure_SET.png (where matplotlib is there)
"""
import json
import pathlib
import sys

SETS = [("mars-dome", "Table 1: Mars dome, every fifth scan"),
        ("mars-yard-sim", "Table 2: simulated Mars yard"),
        ("mars-yard-real", "Table 3: Mars yard as the real scanner sees it")]
METHODS = ["paper", "curvelet", "fpfh-sac-ia", "harris3d-fpfh"]
# Published RMSE [m], [rad] of the paper's own method on its own scans of that place. Those that are not here were not at
# hand when this was written; a dash is not a zero.
PUBLISHED = {("mars-dome", "paper"): (0.3211, 0.0877), ("mars-yard-sim", "paper"): (0.0147, 0.0090)}


def number(value, digits=4):
    return "-" if value is None else f"{value:.{digits}f}"


def read_methods(folder, name):
    """{method: its part of report.json}"""
    found = {}
    for path in sorted((folder / name).glob("*/report.json")):
        for method in json.loads(path.read_text())["methods"]:
            found[method["method"]] = method
    return found


def accuracy_table(title, name, methods):
    lines = [title, f"  {'method':<14} {'published':>17} {'pairs':>6} {'ok':>5} {'ours, all pairs':>19} "
             f"{'ours, ok pairs':>19} {'accepted':>9} {'wrong':>6}",
             f"  {'':<14} {'m':>8} {'rad':>8} {'':>6} {'':>5} {'m':>10} {'rad':>8} {'m':>10} {'rad':>8}"]
    for method in METHODS:
        if method not in methods:
            continue
        m = methods[method]
        published = PUBLISHED.get((name, method), (None, None))
        lines.append(f"  {method:<14} {number(published[0]):>8} {number(published[1]):>8} {m['pairs']:>6} {m['ok']:>5} "
                     f"{number(m['rmse_translation_m']):>10} {number(m['rmse_rotation_rad'], 5):>8} "
                     f"{number(m['rmse_ok_translation_m']):>10} {number(m['rmse_ok_rotation_rad'], 5):>8} "
                     f"{m['accepted']:>9} {m['accepted_wrong']:>6}")
    return lines


def time_table(results):
    lines = ["Table 4: seconds per pair, median (two scans in memory to answer, on this machine)",
             f"  {'method':<14} " + " ".join(f"{name:>15}" for name, _ in SETS)]
    for method in METHODS:
        cells = [number(results[name].get(method, {}).get("median_s"), 3) for name, _ in SETS]
        lines.append(f"  {method:<14} " + " ".join(f"{cell:>15}" for cell in cells))
    return lines


def notes(results):
    lines = ["RMSE over all pairs leaves out pairs without a pose; ok: error below 0.5 m and 0.1 rad.",
             "published: on the authors' scans, which are not ours: these are simulated with the paper's figures."]
    for name, _ in SETS:
        most = max((m["pairs"] for m in results[name].values()), default=0)
        for method in METHODS:
            pairs = results[name].get(method, {}).get("pairs", most)
            if pairs < most:
                lines.append(f"{name}, {method}: on {pairs} of {most} pairs only, since it takes long.")
    return lines


def draw(folder, name, methods):
    try:
        import matplotlib

        matplotlib.use("Agg")
        import matplotlib.pyplot as plt
    except ImportError:
        return
    figure, axes = plt.subplots(1, 2, figsize=(11, 4.2), sharey=True)
    for axis, key, label in [(axes[0], "translation_error_m", "translation error [m]"),
                             (axes[1], "rotation_error_rad", "rotation error [rad]")]:
        for method in METHODS:
            if method not in methods:
                continue
            details = methods[method]["details"]
            errors = sorted(max(d[key], 1e-7) for d in details if d[key] is not None)
            if not errors:
                continue
            shares = [(i + 1) / len(details) for i in range(len(errors))]
            axis.step([errors[0]] + errors + [1e3], [0] + shares + [shares[-1]], where="post",
                      label=f"{method} ({len(details)} pairs)")
        axis.set_xscale("log")
        axis.set_xlabel(label)
        axis.set_ylim(0, 1.02)
        axis.grid(alpha=0.3)
    axes[0].set_xlim(1e-4, 1e2)
    axes[1].set_xlim(1e-6, 4)
    axes[0].set_ylabel("fraction of all pairs")
    axes[0].legend(loc="lower right")
    figure.savefig(folder / f"figure_{name}.png", dpi=110, bbox_inches="tight", metadata={"Software": None})
    plt.close(figure)


def main():
    folder = pathlib.Path(sys.argv[1])
    results = {name: read_methods(folder, name) for name, _ in SETS}
    lines = []
    for name, title in SETS:
        lines += accuracy_table(title, name, results[name]) + [""]
        draw(folder, name, results[name])
    lines += time_table(results) + [""] + notes(results)
    text = "\n".join(lines) + "\n"
    (folder / "tables.txt").write_text(text)
    print(text, end="")


if __name__ == "__main__":
    main()
