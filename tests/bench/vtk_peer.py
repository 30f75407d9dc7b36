#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The scenes of paper_bench drawn by VTK: prints one JSON line, {"value", "p95", "cpu", "triangles", "coverage", "frames"}; milliseconds.

usage: xvfb-run -a tests/bench/vtk_peer.py SCENE.json BARE_FOLDER

SCENE.json is what paper_bench wrote: cameras, places, size. BARE_FOLDER holds the model prepared without sensors: the triangles that
the model came with, fewer than ours, which are split where the field bends. As a VTK user would: one vtkPolyData per instance that
shares points and triangles, a scalar per vertex that is looked up in a colour map after interpolation, physically based shading, one
light, no multisampling, off screen, no waiting for the display. Scalars are worked out beforehand (inverse distance to as many points
as the scene has sensors) and swapped ten times a second: what that takes is not counted. A frame is Render() and the pixels read back, as with us."""

import glob
import json
import struct
import sys
import time

import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy

SECONDS, MOST_FRAMES, SETS = 3.0, 96, 3
VERSION, SECTIONS, POSITIONS, INDICES, PRIMITIVES, LEVELS = 6, 15, 0, 5, 6, 7  # protocol/ASSET.md


def read_asset(folder):
    with open(glob.glob(folder + "/plant.prepared/*.asset")[0], "rb") as f:
        data = f.read()
    version = struct.unpack_from("<I", data, 8)[0]
    if version != VERSION:
        sys.exit("asset file of version %d: this program reads %d" % (version, VERSION))
    section = [struct.unpack_from("<QQ", data, 120 + 16 * i) for i in range(SECTIONS)]
    positions = numpy.frombuffer(data, "<f4", section[POSITIONS][1] // 4, section[POSITIONS][0]).reshape(-1, 3)
    first, count = struct.unpack_from("<II", data, section[LEVELS][0])
    runs = [struct.unpack_from("<II", data, section[PRIMITIVES][0] + 16 * (first + i)) for i in range(count)]
    indices = numpy.frombuffer(data, "<u4", section[INDICES][1] // 4, section[INDICES][0])
    return positions, numpy.concatenate([indices[at:at + n] for at, n in runs]).reshape(-1, 3)


def make_scalars(positions, sensors, random):
    total, weights = numpy.zeros(len(positions)), numpy.zeros(len(positions))
    for place in positions[random.integers(0, len(positions), sensors)]: # one by one: all at once take gigabytes
        weight = 1 / (((positions - place) ** 2).sum(axis=1) + 1e-9)
        total += weight * 100 * random.random()
        weights += weight
    return (total / weights).astype("f4")


def make_window(scene, positions, triangles):
    window, renderer = vtk.vtkRenderWindow(), vtk.vtkRenderer()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(scene["width"], scene["height"])
    window.AddRenderer(renderer)
    renderer.SetBackground(0.9, 0.9, 0.9)
    points, cells = vtk.vtkPoints(), vtk.vtkCellArray()
    points.SetData(numpy_to_vtk(positions, deep=True))
    cells.SetData(3, numpy_to_vtkIdTypeArray(triangles.astype("i8").ravel(), deep=True))
    normals = vtk.vtkPolyDataNormals()
    shape = vtk.vtkPolyData()
    shape.SetPoints(points)
    shape.SetPolys(cells)
    normals.SetInputData(shape)
    normals.SplittingOff()
    normals.Update()
    random = numpy.random.default_rng(1)
    sets, meshes = [numpy_to_vtk(make_scalars(positions, scene["sensors"], random), deep=True) for _ in range(SETS + 2)], []
    for place in scene["places"]:
        mesh, mapper, actor = vtk.vtkPolyData(), vtk.vtkPolyDataMapper(), vtk.vtkActor()
        mesh.ShallowCopy(normals.GetOutput())
        mapper.SetInputData(mesh)
        mapper.SetScalarRange(0, 100)
        mapper.InterpolateScalarsBeforeMappingOn()
        mapper.StaticOn()
        actor.SetMapper(mapper)
        actor.SetPosition(place)
        actor.GetProperty().SetInterpolationToPBR()
        renderer.AddActor(actor)
        meshes.append(mesh)
    return window, renderer, meshes, sets


def change(meshes, sets, turn):
    for i, mesh in enumerate(meshes):
        mesh.GetPointData().SetScalars(sets[(i + turn) % len(sets)])
        mesh.Modified()


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    with open(sys.argv[1]) as f:
        scene = json.load(f)
    positions, triangles = read_asset(sys.argv[2])
    window, renderer, meshes, sets = make_window(scene, positions, triangles)
    camera, pixels = renderer.GetActiveCamera(), vtk.vtkUnsignedCharArray()
    camera.SetViewUp(0, 0, 1)
    camera.SetViewAngle(scene["fov"])
    times, work, began, changed, turn = [], [], 0, 0, 0
    change(meshes, sets, 0)
    for number in range(-1, MOST_FRAMES):
        now = time.monotonic()
        began = now if number == 0 else began
        if number >= 2 and now - began > SECONDS:
            break
        if now - changed >= 0.1:
            changed, turn = now, turn + 1
            change(meshes, sets, turn)
        eye = scene["cameras"][number % len(scene["cameras"])]
        start, worked = time.monotonic(), time.process_time()
        camera.SetPosition(eye[:3])
        camera.SetFocalPoint(eye[3:])
        renderer.ResetCameraClippingRange()
        window.Render()
        window.GetPixelData(0, 0, scene["width"] - 1, scene["height"] - 1, 0, pixels, 0)
        if number >= 0:
            times.append(1e3 * (time.monotonic() - start))
            work.append(1e3 * (time.process_time() - worked))
    covered = (vtk_to_numpy(pixels).reshape(-1, 3) != vtk_to_numpy(pixels).reshape(-1, 3)[0]).any(axis=1).mean()
    if not covered:
        sys.exit("VTK drew nothing: its times say nothing")
    times.sort()
    print(json.dumps({"value": round(times[len(times) // 2], 2), "p95": round(times[len(times) * 95 // 100], 2),
                      "cpu": round(sorted(work)[len(work) // 2], 2), "triangles": len(triangles) * len(meshes),
                      "coverage": round(float(covered), 2), "frames": len(times), "tier": "VTK " + vtk.VTK_VERSION}))


main()
