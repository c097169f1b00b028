# SPDX-License-Identifier: Apache-2.0
# Made by scripts/python_stubs.
import os
from typing import Any, List, Literal, Optional, Sequence, Tuple, Union

import numpy as np

from ._options import Distance, Faces, Progress, Reserve
from ._results import Block, Check, Iso, IsoShell, Layers, Offset, Refined, Shell

def arrays_of(
    mesh: Any
) -> Tuple[np.ndarray, Faces]: ...

def with_positions(
    mesh: Any, positions: np.ndarray
) -> Any: ...

def offset_mesh(
    mesh: Any, distance: Distance, *, distance_z: Union[float, str, None] = None,
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
) -> Tuple[Any, Offset]: ...
