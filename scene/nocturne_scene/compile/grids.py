"""Grids of OpenVDB files where they stand, as messages and blobs."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from nocturne.v1 import scene_pb2

from nocturne_scene.blobs import NoteKey
from nocturne_scene.compile.placement import placement_of
from nocturne_scene.compile.workspace import Unusable, Workspace
from nocturne_scene.document import bounds
from nocturne_scene.document.media import Grid
from nocturne_scene.document.shapes import Box
from nocturne_scene.media import grid_files
from nocturne_scene.meshes.simple import box_mesh
from nocturne_scene.meshes.triangles import Triangles


@dataclass(frozen=True)
class _Converted:
    blob: bytes
    facts: grid_files.GridFacts


class Grids:
    """Converts grids, each once for all scenes of a blob store."""

    def __init__(self, workspace: Workspace) -> None:
        self._workspace = workspace
        self._converted: dict[tuple[str, str], _Converted] = {}

    def density(self, grid: Grid) -> scene_pb2.DensityGrid:
        """Return a grid where it stands; raises Unusable."""
        converted = self._convert(grid)
        if converted.facts.minimum < 0:
            raise Unusable(f'grid "{grid.grid}" has negative values, down to {converted.facts.minimum:g}')
        rows = self._workspace.frame.after(placement_of(grid)).rows()
        if not np.abs(rows).max() <= bounds.LENGTH:
            raise Unusable(f"is farther than {bounds.LENGTH:g} m from the origin, or larger than that")
        return scene_pb2.DensityGrid(
            blob=converted.blob,
            transform=(rows + 0.0).ravel().tolist(),
            scale=grid.factor,
            nearest=grid.nearest,
        )

    def box(self, grid: Grid) -> Triangles:
        """Return the box around the voxels that hold values, where the grid stands; raises Unusable.

        Half a voxel wider where values are constant over voxels, one where they are linear in between.
        """
        facts = self._convert(grid).facts
        margin = 0.5 if grid.nearest else 1.0
        low, high = np.array(facts.first_voxel) - margin, np.array(facts.last_voxel) + margin
        mesh = box_mesh(Box(type="box", minimum=tuple(low.tolist()), maximum=tuple(high.tolist())))
        to_grid = np.array(facts.transform)
        placed = placement_of(grid).points(mesh.vertices @ to_grid[:, :3].T + to_grid[:, 3])
        # A transform that mirrors would turn the box inside out.
        indices = mesh.indices if np.linalg.det(to_grid[:, :3]) > 0 else mesh.indices[:, ::-1]
        return Triangles(placed, indices, None, None)

    def _convert(self, grid: Grid) -> _Converted:
        key = (grid.asset, grid.grid)
        if key not in self._converted:
            source = self._workspace.asset(grid.asset, ".asset").hex()
            try:
                about = NoteKey(source, json.dumps(["grid", grid.grid, grid_files.program_digest()]))
                self._converted[key] = self._before(about) or self._anew(about, source, grid.grid)
            except grid_files.UnusableGridError as error:
                raise Unusable(str(error), ".asset") from None
        return self._converted[key]

    def _before(self, about: NoteKey) -> _Converted | None:
        """The grid as it was converted for an earlier scene, if it is still there."""
        found = self._workspace.made_before(about)
        try:
            return None if found is None else _Converted(found[0], grid_files.facts_in(found[1]))
        except (ValueError, LookupError, TypeError):
            # A damaged note is no note.
            return None

    def _anew(self, about: NoteKey, source: str, name: str) -> _Converted:
        output: Path = self._workspace.temporary("grid.nvdb")
        text = grid_files.convert(self._workspace.blobs.path(source), name, output)
        converted = _Converted(self._workspace.keep_file(output), grid_files.facts_in(text))
        self._workspace.note_made(about, converted.blob, text)
        return converted
