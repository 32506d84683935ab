"""Meshes and fields in the result folder of a run."""

from __future__ import annotations

import base64
import xml.etree.ElementTree as ElementTree
import zlib
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .errors import PulloutError

if TYPE_CHECKING:
    import pyvista

__all__ = ["Mesh", "Series"]

_TYPES = {"Float64": "<f8", "Int32": "<i4", "Int64": "<i8", "UInt8": "u1"}


class Mesh(NamedTuple):
    """The mesh at one time, with its fields. Nodes are numbered from 0."""

    time: float
    #: (n, 3), positions before the run
    points: NDArray[np.float64]
    #: nodes of all cells one after the other, the end of each cell in them, and VTK's cell types
    connectivity: NDArray[np.int64]
    offsets: NDArray[np.int64]
    types: NDArray[np.uint8]
    #: by name, one row per node
    point_data: dict[str, NDArray[Any]]
    #: by name, one row per cell
    cell_data: dict[str, NDArray[Any]]

    def __repr__(self) -> str:
        fields = ", ".join([*self.point_data, *self.cell_data])
        return f"<Mesh at time {self.time:g}: {len(self.points)} nodes, {len(self.types)} cells, {fields}>"

    def cells(self) -> list[NDArray[np.int64]]:
        """Return the nodes of each cell."""
        return np.split(self.connectivity, self.offsets[:-1])

    def to_pyvista(self) -> pyvista.UnstructuredGrid:
        """Return the mesh for pyvista, which must be installed."""
        import pyvista

        sizes = np.diff(self.offsets, prepend=0)
        flat = np.insert(self.connectivity, self.offsets - sizes, sizes)
        grid = pyvista.UnstructuredGrid(flat, self.types, self.points)
        grid.point_data.update(self.point_data)
        grid.cell_data.update(self.cell_data)
        return grid


class Series:
    """The meshes of a run, listed in the file ``fields.pvd`` of its folder."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        file = folder / "fields.pvd"
        if not file.is_file():
            raise PulloutError(f"{folder} has no fields: set \"output\": {{\"vtu\": true}} in the case")
        sets = [dict(entry.attrib) for entry in ElementTree.parse(file).getroot().iter("DataSet")]
        #: times of the meshes
        self.times = [float(entry["timestep"]) for entry in sets if entry["part"] == "0"]
        self._files = [[entry["file"] for entry in sets if entry["part"] == part] for part in ("0", "1")]

    def __repr__(self) -> str:
        return f"<Series of {len(self.times)} meshes in {self._folder}>"

    def mesh(self, frame: int = -1) -> Mesh:
        """Return the mesh of the solids."""
        return _read(self._folder / self._files[0][frame])

    def contact(self, frame: int = -1) -> Mesh:
        """Return the contact points at their positions at that time."""
        if not self._files[1]:
            raise PulloutError(f"{self._folder}: the specimen has no contact")
        return _read(self._folder / self._files[1][frame])


def _values(array: ElementTree.Element, appended: bytes) -> bytes:
    """Return the numbers of an array as bytes. pullout writes one zlib block per array into the appended data."""
    if array.attrib["format"] != "appended":
        # format of earlier versions: the number of bytes comes first
        return base64.b64decode(array.text or "")[8:]
    start = int(array.attrib["offset"])
    blocks, _, _ = np.frombuffer(appended, "<u8", 3, start)
    sizes = np.frombuffer(appended, "<u8", int(blocks), start + 24)
    first = start + 24 + 8 * int(blocks)
    ends = (first + np.cumsum(sizes)).astype(int).tolist()
    return b"".join(zlib.decompress(appended[a:b]) for a, b in zip([first, *ends], ends))


def _read(file: Path) -> Mesh:
    # what is appended is not XML
    head, found, tail = file.read_bytes().partition(b'<AppendedData encoding="raw">')
    root = ElementTree.fromstring(head + b"</VTKFile>" if found else head)
    appended = tail.partition(b"_")[2]

    def arrays(path: str) -> dict[str, NDArray[Any]]:
        found = {}
        for array in root.findall(f"./UnstructuredGrid/{path}/DataArray"):
            values = np.frombuffer(_values(array, appended), _TYPES[array.attrib["type"]])
            columns = int(array.attrib.get("NumberOfComponents", 1))
            found[array.attrib["Name"]] = values.reshape(-1, columns) if columns > 1 else values
        return found

    cells = arrays("Piece/Cells")
    return Mesh(
        float(arrays("FieldData")["TimeValue"][0]),
        arrays("Piece/Points")["Points"],
        cells["connectivity"],
        cells["offsets"],
        cells["types"],
        arrays("Piece/PointData"),
        arrays("Piece/CellData"),
    )
