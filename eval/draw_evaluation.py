#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
"""Draws the figures of an evaluation from the files in its report folder.

Usage: draw_evaluation.py pairs|traverse FOLDER
Reads  of pairs:      report.json, distributions.csv, trajectory_*.tum, map_*.ply
       of a traverse: trajectory_*.tum, map_optimised.ply
Writes figure_1_errors.png, figure_2_run_time.png (of pairs), figure_3_trajectory.png, figure_4_map_METHOD.png,
       figure_5_drift.png (of a traverse)
Exits with 77 when matplotlib is missing.
"""
import csv
import json
import pathlib
import sys

import drawing  # ends the program where matplotlib is missing
import matplotlib.pyplot as plt
import numpy as np

OK_TRANSLATION_M = 0.5
OK_ROTATION_RAD = 0.1
# Colours told apart with any colour vision (Okabe and Ito).
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]
# Lines that coincide still show, the later ones being broken.
STYLES = ["-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 2)), (0, (8, 3))]


def read_distributions(folder):
    """{(method, quantity): [(value, share), ...]}"""
    steps = {}
    with open(folder / "distributions.csv", newline="") as file:
        for row in csv.DictReader(file):
            steps.setdefault((row["method"], row["quantity"]), []).append((float(row["value"]), float(row["share"])))
    return steps


def read_trajectory(path):
    """(scan numbers, N x 3 positions); empty when there is no such file."""
    if not path.exists():
        return np.zeros(0), np.zeros((0, 3))
    rows = [line.split() for line in path.read_text().splitlines() if line and not line.startswith("#")]
    values = np.array(rows, dtype=float).reshape(len(rows), 8)
    return values[:, 0], values[:, 1:4]


def draw_errors(folder, methods, steps):
    figure, axes = plt.subplots(1, 2, figsize=(11, 4.2), sharey=True)
    panels = [("translation_m", "translation error [m]", OK_TRANSLATION_M),
              ("rotation_rad", "rotation error [rad]", OK_ROTATION_RAD)]
    for axis, (quantity, label, bound) in zip(axes, panels):
        for colour, style, method in zip(COLOURS, STYLES, methods):
            points = steps.get((method, quantity), [])
            values = np.maximum([value for value, _ in points], 1e-7)
            if len(values) > 0:
                # From the first value on the axis to its right end, so that single pairs show, too.
                axis.step(np.r_[values[0], values, 1e3], np.r_[0, [share for _, share in points], points[-1][1]],
                          where="post", color=colour, linestyle=style, label=method)
        axis.axvline(bound, color="grey", linestyle=":", linewidth=1)
        axis.set_xscale("log")
        largest = max([value for method in methods for value, _ in steps.get((method, quantity), [])] + [bound])
        smallest = min([value for method in methods for value, _ in steps.get((method, quantity), [])] + [bound])
        axis.set_xlim(max(smallest, 1e-7) * 0.5, largest * 3)
        axis.set_ylim(0, 1.02)
        axis.set_xlabel(label)
        axis.grid(alpha=0.3)
    axes[0].set_ylabel("fraction of all pairs")
    axes[0].legend(loc="upper left")
    drawing.save(figure, folder / "figure_1_errors.png")


def draw_run_time(folder, report):
    methods = report["methods"]
    seconds = [[d["seconds"] for d in m["details"] if d["seconds"] is not None] for m in methods]
    figure, axis = plt.subplots(figsize=(2.5 + 1.3 * len(methods), 4.2))
    axis.boxplot(seconds, labels=[m["method"] for m in methods], whis=(5, 95), showfliers=True,
                 medianprops={"color": COLOURS[1]})
    axis.set_yscale("log")
    axis.set_ylabel("seconds per pair")
    axis.grid(axis="y", alpha=0.3)
    drawing.save(figure, folder / "figure_2_run_time.png")


def draw_trajectory(folder, methods):
    _, truth = read_trajectory(folder / "trajectory_truth.tum")
    estimates = [read_trajectory(folder / f"trajectory_{method}.tum")[1] for method in methods]
    if len(truth) == 0 and all(len(estimate) == 0 for estimate in estimates):
        return
    figure, axis = plt.subplots(figsize=(7, 6))
    axis.plot(truth[:, 0], truth[:, 1], "--o", color="grey", markersize=6, fillstyle="none", label="truth")
    for colour, method, estimate in zip(COLOURS, methods, estimates):
        if len(estimate) > 0:
            axis.plot(estimate[:, 0], estimate[:, 1], "-x", color=colour, markersize=4, linewidth=0.8, label=method)
    drawing.label_plan(axis)
    drawing.save(figure, folder / "figure_3_trajectory.png")


def draw_drift(folder, names):
    numbers, truth = read_trajectory(folder / "trajectory_truth.tum")
    if len(numbers) == 0:
        return
    travelled = dict(zip(numbers, np.r_[0, np.cumsum(np.linalg.norm(np.diff(truth, axis=0), axis=1))]))
    place_of = dict(zip(numbers, truth))
    figure, axis = plt.subplots(figsize=(9, 4.2))
    for colour, style, name in zip(COLOURS, STYLES, names):
        scans, places = read_trajectory(folder / f"trajectory_{name}.tum")
        known = [i for i, scan in enumerate(scans) if scan in place_of]
        if not known:
            continue
        errors = [1e3 * np.linalg.norm(places[i] - place_of[scans[i]]) for i in known]
        axis.plot([travelled[scans[i]] for i in known], errors, color=colour, linestyle=style, marker=".", label=name)
    drawing.label(axis, "distance driven [m]", "error of the position [mm]")
    drawing.save(figure, folder / "figure_5_drift.png")


def draw_map(folder, name):
    drawing.draw_map(folder / f"map_{name}.ply", folder / f"figure_4_map_{name}.png", name)


def draw_pairs(folder):
    report = json.loads((folder / "report.json").read_text())
    methods = [m["method"] for m in report["methods"]]
    draw_errors(folder, methods, read_distributions(folder))
    draw_run_time(folder, report)
    draw_trajectory(folder, methods)
    for method in methods:
        draw_map(folder, method)


def draw_traverse(folder):
    names = ["tracked", "optimised"]
    draw_trajectory(folder, names)
    draw_map(folder, "optimised")
    draw_drift(folder, names)


if __name__ == "__main__":
    {"pairs": draw_pairs, "traverse": draw_traverse}[sys.argv[1]](pathlib.Path(sys.argv[2]))
