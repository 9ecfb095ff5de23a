#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
"""Draws the figures of a traverse from the files in its report folder.

Usage: draw_traverse_report.py FOLDER
Reads  report.json, map.ply (where there is one)
Writes figure_1_trajectory.png, figure_2_map.png, figure_3_verdicts.png
Exits with 77 when matplotlib is missing.
"""
import json
import pathlib
import sys

import drawing  # ends the program where matplotlib is missing
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Ellipse

COLOUR_OF = {"segment_start": "#009E73", "registered": "#0072B2", "prior": "#D55E00"}
NAME_OF = {"segment_start": "begins a segment", "registered": "registered", "prior": "carried by the prior"}
NUM_SIGMAS = 2


def place_of(scan):
    return np.array(scan["T_segment_scan"])[:3, 3]


def ellipse_of(scan):
    """The ellipse of the place in x and y; None without a covariance."""
    if scan["position_covariance"] is None:
        return None
    values, vectors = np.linalg.eigh(np.array(scan["position_covariance"])[:2, :2])
    width, height = 2 * NUM_SIGMAS * np.sqrt(np.maximum(values, 0))
    angle = np.degrees(np.arctan2(vectors[1, 0], vectors[0, 0]))
    return Ellipse(place_of(scan)[:2], width, height, angle=angle, facecolor="none", edgecolor="grey", linewidth=0.8)


def draw_trajectory(folder, report):
    segments = sorted({scan["segment"] for scan in report["scans"]})
    if not segments:
        return
    # Frames of different segments are unrelated, so each has its own axes; the largest few are shown.
    sizes = {segment: sum(scan["segment"] == segment for scan in report["scans"]) for segment in segments}
    shown = sorted(sorted(segments, key=lambda segment: -sizes[segment])[:4])
    figure, axes = plt.subplots(1, len(shown), figsize=(7 * len(shown), 6), squeeze=False)
    for axis, segment in zip(axes[0], shown):
        scans = [scan for scan in report["scans"] if scan["segment"] == segment]
        places = np.array([place_of(scan) for scan in scans])
        axis.plot(places[:, 0], places[:, 1], "-", color="grey", linewidth=0.8)
        for scan in scans:
            ellipse = ellipse_of(scan)
            if ellipse is not None:
                axis.add_patch(ellipse)
        for origin, colour in COLOUR_OF.items():
            chosen = np.array([scan["origin"] == origin for scan in scans])
            if chosen.any():
                axis.plot(places[chosen, 0], places[chosen, 1], "o", color=colour, markersize=4, label=NAME_OF[origin])
        number_of = {scan["sequence_number"]: place for scan, place in zip(scans, places)}
        for link in report["later_links"]:
            if link["loop_closure"] and link["accepted"] and {link["source"], link["target"]} <= number_of.keys():
                ends = np.array([number_of[link["source"]], number_of[link["target"]]])
                axis.plot(ends[:, 0], ends[:, 1], ":", color="#CC79A7", linewidth=1.2)
        axis.set_title(f"segment {segment}")
        drawing.label_plan(axis)
    drawing.save(figure, folder / "figure_1_trajectory.png")


def draw_verdicts(folder, report):
    figure, axes = plt.subplots(3, 1, figsize=(10, 7), sharex=True)
    panels = [("overlap", "overlap", 1.0), ("residual_rmse_m", "residual [mm]", 1e3)]
    for axis, (key, label, factor) in zip(axes, panels):
        for accepted, colour, name in [(True, "#0072B2", "accepted"), (False, "#D55E00", "rejected")]:
            values = [(link["source"], factor * link[key]) for scan in report["scans"] for link in scan["links"]
                      if link["accepted"] == accepted and link[key] is not None]
            if values:
                axis.plot(*zip(*values), "o", color=colour, markersize=3, label=name)
        axis.set_ylabel(label)
        axis.grid(alpha=0.3)
    if axes[0].get_legend_handles_labels()[0]:
        axes[0].legend()
    for origin, colour in COLOUR_OF.items():
        numbers = [scan["sequence_number"] for scan in report["scans"] if scan["origin"] == origin]
        axes[2].bar(numbers, np.ones(len(numbers)), width=0.9, color=colour, label=NAME_OF[origin])
    axes[2].set_yticks([])
    axes[2].set_ylim(0, 1.4)  # room for the legend
    axes[2].xaxis.get_major_locator().set_params(integer=True)
    axes[2].set_ylabel("pose")
    axes[2].set_xlabel("scan")
    axes[2].legend(loc="upper right", ncols=3)
    drawing.save(figure, folder / "figure_3_verdicts.png")


def main():
    folder = pathlib.Path(sys.argv[1])
    report = json.loads((folder / "report.json").read_text())
    draw_trajectory(folder, report)
    drawing.draw_map(folder / "map.ply", folder / "figure_2_map.png")
    draw_verdicts(folder, report)


if __name__ == "__main__":
    main()
