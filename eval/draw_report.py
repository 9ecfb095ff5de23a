#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
"""Draws the figures of an evaluation from the files in its report folder.

Usage: draw_report.py FOLDER
Reads  of pairs:      report.json, distributions.csv, trajectory_*.tum, map_*.ply
       of a traverse: traverse.json, trajectory_*.tum, map_optimised.ply
Writes figure_1_errors.png, figure_2_run_time.png (of pairs), figure_3_trajectory.png, figure_4_map_METHOD.png,
       figure_5_drift.png (of a traverse)
Exits with 77 when matplotlib is missing.
"""
import csv
import json
import pathlib
import sys

try:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import numpy as np
except ImportError as error:
    print(error, file=sys.stderr)
    sys.exit(77)

OK_TRANSLATION_M = 0.5
OK_ROTATION_RAD = 0.1
# Colours told apart with any colour vision (Okabe and Ito).
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]
# Lines that coincide still show, the later ones being broken.
STYLES = ["-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 2)), (0, (8, 3))]


def save(figure, path):
    # No date in the file: the same results give the same bytes.
    figure.savefig(path, dpi=110, bbox_inches="tight", metadata={"Software": None})
    plt.close(figure)


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


def read_map(path):
    """N x 3 points of a binary little-endian PLY with float32 x, y, z alone."""
    with open(path, "rb") as file:
        count = 0
        for line in iter(file.readline, b""):
            words = line.split()
            if words[:2] == [b"element", b"vertex"]:
                count = int(words[2])
            if words[:1] == [b"end_header"]:
                break
        return np.frombuffer(file.read(12 * count), dtype="<f4").reshape(-1, 3)


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
    axes[0].set_ylabel("share of all pairs")
    axes[0].legend(loc="upper left")
    save(figure, folder / "figure_1_errors.png")


def draw_run_time(folder, report):
    methods = report["methods"]
    seconds = [[d["seconds"] for d in m["details"] if d["seconds"] is not None] for m in methods]
    figure, axis = plt.subplots(figsize=(2.5 + 1.3 * len(methods), 4.2))
    axis.boxplot(seconds, labels=[m["method"] for m in methods], whis=(5, 95), showfliers=True,
                 medianprops={"color": COLOURS[1]})
    axis.set_yscale("log")
    axis.set_ylabel("seconds per pair")
    axis.grid(axis="y", alpha=0.3)
    save(figure, folder / "figure_2_run_time.png")


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
    axis.set_aspect("equal", adjustable="datalim")
    axis.set_xlabel("x [m]")
    axis.set_ylabel("y [m]")
    axis.grid(alpha=0.3)
    axis.legend()
    save(figure, folder / "figure_3_trajectory.png")


def draw_map(folder, method):
    path = folder / f"map_{method}.ply"
    if not path.exists():
        return
    points = read_map(path)
    if len(points) == 0:
        return
    points = points[np.argsort(points[:, 2], kind="stable")]  # the highest last, on top
    low, high = np.percentile(points[:, 2], [1, 99])
    # A few far returns must not shrink the ground to a speck.
    left, right = np.percentile(points[:, 0], [0.5, 99.5])
    bottom, top = np.percentile(points[:, 1], [0.5, 99.5])
    figure, axis = plt.subplots(figsize=(9, 7))
    drawn = axis.scatter(points[:, 0], points[:, 1], c=points[:, 2], s=0.3, cmap="viridis", vmin=low, vmax=high,
                         linewidths=0, rasterized=True)
    axis.set_xlim(left, right)
    axis.set_ylim(bottom, top)
    axis.set_aspect("equal", adjustable="box")
    axis.set_xlabel("x [m]")
    axis.set_ylabel("y [m]")
    axis.set_title(method)
    figure.colorbar(drawn, ax=axis, label="height [m]", shrink=0.8)
    save(figure, folder / f"figure_4_map_{method}.png")


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
    axis.set_xlabel("way driven [m]")
    axis.set_ylabel("error of the position [mm]")
    axis.grid(alpha=0.3)
    axis.legend()
    save(figure, folder / "figure_5_drift.png")


def main():
    folder = pathlib.Path(sys.argv[1])
    if not (folder / "report.json").exists():
        names = ["tracked", "optimised"]
        draw_trajectory(folder, names)
        draw_map(folder, "optimised")
        draw_drift(folder, names)
        return
    report = json.loads((folder / "report.json").read_text())
    methods = [m["method"] for m in report["methods"]]
    draw_errors(folder, methods, read_distributions(folder))
    draw_run_time(folder, report)
    draw_trajectory(folder, methods)
    for method in methods:
        draw_map(folder, method)


if __name__ == "__main__":
    main()
