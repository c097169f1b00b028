# SPDX-License-Identifier: Apache-2.0
"""Makes docs/pictures/blender.png, by the add-on:

blender --background --factory-startup --python tools/blender/picture.py -- FOLDER_OF_THE_PYTHON_PACKAGE docs/pictures/blender.png
"""
import math
import os
import sys

import bpy
import numpy as np

PACKAGE, PICTURE = sys.argv[sys.argv.index("--") + 1:]
sys.path[:0] = [PACKAGE, os.path.dirname(os.path.abspath(__file__))]
import vdb_offset_blender  # noqa: E402


def checked():
    """Squares by texture coordinates."""
    material = bpy.data.materials.new("checked")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    squares, place = nodes.new("ShaderNodeTexChecker"), nodes.new("ShaderNodeUVMap")
    squares.inputs["Color1"].default_value, squares.inputs["Color2"].default_value = (0.8, 0.45, 0.15, 1), (0.05, 0.16, 0.4, 1)
    squares.inputs["Scale"].default_value = 32
    shown = nodes["Principled BSDF"]
    shown.inputs["Roughness"].default_value = 0.6
    links.new(squares.inputs["Vector"], place.outputs[0])
    links.new(shown.inputs["Base Color"], squares.outputs["Color"])
    return material


def knot(x):
    """A ring that winds and swells, as a grid with texture coordinates, and a group with weights from bottom to top."""
    around, across = 360, 64
    u, v = np.meshgrid(np.arange(around) / around, np.arange(across) / across, indexing="ij")
    a, b = 2 * np.pi * u, 2 * np.pi * v
    thick = 0.24 + 0.05 * np.cos(5 * a)
    ring = 0.85 + thick * np.cos(b)
    points = np.stack([ring * np.cos(a), thick * np.sin(b) + 0.25 * np.sin(3 * a), ring * np.sin(a)], -1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    corners = [((i + k) % around, (j + l) % across) for k, l in ((0, 0), (0, 1), (1, 1), (1, 0))]
    mesh = bpy.data.meshes.new("knot")
    mesh.from_pydata(points, [], np.stack([p * across + q for p, q in corners], -1).reshape(-1, 4).tolist())
    places = np.stack([[(i + k) / around, (j + l) / across / 4] for k, l in ((0, 0), (0, 1), (1, 1), (1, 0))], 0)
    mesh.uv_layers.new().data.foreach_set("uv", places.transpose(2, 3, 0, 1).astype(np.float32).ravel())
    mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), bool))
    mesh.materials.append(checked())
    thing = bpy.data.objects.new("knot", mesh)
    thing.location.x = x
    bpy.context.scene.collection.objects.link(thing)
    bpy.context.view_layer.objects.active = thing
    group = thing.vertex_groups.new(name="top")
    for number, z in enumerate(points[:, 2]):
        group.add([number], min(max((z + 1.1) / 2.2, 0), 1), "REPLACE")
    bpy.context.view_layer.update()


bpy.ops.wm.read_factory_settings(use_empty=True)
vdb_offset_blender.register()
for x, options in ((-2.7, None), (0, {"distance": 0.12}), (2.7, {"distance": 0.2, "distance_at_zero": -0.1, "vertex_group": "top"})):
    knot(x)
    if options:
        bpy.ops.mesh.vdb_offset(**options)

scene = bpy.context.scene
for place, energy in (((-4, -6, 6), 500), ((6, -5, 2), 200)):
    lamp = bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "AREA"))
    lamp.data.energy, lamp.data.size, lamp.location = energy, 4, place
    lamp.rotation_euler = (math.radians(50), 0, math.radians(-35 if place[0] < 0 else 50))
    scene.collection.objects.link(lamp)
scene.world = bpy.data.worlds.new("world")
scene.world.use_nodes = True
scene.world.node_tree.nodes["Background"].inputs[0].default_value = (1, 1, 1, 1)
scene.world.node_tree.nodes["Background"].inputs[1].default_value = 0.6
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
camera.location, camera.rotation_euler = (0, -12, 0), (math.radians(90), 0, 0)
camera.data.type, camera.data.ortho_scale = "ORTHO", 8.2
scene.collection.objects.link(camera)
scene.camera = camera
scene.render.engine, scene.cycles.device, scene.cycles.samples, scene.cycles.use_denoising = "CYCLES", "CPU", 128, False
scene.view_settings.view_transform = "Standard"
scene.render.film_transparent = True
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 900, 324, 100
scene.render.image_settings.color_mode, scene.render.image_settings.compression = "RGBA", 100
scene.render.filepath = os.path.abspath(PICTURE)
bpy.ops.render.render(write_still=True)
