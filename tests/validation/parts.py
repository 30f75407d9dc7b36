# SPDX-License-Identifier: GPL-3.0-or-later
"""Steady heat conduction in the parts of parts/*.geo: meshed by gmsh, solved by CalculiX with linear tetrahedra.

A part says, for each face of its skin, what it exchanges heat with, and for each node, which temperature it is held at. Lengths in m,
conductivity in W/(m K), film coefficients in W/(m^2 K), temperatures in degrees Celsius."""

import math
import os
import struct
import subprocess

FACES = ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0))  # of CalculiX's C3D4: F1 to F4


class Part:
    """name; title; size_m: of the elements; conductivity; film(point): (h, T) of a face's centre, None: insulated; held(point): a
    temperature or None; outside(point): can be seen and have sensors; seed: the sensor next to this point is the first; fin: what the
    plant file tells `fin` (thickness_m, heat_transfer, ambient); told: the same by somebody who knows what is inside, or None; low, high: the
    group's range; view: options of the pictures."""

    def __init__(self, name, title, size_m, conductivity, film, held, outside, seed, fin, disc_m, low, high, view, told=None):
        self.name, self.title, self.size_m, self.conductivity = name, title, size_m, conductivity
        self.film, self.held, self.outside, self.seed, self.fin, self.disc_m = film, held, outside, seed, fin, disc_m
        self.low, self.high, self.view, self.told = low, high, view, told


def vessel_radius(p):
    """Distance from the vessel's middle line."""
    return math.hypot(max(abs(p[0]) - 0.6, 0), p[1], p[2])


def vessel_film(p):
    if vessel_radius(p) > 0.392:
        return 12, 20
    return (200, 400) if math.dist(p, (0.2, -0.384 * math.cos(0.5), 0.384 * math.sin(0.5))) < 0.15 else (5, 400)


def finned_film(p):
    radius = math.hypot(p[1], p[2])
    if radius < 0.0425:
        return 300, 180 - 120 * p[0] / 0.6
    return None if p[0] < 1e-6 or p[0] > 0.6 - 1e-6 else (25, 20)


def bent_radius(p):
    """Distance from the bent pipe's middle line."""
    if p[1] < 0:
        return math.hypot(abs(p[0]) - 0.1, p[2])
    return math.hypot(math.hypot(p[0], p[1]) - 0.1, p[2])


def bent_film(p):
    return (10, 20) if bent_radius(p) > 0.047 and p[1] > -0.8 + 1e-6 else None


def bent_held(p):
    return None if p[1] > -0.8 + 1e-6 else 200 if p[0] > 0 else 60


def flange_held(p):
    return 200 if p[0] < 1e-6 else 60 if p[0] > 0.174 - 1e-6 and math.hypot(p[1], p[2]) > 0.057 else None


PARTS = [
    Part("vessel", "a vessel wall with a hot patch", 0.02, 45, vessel_film, lambda p: None, lambda p: vessel_radius(p) > 0.392,
         (0.6, 0, -0.4), {"thickness_m": 0.016, "heat_transfer": 12, "ambient": 20}, 0.02, 100, 320,
         ["--camera", "1.3,-2.6,1.5,0.25,0,0,36"],
         {"thickness_m": 0.016, "heat_transfer": 12 + 5, "ambient": (12 * 20 + 5 * 400) / (12 + 5)}),
    Part("finned", "a finned pipe", 0.006, 45, finned_film, lambda p: None,
         lambda p: math.hypot(p[1], p[2]) > 0.0425, (0, 0, -0.05), {"thickness_m": 0.003, "heat_transfer": 25, "ambient": 20}, 0.005, 40, 170,
         ["--camera", "-0.35,-0.75,0.5,0.3,0,0,36"]),
    Part("flange", "a flange between two temperatures", 0.005, 45, lambda p: None, flange_held,
         lambda p: math.hypot(p[1], p[2]) > 0.0505, (0.174, 0, -0.115), {"thickness_m": 0.007, "heat_transfer": 9, "ambient": 20}, 0.004, 60, 200,
         ["--camera", "-0.25,-0.4,0.28,0.09,0,0,36"]),
    Part("bent", "a pipe bent back on itself", 0.008, 45, bent_film, bent_held, lambda p: bent_radius(p) > 0.047,
         (0.15, -0.8, 0), {"thickness_m": 0.008, "heat_transfer": 10, "ambient": 20}, 0.01, 20, 200,
         ["--camera", "0.9,-1.6,1.7,0,-0.35,0,32"]),
]


def read_mesh(path):
    """[points], [tetrahedra as indices of points] of a gmsh file of version 2.2."""
    with open(path, encoding="ascii") as lines:
        rows = iter(lines.read().split("\n"))
    points, tets, index = [], [], {}
    for row in rows:
        if row == "$Nodes":
            for _ in range(int(next(rows))):
                number, x, y, z = next(rows).split()
                index[number] = len(points)
                points.append((float(x), float(y), float(z)))
        elif row == "$Elements":
            for _ in range(int(next(rows))):
                words = next(rows).split()
                if words[1] == "4":
                    tets.append(tuple(index[word] for word in words[3 + int(words[2]):]))
    used = sorted({point for tet in tets for point in tet})  # gmsh also keeps the points of curves' middles
    place = {point: i for i, point in enumerate(used)}
    return [points[point] for point in used], [tuple(place[point] for point in tet) for tet in tets]


def skin_of(tets):
    """[(tetrahedron, its face, three points)] of the faces that only one tetrahedron has."""
    faces = {}
    for number, tet in enumerate(tets):
        for face, corners in enumerate(FACES):
            of_face = tuple(tet[corner] for corner in corners)
            key = tuple(sorted(of_face))
            if key in faces:
                del faces[key]
            else:
                faces[key] = (number, face, of_face)
    return list(faces.values())


def outwards(points, tet, corners):
    """The three points, counter-clockwise as seen from outside the tetrahedron."""
    a, b, c = (points[corner] for corner in corners)
    inner = points[(set(tet) - set(corners)).pop()]
    u, v, w = ([q[i] - a[i] for i in range(3)] for q in (b, c, inner))
    volume = sum(w[i] * (u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3]) for i in range(3))
    return corners if volume < 0 else (corners[0], corners[2], corners[1])


def centre(points, corners):
    return [sum(points[corner][i] for corner in corners) / 3 for i in range(3)]


def write_deck(part, path, points, tets, skin):
    """CalculiX's input. A node is held where a face of the skin around it is."""
    held = {}
    with open(path, "w", encoding="ascii") as deck:
        deck.write("*NODE, NSET=ALL\n")
        deck.writelines("%d, %.9g, %.9g, %.9g\n" % (i + 1, *point) for i, point in enumerate(points))
        deck.write("*ELEMENT, TYPE=C3D4, ELSET=BODY\n")
        deck.writelines("%d, %d, %d, %d, %d\n" % (i + 1, *(corner + 1 for corner in tet)) for i, tet in enumerate(tets))
        deck.write("*MATERIAL, NAME=STEEL\n*CONDUCTIVITY\n%g\n*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL\n" % part.conductivity)
        deck.write("*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 20\n*STEP\n*HEAT TRANSFER, STEADY STATE\n")
        films = []
        for number, face, corners in skin:
            middle = centre(points, corners)
            if part.held(middle) is not None:
                held.update({corner: part.held(middle) for corner in corners})
            elif part.film(middle):
                h, sink = part.film(middle)
                films.append("%d, F%d, %.9g, %.9g\n" % (number + 1, face + 1, sink, h))
        if films:
            deck.write("*FILM\n" + "".join(films))
        if held:
            deck.write("*BOUNDARY\n" + "".join("%d, 11, 11, %g\n" % (node + 1, value) for node, value in held.items()))
        deck.write("*NODE PRINT, NSET=ALL\nNT\n*END STEP\n")


def read_temperatures(path, count):
    """By node, from what *NODE PRINT wrote."""
    values = [math.nan] * count
    with open(path, encoding="ascii") as lines:
        for line in lines:
            words = line.split()
            if len(words) == 2 and words[0].isdigit():
                values[int(words[0]) - 1] = float(words[1])
    if any(map(math.isnan, values)):
        raise SystemExit("%s: CalculiX did not say the temperature of every node" % path)
    return values


def run(command, folder, log):
    with open(os.path.join(folder, log), "w", encoding="utf-8") as out:
        if subprocess.run(command, cwd=folder, stdout=out, stderr=out, stdin=subprocess.DEVNULL, check=False).returncode != 0:
            raise SystemExit("%s failed: see %s" % (" ".join(command), os.path.join(folder, log)))


def solve(part, folder, size_m):
    """Meshes and solves the part: (points, temperatures, skin as triangles seen from outside, whether each is outside)."""
    geo = os.path.join(os.path.dirname(os.path.abspath(__file__)), "parts", part.name + ".geo")
    run(["gmsh", "-3", "-v", "2", "-nt", "1", "-format", "msh22", "-setnumber", "Mesh.MeshSizeMax", repr(size_m), "-setnumber",
         "Mesh.MeshSizeMin", repr(size_m), geo, "-o", part.name + ".msh"], folder, "gmsh.log")
    points, tets = read_mesh(os.path.join(folder, part.name + ".msh"))
    skin = skin_of(tets)
    write_deck(part, os.path.join(folder, part.name + ".inp"), points, tets, skin)
    run(["ccx", "-i", part.name], folder, "ccx.log")
    temperatures = read_temperatures(os.path.join(folder, part.name + ".dat"), len(points))
    triangles = [outwards(points, tets[number], corners) for number, _, corners in skin]
    return points, temperatures, triangles, [part.outside(centre(points, corners)) for corners in triangles]


def write_solution(path, points, temperatures, triangles, outside):
    """The skin alone, as compare.c reads it: counts, then x y z T of its points, then three points and 0 or 1 of its triangles."""
    used = sorted({corner for corners in triangles for corner in corners})
    place = {point: i for i, point in enumerate(used)}
    with open(path, "w", encoding="ascii") as out:
        out.write("%d %d\n" % (len(used), len(triangles)))
        out.writelines("%.9g %.9g %.9g %.9g\n" % (*points[point], temperatures[point]) for point in used)
        out.writelines("%d %d %d %d\n" % (*(place[corner] for corner in corners), seen) for corners, seen in zip(triangles, outside))


def write_model(path, points, triangles):
    """The skin as a GLB of one node, as CAD would export it."""
    used = sorted({corner for corners in triangles for corner in corners})
    place = {point: i for i, point in enumerate(used)}
    positions = b"".join(struct.pack("<3f", *points[point]) for point in used)
    indices = b"".join(struct.pack("<3I", *(place[corner] for corner in corners)) for corners in triangles)
    low, high = ([end(struct.unpack("<f", struct.pack("<f", points[point][i]))[0] for point in used) for i in range(3)] for end in (min, max))
    head = ('{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"name":"part","mesh":0}],'
            '"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"buffers":[{"byteLength":%d}],'
            '"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":%d},{"buffer":0,"byteOffset":%d,"byteLength":%d}],'
            '"accessors":[{"bufferView":0,"componentType":5126,"count":%d,"type":"VEC3","min":%s,"max":%s},'
            '{"bufferView":1,"componentType":5125,"count":%d,"type":"SCALAR"}]}') % (
                len(positions) + len(indices), len(positions), len(positions), len(indices), len(used), low, high, 3 * len(triangles))
    head = head.encode("ascii") + b" " * (-len(head) % 4)
    body = positions + indices
    with open(path, "wb") as out:
        out.write(struct.pack("<4sII", b"glTF", 2, 28 + len(head) + len(body)))
        out.write(struct.pack("<I4s", len(head), b"JSON") + head + struct.pack("<I4s", len(body), b"BIN\0") + body)


def sensors_of(points, triangles, outside, seed, count):
    """Points of the outside, each the farthest from all before it; the first is the nearest to the seed."""
    candidates = sorted({corner for corners, seen in zip(triangles, outside) if seen for corner in corners})
    chosen = [min(candidates, key=lambda point: math.dist(points[point], seed))]
    away = {point: math.inf for point in candidates}
    while len(chosen) < count:
        last, farthest = points[chosen[-1]], None
        for point in candidates:
            away[point] = min(away[point], math.dist(points[point], last))
            if farthest is None or away[point] > away[farthest]:
                farthest = point
        chosen.append(farthest)
    return chosen
