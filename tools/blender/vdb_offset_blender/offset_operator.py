# SPDX-License-Identifier: Apache-2.0
"""The operator: what it asks for, and what it reports."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, StringProperty

from . import arrays, distances


class MESH_OT_vdb_offset(bpy.types.Operator):
    """Offset the mesh by a distance. Vertices, faces, UVs, materials and groups stay as they are"""

    bl_idname = "mesh.vdb_offset"
    bl_label = "Offset (VDB)"
    bl_options = {"REGISTER", "UNDO"}

    distance: FloatProperty(name="Distance", description="How far outward; below 0 inward", default=0.1, unit="LENGTH",
                            soft_min=-10, soft_max=10, precision=4)
    result: EnumProperty(name="Result", default="KEY", items=[
        ("KEY", "Shape Key", "A new shape key of this mesh, in full effect"),
        ("OBJECT", "New Object", "A copy of the object, with its vertices moved")])
    vertex_group: StringProperty(name="Vertex Group", description="Its weights give the distance of each vertex: Distance at weight 1, "
                                 "At Weight 0 at weight 0, in proportion between")
    distance_at_zero: FloatProperty(name="At Weight 0", description="Distance of vertices that have weight 0 or are outside the group",
                                    default=0, unit="LENGTH", soft_min=-10, soft_max=10, precision=4)
    corners: EnumProperty(name="Corners", default="miter", items=[
        ("miter", "Miter", "Faces are at the distance; vertices on sharp edges are farther away"),
        ("round", "Round", "Vertices are at the distance; flat faces at sharp edges are nearer")])
    miter_limit: FloatProperty(name="Miter Limit", description="No vertex goes farther than this many distances", default=4, min=1,
                               soft_max=10)
    collision: EnumProperty(name="Narrow Places", default="limit", items=[
        ("limit", "Stay Valid", "Vertices are held back where faces would fold or cross"),
        ("merge", "Merge", "Each vertex goes as far as the distance grows; faces may fold or cross")])
    only_selected: BoolProperty(name="Selected Faces Only", description="The other faces stay, and act as obstacles", default=False)

    @classmethod
    def poll(cls, context):
        if context.object is not None and context.object.type == "MESH":
            return True
        cls.poll_message_set("The active object is not a mesh")
        return False

    def execute(self, context):
        thing, was_edited = context.object, context.object.mode == "EDIT"
        if was_edited:  # what is edited is a copy, which would be written over the mesh at the end
            bpy.ops.object.mode_set(mode="OBJECT")
        try:
            words, is_whole = self.offset(context, thing)
        except distances.Refused as refused:
            self.report({"ERROR"}, str(refused))
            return {"CANCELLED"}
        finally:
            if was_edited and context.object == thing:
                bpy.ops.object.mode_set(mode="EDIT")
        self.report({"INFO"} if is_whole else {"WARNING"}, words)
        return {"FINISHED"}

    def offset(self, context, thing):
        mesh = thing.data
        if thing.use_dynamic_topology_sculpting:
            raise distances.Refused("The mesh is being sculpted with dynamic topology: leave sculpt mode first")
        if self.result == "KEY" and (thing.library or mesh.library or mesh.override_library):
            raise distances.Refused("The mesh is linked from another file: choose New Object as the result")
        options = {"corners": self.corners, "collision": self.collision}
        if self.corners == "miter":
            options["miter_limit"] = self.miter_limit
        if self.only_selected:
            options["only"] = arrays.selected_faces(mesh)
        # No progress: the package tells it on a thread of its own, where Blender must not draw.
        window = context.window
        if window:
            window.cursor_modal_set("WAIT")
        try:
            moved, result = distances.offset(thing, self.distance_of(thing), **options)
        finally:
            if window:
                window.cursor_modal_restore()
        if self.result == "KEY":
            arrays.add_shape_key(thing, moved)
        else:
            arrays.add_object(context, thing, moved)
        return distances.summary_of(result)

    def distance_of(self, thing):
        """A number, or an array with one for each vertex."""
        if not self.vertex_group:
            return self.distance
        if self.vertex_group not in thing.vertex_groups:
            raise distances.Refused(f"The object has no vertex group '{self.vertex_group}'")
        weights = arrays.weights(thing.data, thing.vertex_groups[self.vertex_group].index)
        return self.distance_at_zero + weights * (self.distance - self.distance_at_zero)

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "distance")
        layout.prop(self, "result")
        layout.prop_search(self, "vertex_group", context.object, "vertex_groups")
        if self.vertex_group:
            layout.prop(self, "distance_at_zero")
        layout.prop(self, "corners")
        if self.corners == "miter":
            layout.prop(self, "miter_limit")
        layout.prop(self, "collision")
        layout.prop(self, "only_selected")
