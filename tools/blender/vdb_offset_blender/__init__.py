# SPDX-License-Identifier: Apache-2.0
"""Offsets the active mesh by a distance, into a shape key or a new object; see docs/blender.md of vdb_offset."""

import bpy

from . import offset_operator, panel

bl_info = {
    "name": "VDB Offset",
    "author": "The authors of vdb_offset",
    "version": (0, 2, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > Offset; Object and Mesh menus",
    "description": "Offset a mesh by an exact distance, without folds or crossings; vertices, faces, UVs and groups stay",
    "category": "Mesh",
}

_CLASSES = (offset_operator.MESH_OT_vdb_offset, panel.VIEW3D_PT_vdb_offset)
_MENUS = ("VIEW3D_MT_object", "VIEW3D_MT_edit_mesh")


def register():
    for each in _CLASSES:
        bpy.utils.register_class(each)
    for name in _MENUS:
        getattr(bpy.types, name).append(panel.menu_entry)


def unregister():
    for name in _MENUS:
        getattr(bpy.types, name).remove(panel.menu_entry)
    for each in reversed(_CLASSES):
        bpy.utils.unregister_class(each)
