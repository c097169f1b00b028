# SPDX-License-Identifier: Apache-2.0
"""Where the operator is found: the sidebar, and the Object and Mesh menus. Its options are asked for once it has run."""

import bpy

from . import distances
from .offset_operator import MESH_OT_vdb_offset


class VIEW3D_PT_vdb_offset(bpy.types.Panel):
    bl_label = "VDB Offset"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Offset"

    def draw(self, context):
        layout = self.layout
        if distances.package() is None:
            layout.label(text="Install python3-vdb-offset", icon="ERROR")
        column = layout.column(align=True)
        column.operator(MESH_OT_vdb_offset.bl_idname, text="Into a Shape Key", icon="SHAPEKEY_DATA").result = "KEY"
        column.operator(MESH_OT_vdb_offset.bl_idname, text="Into a New Object", icon="MESH_DATA").result = "OBJECT"


def menu_entry(self, context):
    self.layout.separator()
    self.layout.operator(MESH_OT_vdb_offset.bl_idname)
