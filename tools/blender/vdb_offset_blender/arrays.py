# SPDX-License-Identifier: Apache-2.0
"""What Blender holds, as arrays and back."""

import numpy as np


def positions(mesh):
    """(n, 3) floats: where the vertices are without any other shape key."""
    source = mesh.shape_keys.reference_key.data if mesh.shape_keys else mesh.vertices
    numbers = np.empty(3 * len(source), np.float32)
    source.foreach_get("co", numbers)
    return numbers.reshape(-1, 3)


def faces(mesh):
    """(m + 1,) offsets, and the corners that they divide: the vertices of each face in turn."""
    begins, sizes = (np.empty(len(mesh.polygons), np.int32) for _ in range(2))
    mesh.polygons.foreach_get("loop_start", begins)
    mesh.polygons.foreach_get("loop_total", sizes)
    corners = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    offsets = np.zeros(len(sizes) + 1, np.int64)
    np.cumsum(sizes, out=offsets[1:])
    if not np.array_equal(begins, offsets[:-1]):  # the corners of faces may lie in another order than the faces
        corners = corners[np.repeat(begins - offsets[:-1], sizes) + np.arange(offsets[-1])]
    return offsets.astype(np.uint32), corners.astype(np.uint32)


def turned(some):
    """The faces, each the other way round."""
    offsets, corners = some
    # All corners backward are the faces backward, and those in their order again are the blocks swapped back.
    sizes = np.diff(offsets.astype(np.int64))
    last = offsets[1:].astype(np.int64) - 1
    index = np.repeat(last + offsets[:-1], sizes) - np.arange(len(corners))
    return offsets, np.ascontiguousarray(corners[index])


def selected_faces(mesh):
    """(m,) booleans."""
    marks = np.empty(len(mesh.polygons), bool)
    mesh.polygons.foreach_get("select", marks)
    return marks


def weights(mesh, index):
    """(n,) weights of the vertices in the vertex group of this number, 0 of those that are not in it.

    Blender hands them out one by one alone, which takes a second for a million.
    """
    numbers = np.zeros(len(mesh.vertices))
    found = [(v.index, each.weight) for v in mesh.vertices for each in v.groups if each.group == index]
    if found:
        at, values = zip(*found)
        numbers[list(at)] = values
    return numbers


def add_shape_key(thing, moved):
    """A new shape key, in full effect and active; the other ones stay."""
    if not thing.data.shape_keys:
        thing.shape_key_add(name="Basis", from_mix=False)
    key = thing.shape_key_add(name="Offset", from_mix=False)
    key.data.foreach_set("co", moved.ravel())
    key.relative_key = thing.data.shape_keys.reference_key
    key.value = 1
    thing.active_shape_key_index = len(thing.data.shape_keys.key_blocks) - 1
    thing.data.update()


def add_object(context, thing, moved):
    """A copy of the object, with its vertices moved and without shape keys, which is then active and alone selected."""
    mesh = thing.data.copy()
    mesh.name = f"{thing.data.name} offset"
    made = thing.copy()
    made.name, made.data = f"{thing.name} offset", mesh
    if mesh.shape_keys:
        made.shape_key_clear()
    mesh.vertices.foreach_set("co", moved.ravel())
    mesh.update()
    for collection in thing.users_collection:
        collection.objects.link(made)
    for other in context.selected_objects:
        other.select_set(False)
    made.select_set(True)
    context.view_layer.objects.active = made
    return made
