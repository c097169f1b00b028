# SPDX-License-Identifier: Apache-2.0
# Made by scripts/python_stubs.
import os
from typing import Any, List, Literal, Optional, Sequence, Tuple, Union

import numpy as np

from ._options import Distance, Faces, Progress, Reserve
from ._results import Block, Check, Iso, IsoShell, Layers, Offset, Refined, Shell

def offset_several(
    vertices: np.ndarray, faces: Faces, distances: Sequence[Distance], *,
    distance_z: Union[float, str, None] = None, corners: Optional[Literal['miter', 'round', 'arc']] = None,
    miter_limit: Optional[float] = None, collision: Literal['limit', 'merge'] = 'limit', taper: float = 1.0,
    only: Optional[np.ndarray] = None, border: Literal['slide', 'fixed', 'free'] = 'slide',
    symmetry: Union[bool, str, Sequence[Union[str, Sequence[float]]]] = True,
    obstacles: Optional[Tuple[np.ndarray, Faces]] = None, clearance: Union[float, str, None] = None,
    weld: Union[Literal['auto', 'exact', 'none'], float, str] = 'auto',
    orient: Literal['keep', 'fix-direction-only', 'fix-cavities'] = 'keep',
    solver: Literal['closest', 'eikonal'] = 'closest', texture: Optional[np.ndarray] = None,
    precision: Union[Literal['double', 'single'], int] = 'double', voxel_size: Union[float, str, None] = None,
    voxels_per_distance: Optional[float] = None, unit: Optional[Literal['um', 'mm', 'cm', 'm', 'in', 'ft']] = None,
    paths: bool = False, face_errors: bool = False, save_vdb: Union[str, os.PathLike, None] = None,
    threads: int = 0, max_memory: Union[int, str, None] = None, reserve: Reserve = None, progress: Progress = None
) -> List[Offset]: ...

def offset(
    vertices: np.ndarray, faces: Faces, distance: Distance, *, distance_z: Union[float, str, None] = None,
    corners: Optional[Literal['miter', 'round', 'arc']] = None, miter_limit: Optional[float] = None,
    collision: Literal['limit', 'merge'] = 'limit', taper: float = 1.0, only: Optional[np.ndarray] = None,
    border: Literal['slide', 'fixed', 'free'] = 'slide',
    symmetry: Union[bool, str, Sequence[Union[str, Sequence[float]]]] = True,
    obstacles: Optional[Tuple[np.ndarray, Faces]] = None, clearance: Union[float, str, None] = None,
    weld: Union[Literal['auto', 'exact', 'none'], float, str] = 'auto',
    orient: Literal['keep', 'fix-direction-only', 'fix-cavities'] = 'keep',
    solver: Literal['closest', 'eikonal'] = 'closest', texture: Optional[np.ndarray] = None,
    precision: Union[Literal['double', 'single'], int] = 'double', voxel_size: Union[float, str, None] = None,
    voxels_per_distance: Optional[float] = None, unit: Optional[Literal['um', 'mm', 'cm', 'm', 'in', 'ft']] = None,
    paths: bool = False, face_errors: bool = False, save_vdb: Union[str, os.PathLike, None] = None,
    threads: int = 0, max_memory: Union[int, str, None] = None, reserve: Reserve = None, progress: Progress = None
) -> Offset: ...

def offset_curves_several(
    points: np.ndarray, curves: Faces, distances: Sequence[Distance], *, distance_z: Union[float, str, None] = None,
    corners: Optional[Literal['miter', 'round', 'arc']] = None, miter_limit: Optional[float] = None,
    collision: Literal['limit', 'merge'] = 'limit', close: bool = False,
    precision: Union[Literal['double', 'single'], int] = 'double', voxel_size: Union[float, str, None] = None,
    voxels_per_distance: Optional[float] = None, unit: Optional[Literal['um', 'mm', 'cm', 'm', 'in', 'ft']] = None,
    paths: bool = False, save_vdb: Union[str, os.PathLike, None] = None, threads: int = 0,
    max_memory: Union[int, str, None] = None, reserve: Reserve = None, progress: Progress = None
) -> List[Offset]: ...

def offset_curves(
    points: np.ndarray, curves: Faces, distance: Distance, *, distance_z: Union[float, str, None] = None,
    corners: Optional[Literal['miter', 'round', 'arc']] = None, miter_limit: Optional[float] = None,
    collision: Literal['limit', 'merge'] = 'limit', close: bool = False,
    precision: Union[Literal['double', 'single'], int] = 'double', voxel_size: Union[float, str, None] = None,
    voxels_per_distance: Optional[float] = None, unit: Optional[Literal['um', 'mm', 'cm', 'm', 'in', 'ft']] = None,
    paths: bool = False, save_vdb: Union[str, os.PathLike, None] = None, threads: int = 0,
    max_memory: Union[int, str, None] = None, reserve: Reserve = None, progress: Progress = None
) -> Offset: ...

def offset_to_tolerance(
    vertices: np.ndarray, faces: Faces, distance: Distance, tolerance: Union[float, str], *, max_faces: int = 0,
    ridges_only: bool = False, corners: Optional[Literal['miter', 'round', 'arc']] = None,
    miter_limit: Optional[float] = None, collision: Literal['limit', 'merge'] = 'limit', taper: float = 1.0,
    only: Optional[np.ndarray] = None, border: Literal['slide', 'fixed', 'free'] = 'slide',
    symmetry: Union[bool, str, Sequence[Union[str, Sequence[float]]]] = True,
    obstacles: Optional[Tuple[np.ndarray, Faces]] = None, clearance: Union[float, str, None] = None,
    weld: Union[Literal['auto', 'exact', 'none'], float, str] = 'auto',
    orient: Literal['keep', 'fix-direction-only', 'fix-cavities'] = 'keep',
    solver: Literal['closest', 'eikonal'] = 'closest', texture: Optional[np.ndarray] = None,
    precision: Union[Literal['double', 'single'], int] = 'double', voxel_size: Union[float, str, None] = None,
    voxels_per_distance: Optional[float] = None, unit: Optional[Literal['um', 'mm', 'cm', 'm', 'in', 'ft']] = None,
    threads: int = 0, max_memory: Union[int, str, None] = None, reserve: Reserve = None, progress: Progress = None
) -> Refined: ...

def fit(
    vertices: np.ndarray, faces: Faces, other: Tuple[np.ndarray, Faces], clearance: Union[float, str], *,
    only: Optional[np.ndarray] = None, border: Literal['slide', 'fixed', 'free'] = 'slide',
    symmetry: Union[bool, str, Sequence[Union[str, Sequence[float]]]] = True,
    weld: Union[Literal['auto', 'exact', 'none'], float, str] = 'auto',
    orient: Literal['keep', 'fix-direction-only', 'fix-cavities'] = 'keep',
    solver: Literal['closest', 'eikonal'] = 'closest',
    precision: Union[Literal['double', 'single'], int] = 'double', voxel_size: Union[float, str, None] = None,
    voxels_per_distance: Optional[float] = None, unit: Optional[Literal['um', 'mm', 'cm', 'm', 'in', 'ft']] = None,
    paths: bool = False, face_errors: bool = False, threads: int = 0, max_memory: Union[int, str, None] = None,
    reserve: Reserve = None, progress: Progress = None
) -> Offset: ...

def shell_several(
    vertices: np.ndarray, faces: Faces, distances: Sequence[Distance], *, inner: Optional[Distance] = None,
    corners: Optional[Literal['miter', 'round', 'arc']] = None, miter_limit: Optional[float] = None,
    collision: Literal['limit', 'merge'] = 'limit', taper: float = 1.0, only: Optional[np.ndarray] = None,
    border: Literal['slide', 'fixed', 'free'] = 'slide',
    symmetry: Union[bool, str, Sequence[Union[str, Sequence[float]]]] = True,
    obstacles: Optional[Tuple[np.ndarray, Faces]] = None, clearance: Union[float, str, None] = None,
    weld: Union[Literal['auto', 'exact', 'none'], float, str] = 'auto',
    orient: Literal['keep', 'fix-direction-only', 'fix-cavities'] = 'keep',
    solver: Literal['closest', 'eikonal'] = 'closest', texture: Optional[np.ndarray] = None,
    precision: Union[Literal['double', 'single'], int] = 'double', voxel_size: Union[float, str, None] = None,
    voxels_per_distance: Optional[float] = None, unit: Optional[Literal['um', 'mm', 'cm', 'm', 'in', 'ft']] = None,
    paths: bool = False, face_errors: bool = False, save_vdb: Union[str, os.PathLike, None] = None,
    threads: int = 0, max_memory: Union[int, str, None] = None, reserve: Reserve = None, progress: Progress = None
) -> List[Shell]: ...

def shell(
    vertices: np.ndarray, faces: Faces, distance: Distance, *, inner: Optional[Distance] = None,
    corners: Optional[Literal['miter', 'round', 'arc']] = None, miter_limit: Optional[float] = None,
    collision: Literal['limit', 'merge'] = 'limit', taper: float = 1.0, only: Optional[np.ndarray] = None,
    border: Literal['slide', 'fixed', 'free'] = 'slide',
    symmetry: Union[bool, str, Sequence[Union[str, Sequence[float]]]] = True,
    obstacles: Optional[Tuple[np.ndarray, Faces]] = None, clearance: Union[float, str, None] = None,
    weld: Union[Literal['auto', 'exact', 'none'], float, str] = 'auto',
    orient: Literal['keep', 'fix-direction-only', 'fix-cavities'] = 'keep',
    solver: Literal['closest', 'eikonal'] = 'closest', texture: Optional[np.ndarray] = None,
    precision: Union[Literal['double', 'single'], int] = 'double', voxel_size: Union[float, str, None] = None,
    voxels_per_distance: Optional[float] = None, unit: Optional[Literal['um', 'mm', 'cm', 'm', 'in', 'ft']] = None,
    paths: bool = False, face_errors: bool = False, save_vdb: Union[str, os.PathLike, None] = None,
    threads: int = 0, max_memory: Union[int, str, None] = None, reserve: Reserve = None, progress: Progress = None
) -> Shell: ...

def height_of_y_plus(
    y_plus: float, reynolds: float, length: float = 1.0
) -> float: ...

def layers(
    vertices: np.ndarray, faces: Faces, heights: Optional[Sequence[Distance]] = None, *,
    count: Optional[int] = None, first: Optional[Distance] = None, total: Optional[Distance] = None,
    last: Optional[Distance] = None, growth: Optional[float] = None, walls: Optional[Sequence[str]] = None,
    cells: Literal['any', 'openfoam'] = 'any', fan_angle: Optional[float] = None,
    corners: Optional[Literal['miter', 'round', 'arc']] = None, miter_limit: Optional[float] = None,
    only: Optional[np.ndarray] = None, border: Literal['slide', 'fixed', 'free'] = 'slide',
    symmetry: Union[bool, str, Sequence[Union[str, Sequence[float]]]] = True,
    obstacles: Optional[Tuple[np.ndarray, Faces]] = None, clearance: Union[float, str, None] = None,
    weld: Union[Literal['auto', 'exact', 'none'], float, str] = 'auto',
    orient: Literal['keep', 'fix-direction-only', 'fix-cavities'] = 'keep',
    solver: Literal['closest', 'eikonal'] = 'closest', texture: Optional[np.ndarray] = None,
    precision: Union[Literal['double', 'single'], int] = 'double', voxel_size: Union[float, str, None] = None,
    voxels_per_distance: Optional[float] = None, unit: Optional[Literal['um', 'mm', 'cm', 'm', 'in', 'ft']] = None,
    threads: int = 0, max_memory: Union[int, str, None] = None, reserve: Reserve = None, progress: Progress = None
) -> Layers: ...

def curve_layers(
    points: np.ndarray, curves: Faces, heights: Optional[Sequence[Distance]] = None, *, count: Optional[int] = None,
    first: Optional[Distance] = None, total: Optional[Distance] = None, last: Optional[Distance] = None,
    growth: Optional[float] = None, fan_angle: Optional[float] = None,
    corners: Optional[Literal['miter', 'round', 'arc']] = None, miter_limit: Optional[float] = None,
    close: bool = False, precision: Union[Literal['double', 'single'], int] = 'double',
    voxel_size: Union[float, str, None] = None, voxels_per_distance: Optional[float] = None,
    unit: Optional[Literal['um', 'mm', 'cm', 'm', 'in', 'ft']] = None, threads: int = 0,
    max_memory: Union[int, str, None] = None, reserve: Reserve = None, progress: Progress = None
) -> Layers: ...

def iso_surface(
    vertices: np.ndarray, faces: Faces, distance: Union[float, str], *,
    inside: Literal['winding', 'never'] = 'winding', adaptivity: Optional[float] = None, keep_specks: bool = False,
    distance_z: Union[float, str, None] = None, weld: Union[Literal['auto', 'exact', 'none'], float, str] = 'auto',
    orient: Literal['keep', 'fix-direction-only', 'fix-cavities'] = 'keep',
    precision: Union[Literal['double', 'single'], int] = 'double', voxel_size: Union[float, str, None] = None,
    voxels_per_distance: Optional[float] = None, unit: Optional[Literal['um', 'mm', 'cm', 'm', 'in', 'ft']] = None,
    threads: int = 0, max_memory: Union[int, str, None] = None, reserve: Reserve = None, progress: Progress = None
) -> Iso: ...

def iso_surface_several(
    vertices: np.ndarray, faces: Faces, distances: Sequence[Union[float, str]], *,
    inside: Literal['winding', 'never'] = 'winding', adaptivity: Optional[float] = None, keep_specks: bool = False,
    distance_z: Union[float, str, None] = None, weld: Union[Literal['auto', 'exact', 'none'], float, str] = 'auto',
    orient: Literal['keep', 'fix-direction-only', 'fix-cavities'] = 'keep',
    precision: Union[Literal['double', 'single'], int] = 'double', voxel_size: Union[float, str, None] = None,
    voxels_per_distance: Optional[float] = None, unit: Optional[Literal['um', 'mm', 'cm', 'm', 'in', 'ft']] = None,
    threads: int = 0, max_memory: Union[int, str, None] = None, reserve: Reserve = None, progress: Progress = None
) -> List[Iso]: ...

def iso_shell(
    vertices: np.ndarray, faces: Faces, distance: Union[float, str], *, inner: Optional[Distance] = None,
    inside: Literal['winding', 'never'] = 'winding', adaptivity: Optional[float] = None, keep_specks: bool = False,
    weld: Union[Literal['auto', 'exact', 'none'], float, str] = 'auto',
    orient: Literal['keep', 'fix-direction-only', 'fix-cavities'] = 'keep',
    precision: Union[Literal['double', 'single'], int] = 'double', voxel_size: Union[float, str, None] = None,
    voxels_per_distance: Optional[float] = None, unit: Optional[Literal['um', 'mm', 'cm', 'm', 'in', 'ft']] = None,
    threads: int = 0, max_memory: Union[int, str, None] = None, reserve: Reserve = None, progress: Progress = None
) -> IsoShell: ...

def structured_layers(
    vertices: np.ndarray, faces: Faces, heights: Optional[Sequence[Distance]] = None, *,
    count: Optional[int] = None, first: Optional[Distance] = None, total: Optional[Distance] = None,
    last: Optional[Distance] = None, growth: Optional[float] = None, walls: Optional[Sequence[str]] = None,
    corners: Optional[Literal['miter', 'round', 'arc']] = None, miter_limit: Optional[float] = None,
    only: Optional[np.ndarray] = None, border: Literal['slide', 'fixed', 'free'] = 'slide',
    symmetry: Union[bool, str, Sequence[Union[str, Sequence[float]]]] = True,
    obstacles: Optional[Tuple[np.ndarray, Faces]] = None, clearance: Union[float, str, None] = None,
    weld: Union[Literal['auto', 'exact', 'none'], float, str] = 'auto',
    orient: Literal['keep', 'fix-direction-only', 'fix-cavities'] = 'keep',
    solver: Literal['closest', 'eikonal'] = 'closest', texture: Optional[np.ndarray] = None,
    precision: Union[Literal['double', 'single'], int] = 'double', voxel_size: Union[float, str, None] = None,
    voxels_per_distance: Optional[float] = None, unit: Optional[Literal['um', 'mm', 'cm', 'm', 'in', 'ft']] = None,
    threads: int = 0, max_memory: Union[int, str, None] = None, reserve: Reserve = None, progress: Progress = None
) -> Block: ...

def structured_curve_layers(
    points: np.ndarray, curves: Faces, heights: Optional[Sequence[Distance]] = None, *, count: Optional[int] = None,
    first: Optional[Distance] = None, total: Optional[Distance] = None, last: Optional[Distance] = None,
    growth: Optional[float] = None, corners: Optional[Literal['miter', 'round', 'arc']] = None,
    miter_limit: Optional[float] = None, close: bool = False,
    precision: Union[Literal['double', 'single'], int] = 'double', voxel_size: Union[float, str, None] = None,
    voxels_per_distance: Optional[float] = None, unit: Optional[Literal['um', 'mm', 'cm', 'm', 'in', 'ft']] = None,
    threads: int = 0, max_memory: Union[int, str, None] = None, reserve: Reserve = None, progress: Progress = None
) -> Block: ...

def check(
    vertices: np.ndarray, faces: Faces, positions: np.ndarray, distance: Optional[Distance] = None, *,
    tolerance: Union[float, str, None] = None, distance_z: Union[float, str, None] = None,
    corners: Optional[Literal['miter', 'round', 'arc']] = None, miter_limit: Optional[float] = None,
    collision: Literal['limit', 'merge'] = 'limit', taper: float = 1.0, only: Optional[np.ndarray] = None,
    border: Literal['slide', 'fixed', 'free'] = 'slide',
    symmetry: Union[bool, str, Sequence[Union[str, Sequence[float]]]] = True,
    obstacles: Optional[Tuple[np.ndarray, Faces]] = None, clearance: Union[float, str, None] = None,
    weld: Union[Literal['auto', 'exact', 'none'], float, str] = 'auto',
    orient: Literal['keep', 'fix-direction-only', 'fix-cavities'] = 'keep',
    solver: Literal['closest', 'eikonal'] = 'closest', texture: Optional[np.ndarray] = None,
    precision: Union[Literal['double', 'single'], int] = 'double', voxel_size: Union[float, str, None] = None,
    voxels_per_distance: Optional[float] = None, unit: Optional[Literal['um', 'mm', 'cm', 'm', 'in', 'ft']] = None,
    paths: bool = False, face_errors: bool = False, save_vdb: Union[str, os.PathLike, None] = None,
    threads: int = 0, max_memory: Union[int, str, None] = None, progress: Progress = None
) -> Check: ...

def check_curves(
    points: np.ndarray, curves: Faces, positions: np.ndarray, distance: Optional[Distance] = None, *,
    corners: Optional[Literal['miter', 'round', 'arc']] = None, miter_limit: Optional[float] = None,
    collision: Literal['limit', 'merge'] = 'limit', close: bool = False,
    precision: Union[Literal['double', 'single'], int] = 'double', voxel_size: Union[float, str, None] = None,
    voxels_per_distance: Optional[float] = None, unit: Optional[Literal['um', 'mm', 'cm', 'm', 'in', 'ft']] = None,
    paths: bool = False, save_vdb: Union[str, os.PathLike, None] = None, threads: int = 0,
    max_memory: Union[int, str, None] = None, progress: Progress = None
) -> Check: ...
