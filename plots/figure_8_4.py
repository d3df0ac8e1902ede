#!/usr/bin/python3
"""Figure 8.4 of Krestenitis (2018): the hopper scene at four times, grains coloured by speed."""
import packages  # noqa: F401, I001: before all that need them
import sys
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from figure import GREY, STYLE, Drawn, command_line, foot, head, save
from frames import Frame, read_frame, read_frames, standing
from records import DRAWN, NothingToDraw, Sweep, load_sweep

NAME = "figure_8_4"
LIGHT = np.array([0.4, 0.8, -0.45])  # direction towards the lamp, y up


def draw(results: Path, out: Path) -> Drawn:
    """Reads RESULTS/figure_8_4 and its frames, writes OUT/figure_8_4.svg, .png and .csv."""
    sweep = load_sweep(results, NAME)
    frames = load_four(sweep)
    notes = [f"{sweep.points[0].state}: {sweep.points[0].why}"] if not frames else \
        ["Hopper and floor are drawn translucent; the camera looks slightly down. y points up."]
    rows = []
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(10, 8.8))
        head(figure, sweep)
        if not frames:
            figure.text(0.5, 0.5, f"{sweep.points[0].state} {sweep.points[0].why}", ha="center", color=GREY)
        else:
            walls = standing(frames[0], frames[-1])
            scale = Normalize(0, max(frame.speed.max() for frame in frames) or 1)
            for place, frame in enumerate(frames):
                draw_scene(figure.add_subplot(2, 2, place + 1, projection="3d"), frame, walls, scale)
            rows = [row for frame in frames for row in body_rows(frame, walls)]
            bar = figure.add_axes((0.3, 0.085, 0.4, 0.012))
            figure.colorbar(ScalarMappable(scale, "viridis"), cax=bar, orientation="horizontal", label="speed (m/s)")
        foot(figure, sweep)
        figure.subplots_adjust(left=0, right=1, top=0.95, bottom=0.12, wspace=0, hspace=0.05)
        header = ["time_s", "body", "x_m", "y_m", "z_m", "speed_m_s"]
        return save(figure, Drawn(NAME, sweep, out, notes), header, rows)


def load_four(sweep: Sweep) -> list[Frame]:
    """Four frames, evenly from first to last; none if the point may not be drawn. NothingToDraw if they are gone."""
    point = sweep.points[0]
    if point.state != DRAWN:
        return []
    folder = sweep.folder / "frames" / point.id
    try:
        there = read_frames(folder)
        chosen = np.linspace(0, len(there) - 1, 4).round().astype(int)
        return [read_frame(*there[i]) for i in dict.fromkeys(chosen)]
    except (OSError, ValueError, KeyError, SyntaxError) as error:
        raise NothingToDraw(f"cannot read the frames ({folder}: {error}). Remove {point.id}.json beside them and run "
                            f"`build/release/bin/sweep run {NAME}` again.") from None


def draw_scene(axis, frame: Frame, walls: np.ndarray, scale: Normalize) -> None:
    """Grains shaded by their normals; the view is cut to where grains and walls are."""
    corners = frame.corners[..., [0, 2, 1]]  # matplotlib's z points up
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    lit = 0.65 + 0.35 * np.abs(normal @ (LIGHT[[0, 2, 1]] / np.linalg.norm(LIGHT)))
    colours = matplotlib.colormaps["viridis"](scale(frame.speed))
    colours[:, :3] *= lit[:, None]
    for chosen, face, order in ((~walls, colours[~walls], 2), (walls, (0.5, 0.5, 0.55, 0.13), 1)):
        surface = Poly3DCollection(corners[chosen], facecolors=face, edgecolors="none", zorder=order, rasterized=True)
        axis.add_collection3d(surface)
    middle, half = corners[walls].mean((0, 1)), 0.17
    axis.set(xlim=(middle[0] - half, middle[0] + half), ylim=(middle[1] - half, middle[1] + half), zlim=(0.32, 0.80))
    axis.set_box_aspect((1, 1, 0.48 / (2 * half)), zoom=1.35)
    axis.view_init(elev=14, azim=-62)
    axis.set_axis_off()
    axis.set_title(f"t = {frame.time:.3g} s", y=0.97)


def body_rows(frame: Frame, walls: np.ndarray) -> list[list]:
    """Time, number, middle of the corners and speed of every grain."""
    rows = []
    for body in np.unique(frame.body[~walls]):
        mine = frame.body == body
        middle = frame.corners[mine].mean((0, 1))
        rows.append([f"{frame.time:.6g}", body, *(f"{x:.6g}" for x in middle), f"{frame.speed[mine][0]:.6g}"])
    return rows


if __name__ == "__main__":
    sys.exit(command_line(draw, __doc__))
