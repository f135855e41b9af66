"""Files for VTK and ParaView of a body in parts (.pvtu), each of which is a file of its own (.vtu)."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from xml.sax.saxutils import quoteattr


def PieceName(path: Path, number: int) -> Path:
    """The file of a part, in a folder beside the one that names them all."""
    return path.with_suffix("") / f"part-{number:04d}.vtu"


def WriteList(path: Path, numbers: Sequence[int]) -> Path:
    """Write the file (.pvtu) that names parts, of these numbers, whose fields are those of the first; returns its Path."""
    pieces = [PieceName(path, number) for number in numbers]
    with open(pieces[0], "rb") as file:
        head = file.read(1 << 16).split(b"<AppendedData")[0].decode()
    lines = ['<PPoints>', '<PDataArray type="Float64" Name="Points" NumberOfComponents="3"/>', '</PPoints>']
    for section in ("CellData", "PointData"):
        body = re.search(f"<{section}>(.*?)</{section}>", head, re.S)
        fields = re.findall(r'type="(\w+)" Name="(\w+)" NumberOfComponents="(\d+)"', body.group(1) if body else "")
        lines += [f"<P{section}>", *(f'<PDataArray type="{kind}" Name="{name}" NumberOfComponents="{components}"/>'
                                     for kind, name, components in fields), f"</P{section}>"]
    lines += [f"<Piece Source={quoteattr(f'{piece.parent.name}/{piece.name}')}/>" for piece in pieces]
    path.write_text("\n".join(['<?xml version="1.0"?>', '<VTKFile type="PUnstructuredGrid" version="1.0" '
                               'byte_order="LittleEndian">', '<PUnstructuredGrid GhostLevel="0">', *lines,
                               "</PUnstructuredGrid>", "</VTKFile>", ""]), encoding="utf-8")
    return path
