# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
"""What the scripts that draw have in common. Exits with 77 when matplotlib is missing."""
import sys

try:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import numpy as np
except ImportError as error:
    print(error, file=sys.stderr)
    sys.exit(77)


def save(figure, path):
    # No date in the file: the same results give the same bytes.
    figure.savefig(path, dpi=110, bbox_inches="tight", metadata={"Software": None})
    plt.close(figure)


def label(axis, x, y):
    axis.set_xlabel(x)
    axis.set_ylabel(y)
    axis.grid(alpha=0.3)
    axis.legend()


def label_plan(axis):
    """Of a way seen from above."""
    axis.set_aspect("equal", adjustable="datalim")
    label(axis, "x [m]", "y [m]")


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


def draw_map(path, picture, title=None):
    """Draws a map from above, coloured by height; nothing where there is no map."""
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
    if title is not None:
        axis.set_title(title)
    figure.colorbar(drawn, ax=axis, label="height [m]", shrink=0.8)
    save(figure, picture)
