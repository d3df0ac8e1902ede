"""Reads the frames that dem_bench --vtk writes: frames.pvd and VTK PolyData files with appended base64 arrays."""
import base64
import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

TYPES = {"Float64": "<f8", "Int64": "<i8", "Int32": "<i4"}
HEADER_BYTES = 8  # each array is preceded by its length as UInt64


@dataclass(frozen=True)
class Frame:
    """All surfaces at `time` (s): corners (triangle, corner, axis) in m, and per triangle body number and speed (m/s)."""
    time: float
    corners: np.ndarray
    body: np.ndarray
    speed: np.ndarray


def read_frames(folder: Path, listing: str = "frames.pvd") -> list[tuple[float, Path]]:
    """Times (s) and files of a frames.pvd or grid.pvd, in its order. OSError or ValueError if it cannot be read."""
    root = ElementTree.fromstring((folder / listing).read_text(encoding="utf-8"))
    return [(float(data.attrib["timestep"]), folder / data.attrib["file"]) for data in root.iter("DataSet")]


def read_frame(time: float, path: Path) -> Frame:
    """One frame. ValueError if the file is not of the kind that dem_bench writes."""
    array = arrays_of(path)
    points = array("position_m").reshape(-1, 3)
    corners = points[array("connectivity").reshape(-1, 3)]
    return Frame(time, corners, array("body"), array("speed_m_s"))


def cells_of(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Lower and upper corners (m) and levels of the cells of a grid. ValueError as read_frame()."""
    array = arrays_of(path)
    corners = array("position_m").reshape(-1, 3)[array("connectivity").reshape(-1, 8)]
    return corners[:, 0], corners[:, 7], array("level")


def arrays_of(path: Path) -> Callable[[str], np.ndarray]:
    """What reads the arrays of one file by name."""
    text = path.read_text(encoding="ascii")
    head, _, tail = text.partition('<AppendedData encoding="base64">')
    data = tail[tail.find("_") + 1:]

    def array(name: str) -> np.ndarray:
        found = re.search(rf'<DataArray type="(\w+)" Name="{name}"[^>]*format="appended" offset="(\d+)"', head)
        if not found or not data:
            raise ValueError(f"there is no appended array '{name}' ({path})")
        begin = int(found[2])
        count = int.from_bytes(base64.b64decode(data[begin:begin + 12])[:HEADER_BYTES], "little")
        encoded = data[begin:begin + (HEADER_BYTES + count + 2) // 3 * 4]
        return np.frombuffer(base64.b64decode(encoded)[HEADER_BYTES:HEADER_BYTES + count], TYPES[found[1]])

    return array


def standing(first: Frame, last: Frame) -> np.ndarray:
    """For each triangle whether it is of a body that is at the same place in both frames, as walls are."""
    moved = np.any(first.corners != last.corners, axis=(1, 2))
    return ~np.isin(first.body, first.body[moved])
