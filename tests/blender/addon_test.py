# SPDX-License-Identifier: Apache-2.0
"""The add-on beside the Python package, run by Blender: see `run`."""
import os
import sys
import tempfile
import unittest
import unittest.mock

import bpy
import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
PACKAGE = sys.argv[sys.argv.index("--") + 1]
sys.path[:0] = [PACKAGE, os.path.join(HERE, "..", "..", "tools", "blender")]
try:
    import vdb_offset
except ImportError as error:
    print(f"left out: {error}")
    sys.stdout.flush()
    os._exit(77)  # Blender has exit codes of its own
import vdb_offset_blender  # noqa: E402


def of(collection, name, count, kind):
    numbers = np.empty(count, kind)
    collection.foreach_get(name, numbers)
    return numbers


def positions(mesh):
    return of(mesh.vertices, "co", 3 * len(mesh.vertices), np.float32).reshape(-1, 3)


def key_positions(thing, name):
    return of(thing.data.shape_keys.key_blocks[name].data, "co", 3 * len(thing.data.vertices), np.float32).reshape(-1, 3)


def faces(mesh):
    sizes = of(mesh.polygons, "loop_total", len(mesh.polygons), np.int32)
    return np.concatenate([[0], np.cumsum(sizes)]), of(mesh.loops, "vertex_index", len(mesh.loops), np.int32)


def beside_positions(thing):
    """All that has to stay as it is."""
    mesh = thing.data
    return {
        "uv": of(mesh.uv_layers[0].data, "uv", 2 * len(mesh.loops), np.float32).tobytes(),
        "materials": of(mesh.polygons, "material_index", len(mesh.polygons), np.int32).tobytes(),
        "names": [each.name for each in mesh.materials],
        "weights": [[(each.group, each.weight) for each in v.groups] for v in mesh.vertices],
        "groups": [each.name for each in thing.vertex_groups],
        "seams": of(mesh.edges, "use_seam", len(mesh.edges), bool).tobytes(),
        "edges": of(mesh.edges, "vertices", 2 * len(mesh.edges), np.int32).tobytes(),
        "faces": [each.tobytes() for each in faces(mesh)],
        "marks": of(mesh.attributes["mark"].data, "value", len(mesh.vertices), np.int32).tobytes(),
    }


def offset(**options):
    return bpy.ops.mesh.vdb_offset(**options)


class Addon(unittest.TestCase):
    def setUp(self):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        vdb_offset_blender.register()
        self.addCleanup(vdb_offset_blender.unregister)

    def made(self, shape="monkey", cuts=0):
        """A shape with all that a mesh may have beside its positions."""
        add = {"monkey": bpy.ops.mesh.primitive_monkey_add, "cube": bpy.ops.mesh.primitive_cube_add}[shape]
        add(calc_uvs=True)
        thing = bpy.context.object
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        if cuts:
            bpy.ops.mesh.subdivide(number_cuts=cuts)
        bpy.ops.object.mode_set(mode="OBJECT")
        mesh = thing.data
        for name in ("red", "green"):
            mesh.materials.append(bpy.data.materials.new(name))
        mesh.polygons.foreach_set("material_index", np.arange(len(mesh.polygons), dtype=np.int32) % 2)
        mesh.edges.foreach_set("use_seam", np.arange(len(mesh.edges)) % 3 == 0)
        mesh.attributes.new("mark", "INT", "POINT").data.foreach_set("value", np.arange(len(mesh.vertices), dtype=np.int32))
        group, other = thing.vertex_groups.new(name="other"), thing.vertex_groups.new(name="it's ü")
        group.add(list(range(0, len(mesh.vertices), 2)), 0.3, "REPLACE")
        for v in range(0, len(mesh.vertices), 3):
            other.add([v], v / len(mesh.vertices), "REPLACE")
        return thing

    def refused(self, text, **options):
        """An error of one line, and nothing has changed."""
        thing = bpy.context.object
        objects, meshes, trees = len(bpy.data.objects), len(bpy.data.meshes), len(bpy.data.node_groups)
        before, keys = positions(thing.data), thing.data.shape_keys
        with self.assertRaises(RuntimeError) as caught:
            offset(**options)
        self.assertRegex(str(caught.exception), text)
        self.assertNotIn("Traceback", str(caught.exception))
        self.assertEqual(len(str(caught.exception).strip().splitlines()), 1, str(caught.exception))
        self.assertEqual((objects, meshes, trees), (len(bpy.data.objects), len(bpy.data.meshes), len(bpy.data.node_groups)))
        self.assertTrue((positions(thing.data) == before).all())
        self.assertEqual(thing.data.shape_keys, keys)

    def test_a_shape_key_has_what_the_package_gives_and_all_else_stays(self):
        for shape, cuts in (("cube", 3), ("monkey", 0)):
            for corners in ("round", "miter"):
                with self.subTest(shape=shape, corners=corners):
                    thing = self.made(shape, cuts)
                    before, source = beside_positions(thing), positions(thing.data)
                    expected = vdb_offset.offset(source.astype(float), faces(thing.data), np.float32(0.05), corners=corners,
                                                 precision="single")
                    self.assertEqual(offset(distance=0.05, corners=corners), {"FINISHED"})
                    self.assertEqual([each.name for each in thing.data.shape_keys.key_blocks], ["Basis", "Offset"])
                    self.assertEqual(key_positions(thing, "Offset").tobytes(), expected.positions.astype(np.float32).tobytes())
                    self.assertTrue((key_positions(thing, "Basis") == source).all())
                    self.assertFalse((key_positions(thing, "Offset") == source).all())
                    self.assertEqual(thing.data.shape_keys.key_blocks["Offset"].value, 1)
                    self.assertEqual(thing.active_shape_key.name, "Offset")
                    self.assertEqual(beside_positions(thing), before)

    def test_other_shape_keys_stay_and_the_basis_is_offset(self):
        thing = self.made("cube")
        source = positions(thing.data)
        thing.shape_key_add(name="Basis")
        smile = thing.shape_key_add(name="Smile")
        smile.data[0].co.z += 1
        smile.value = 0.5
        before = key_positions(thing, "Smile")
        offset(distance=0.1)
        offset(distance=0.2)
        self.assertEqual([each.name for each in thing.data.shape_keys.key_blocks], ["Basis", "Smile", "Offset", "Offset.001"])
        self.assertTrue((key_positions(thing, "Smile") == before).all())
        self.assertEqual(smile.value, 0.5)
        expected = vdb_offset.offset(source.astype(float), faces(thing.data), np.float32(0.2), precision="single").positions
        self.assertTrue((key_positions(thing, "Offset.001") == expected.astype(np.float32)).all())

    def test_a_new_object_is_a_copy_that_moved(self):
        thing = self.made("monkey")
        source, before = positions(thing.data), beside_positions(thing)
        thing.location, thing.scale = (1, 2, 3), (2, 2, 2)
        thing.shape_key_add(name="Basis")
        bpy.context.view_layer.update()
        offset(distance=0.1, result="OBJECT")
        made = bpy.context.object
        self.assertNotEqual(made, thing)
        self.assertEqual(bpy.context.selected_objects, [made])
        self.assertEqual(beside_positions(made), before)
        self.assertEqual((positions(thing.data) == source).all(), True)
        self.assertIsNone(made.data.shape_keys)
        self.assertIsNotNone(thing.data.shape_keys)
        # Scaled alike, the mesh is offset by half of it.
        expected = vdb_offset.offset(source.astype(float), faces(thing.data), np.float32(0.1) / 2.0, precision="single").positions
        self.assertTrue((positions(made.data) == expected.astype(np.float32)).all())
        self.assertEqual(made.matrix_world, thing.matrix_world)

    def test_weights_tell_the_distance(self):
        thing = self.made("monkey")
        before = beside_positions(thing)
        weights = np.zeros(len(thing.data.vertices))
        weights[::3] = np.arange(0, len(weights), 3) / len(weights)
        low, high = np.float32(0.01), np.float32(0.04)
        expected = vdb_offset.offset(positions(thing.data).astype(float), faces(thing.data),
                                     float(low) + weights.astype(np.float32).astype(float) * (float(high) - float(low)), precision="single")
        offset(distance=0.04, distance_at_zero=0.01, vertex_group="it's ü")
        self.assertTrue((key_positions(thing, "Offset") == expected.positions.astype(np.float32)).all())
        self.assertEqual(beside_positions(thing), before)
        self.assertEqual(len(bpy.data.objects), 1)
        self.assertEqual(len(bpy.data.node_groups), 0)

    def test_distances_are_those_of_the_scene(self):
        for scale in ((3, 3, 3), (1, 2, 0.5), (-1, 2, 0.5), (-2, -2, -2)):
            with self.subTest(scale=scale):
                thing = self.made("cube", 2)
                thing.scale, thing.rotation_euler, thing.location = scale, (0.3, 0.2, 0.1), (5, 6, 7)
                bpy.context.view_layer.update()
                before = beside_positions(thing)
                offset(distance=0.1, corners="miter")
                # A box: each of its sides has moved by 0.1.
                size = np.ptp(key_positions(thing, "Offset"), axis=0) * np.abs(scale)
                np.testing.assert_allclose(size, 2 * np.abs(scale) + 0.2, atol=2e-6)
                self.assertEqual(beside_positions(thing), before)

    def test_polygons_and_what_is_loose_are_kept(self):
        mesh = bpy.data.meshes.new("odd")
        ring = [(np.cos(a), np.sin(a), 0) for a in np.arange(7) * 2 * np.pi / 7]
        mesh.from_pydata([*ring, (0, 0, 2), (9, 9, 9), (9, 9, 8), (7, 7, 7)], [(8, 9)],
                         [list(range(6, -1, -1)), *[(i, (i + 1) % 7, 7) for i in range(7)]])
        thing = bpy.data.objects.new("odd", mesh)
        bpy.context.scene.collection.objects.link(thing)
        bpy.context.view_layer.objects.active = thing
        edges = of(mesh.edges, "vertices", 2 * len(mesh.edges), np.int32)
        self.assertEqual(offset(distance=0.1, corners="miter"), {"FINISHED"})
        moved = key_positions(thing, "Offset")
        self.assertTrue((moved[8:] == positions(mesh)[8:]).all())
        np.testing.assert_allclose(moved[:7, 2], -0.1, atol=1e-6)
        self.assertTrue((of(mesh.edges, "vertices", 2 * len(mesh.edges), np.int32) == edges).all())

    def test_edit_mode_sees_what_is_edited_and_goes_on(self):
        self.made("cube")
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.transform.translate(value=(0, 0, 3))
        self.assertEqual(offset(distance=0.5, corners="miter"), {"FINISHED"})
        self.assertEqual(bpy.context.mode, "EDIT_MESH")
        bpy.ops.object.mode_set(mode="OBJECT")
        self.assertEqual(key_positions(bpy.context.object, "Offset")[:, 2].max(), 4.5)
        self.assertEqual(key_positions(bpy.context.object, "Basis")[:, 2].max(), 4)

    def test_only_selected_faces(self):
        thing = self.made("cube", 3)
        top = np.array([each.normal.z > 0.5 for each in thing.data.polygons])
        thing.data.polygons.foreach_set("select", top)
        offset(distance=0.25, only_selected=True)
        moved, source = key_positions(thing, "Offset"), positions(thing.data)
        self.assertAlmostEqual(moved[:, 2].max(), 1.25, 6)
        self.assertTrue((moved[source[:, 2] < 1] == source[source[:, 2] < 1]).all())

    def test_what_cannot_be_done_is_refused_and_changes_nothing(self):
        thing = self.made("cube", 1)
        self.refused("no vertex group 'none'", vertex_group="none")
        self.refused("No vertex reached its distance", distance=-5)
        self.refused("finite|expected", distance=float("nan"))
        thing.scale = (1, 0, 1)
        bpy.context.view_layer.update()
        self.refused("scale is 0")
        bpy.ops.object.mode_set(mode="EDIT")
        self.refused("scale is 0")
        self.assertEqual(bpy.context.mode, "EDIT_MESH")
        bpy.ops.object.mode_set(mode="OBJECT")
        empty = bpy.data.objects.new("empty", bpy.data.meshes.new("empty"))
        bpy.context.scene.collection.objects.link(empty)
        bpy.context.view_layer.objects.active = empty
        self.refused("expected")

    def test_meshes_that_are_not_there_to_be_changed(self):
        self.made("cube")
        bpy.ops.object.mode_set(mode="SCULPT")
        bpy.ops.sculpt.dynamic_topology_toggle()
        self.refused("dynamic topology")
        self.assertEqual(bpy.context.mode, "SCULPT")
        bpy.ops.object.mode_set(mode="OBJECT")
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "other.blend")
            bpy.ops.wm.save_as_mainfile(filepath=path, copy=True)
            bpy.ops.wm.read_factory_settings(use_empty=True)
            with bpy.data.libraries.load(path, link=True) as (there, here):
                here.objects = there.objects
            [thing] = here.objects
            bpy.context.scene.collection.objects.link(thing)
            bpy.context.view_layer.objects.active = thing
            self.refused("linked from another file")
            self.assertEqual(offset(distance=0.1, result="OBJECT"), {"FINISHED"})
            self.assertIsNone(bpy.context.object.data.library)

    def test_without_a_mesh_it_is_not_offered(self):
        bpy.ops.object.light_add()
        with self.assertRaisesRegex(RuntimeError, "The active object is not a mesh"):
            offset()
        bpy.ops.object.delete()
        self.assertFalse(bpy.ops.mesh.vdb_offset.poll())

    def test_without_the_package_it_says_what_to_install(self):
        self.made("cube")
        kept = sys.modules["vdb_offset"]
        sys.modules["vdb_offset"] = None  # an import of it fails
        try:
            self.refused("install python3-vdb-offset")
        finally:
            sys.modules["vdb_offset"] = kept

    def test_all_that_can_be_chosen_is_shown(self):
        self.made("cube")
        shown = unittest.mock.MagicMock(vertex_group="it's ü", corners="miter")
        operator = vdb_offset_blender.offset_operator.MESH_OT_vdb_offset
        operator.draw(shown, bpy.context)
        calls = [*shown.layout.prop.call_args_list, *shown.layout.prop_search.call_args_list]
        self.assertEqual({each.args[1] for each in calls}, set(operator.__annotations__))

        for draw in (vdb_offset_blender.panel.VIEW3D_PT_vdb_offset.draw, vdb_offset_blender.panel.menu_entry):
            place = unittest.mock.MagicMock()
            draw(place, bpy.context)
            layout = place.layout.column() if place.layout.column.called else place.layout
            self.assertIn("mesh.vdb_offset", [each.args[0] for each in layout.operator.call_args_list])

    def test_undo(self):
        self.made("cube")
        name = bpy.context.object.name
        bpy.ops.ed.undo_push(message="before")
        offset(distance=0.1)
        bpy.ops.ed.undo_push(message="after")
        self.assertIsNotNone(bpy.data.objects[name].data.shape_keys)
        bpy.ops.ed.undo()
        self.assertIsNone(bpy.data.objects[name].data.shape_keys)
        bpy.ops.ed.redo()
        self.assertEqual(len(bpy.data.objects[name].data.shape_keys.key_blocks), 2)


if __name__ == "__main__":
    done = unittest.main(argv=["addon_test"], exit=False, verbosity=1).result
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0 if done.wasSuccessful() and done.testsRun > 0 else 1)
