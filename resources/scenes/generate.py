#!/usr/bin/env python3
"""Writes the demo scenes beside this script: corner/ and pillars/, each scene.json, room.obj and room.mtl.

Scene frame: z up, millimetres. The luminaire's +z is its beam, its +y points up as far as the beam allows.
"""

import json
import math
import pathlib


def minus(a, b):
    return [p - q for p, q in zip(a, b)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    length = math.sqrt(sum(x * x for x in a))
    return [x / length for x in a]


def pose(position, target):
    """Row by row: the luminaire at `position`, its beam towards `target`."""
    z = unit(minus(target, position))
    x = unit(cross([0, 0, 1], z))
    y = cross(z, x)
    rows = [[x[k], y[k], z[k], position[k]] for k in range(3)] + [[0, 0, 0, 1]]
    return [round(value, 12) + 0.0 for row in rows for value in row]


class Mesh:
    """Faces by material; a vertex or normal that comes again is written once."""

    def __init__(self):
        self.vertices, self.normals, self.faces, self.triangles = {}, {}, {}, 0

    @staticmethod
    def number(table, values, digits):
        key = " ".join(f"{round(v, digits) + 0.0:g}" for v in values)
        return table.setdefault(key, len(table) + 1)

    def face(self, material, corners, normals=None):
        """A convex polygon, counter-clockwise from outside; one normal a corner, or flat."""
        refs = [str(self.number(self.vertices, c, 3)) for c in corners]
        if normals:
            refs = [f"{r}//{self.number(self.normals, n, 5)}" for r, n in zip(refs, normals)]
        kept = [r for i, r in enumerate(refs) if r.split("/")[0] != refs[i - 1].split("/")[0]]
        if len(kept) < 3:
            return
        self.faces.setdefault(material, []).append(kept)
        self.triangles += len(kept) - 2

    def box(self, material, low, high, turn_deg=0.0):
        """Axis-aligned, then turned about its own upright axis."""
        cx, cy = (low[0] + high[0]) / 2, (low[1] + high[1]) / 2
        c, s = math.cos(math.radians(turn_deg)), math.sin(math.radians(turn_deg))

        def corner(i, j, k):
            x, y = (low[0], high[0])[i] - cx, (low[1], high[1])[j] - cy
            return [cx + c * x - s * y, cy + s * x + c * y, (low[2], high[2])[k]]

        sides = [
            [(0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0)], [(0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
            [(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)], [(0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 1, 0)],
            [(0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0)], [(1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)],
        ]
        for side in sides:
            self.face(material, [corner(*s_) for s_ in side])

    def sphere(self, material, center, radius, around=48, rings=24):
        def point(i, j):
            theta, phi = math.pi * j / rings, 2 * math.pi * (i % around) / around
            n = [math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta)]
            return [c + radius * d for c, d in zip(center, n)], n

        for j in range(rings):
            for i in range(around):
                points = [point(i, j), point(i, j + 1), point(i + 1, j + 1), point(i + 1, j)]
                self.face(material, [p for p, _ in points], [n for _, n in points])

    def lathe(self, material, center, profile, around, flutes=0, flute_depth=0.0):
        """Turns (radius, z, slope) about the upright axis. slope = the normal's z part; None = a ring seen edge-on (flat
        faces). Flutes hollow the radius of a profile's smooth parts."""
        def radius(r, phi):
            return r - flute_depth * (0.5 - 0.5 * math.cos(flutes * phi)) if flutes else r

        def point(r, z, phi):
            return [center[0] + radius(r, phi) * math.cos(phi), center[1] + radius(r, phi) * math.sin(phi), center[2] + z]

        def normal(r, slope, phi):
            bend = -flute_depth * 0.5 * flutes * math.sin(flutes * phi) if flutes else 0.0
            out = [math.cos(phi) - bend / radius(r, phi) * -math.sin(phi),
                   math.sin(phi) - bend / radius(r, phi) * math.cos(phi), 0.0]
            out = unit(out)
            flat = math.sqrt(max(0.0, 1 - slope * slope))
            return [out[0] * flat, out[1] * flat, slope]

        for (r0, z0, s0), (r1, z1, s1) in zip(profile, profile[1:]):
            smooth = s0 is not None and s1 is not None
            for i in range(around):
                a, b = 2 * math.pi * i / around, 2 * math.pi * ((i + 1) % around) / around
                corners = [point(r0, z0, a), point(r0, z0, b), point(r1, z1, b), point(r1, z1, a)]
                normals = [normal(r0, s0, a), normal(r0, s0, b), normal(r1, s1, b), normal(r1, s1, a)] if smooth else None
                self.face(material, corners, normals)

    def write(self, folder, materials):
        folder.mkdir(exist_ok=True)
        with open(folder / "room.mtl", "w") as out:
            for name in self.faces:
                out.write(f"newmtl {name}\nKd {' '.join(f'{v:g}' for v in materials[name])}\n")
        with open(folder / "room.obj", "w") as out:
            out.write(f"# {self.triangles} triangles, mm, z up; written by generate.py\nmtllib room.mtl\n")
            out.writelines(f"v {v}\n" for v in self.vertices)
            out.writelines(f"vn {n}\n" for n in self.normals)
            for name, faces in self.faces.items():
                out.write(f"usemtl {name}\n")
                out.writelines(f"f {' '.join(face)}\n" for face in faces)


def scene(folder, name, camera, luminaires):
    text = json.dumps({
        "format": "lumifield-scene", "version": 1, "name": name, "mesh": "room.obj", "materials": {}, "camera": camera,
        "luminaires": [{"pose": p, "scale": 1} for p in luminaires],
    }, indent=2)
    (folder / "scene.json").write_text(text + "\n")


def corner(folder):
    """Two walls and a floor that meet at the origin; the lamp shines into the corner from 0.9 m."""
    mesh, size, height = Mesh(), 2600, 1900
    mesh.face("floor", [[0, 0, 0], [size, 0, 0], [size, size, 0], [0, size, 0]])
    mesh.face("wall", [[0, 0, 0], [0, size, 0], [0, size, height], [0, 0, height]])
    mesh.face("wall", [[0, 0, 0], [0, 0, height], [size, 0, height], [size, 0, 0]])
    mesh.box("blue", [140, 520, 0], [400, 780, 420], 24)
    mesh.box("white", [620, 190, 0], [860, 430, 160], -14)
    mesh.sphere("clay", [740, 310, 290], 130)
    mesh.sphere("white", [520, 560, 110], 110)
    materials = {"floor": [0.62, 0.58, 0.52], "wall": [0.75, 0.75, 0.73], "blue": [0.35, 0.48, 0.7],
                 "clay": [0.75, 0.42, 0.3], "white": [0.8, 0.8, 0.8]}
    mesh.write(folder, materials)
    camera = {"position_mm": [2350, 2350, 1350], "target_mm": [300, 300, 470], "up": [0, 0, 1], "fov_y_deg": 25}
    scene(folder, "corner", camera, [pose([1000, 1000, 760], [220, 220, 330])])
    return mesh.triangles


def pillars(folder):
    """A hall with two rows of fluted pillars; the lamp shines between them, 0.8 m before the nearest that it lights."""
    mesh = Mesh()
    x, y, z = 2800, 2400, 1450
    mesh.face("floor", [[0, 0, 0], [x, 0, 0], [x, y, 0], [0, y, 0]])
    mesh.face("ceiling", [[0, 0, z], [0, y, z], [x, y, z], [x, 0, z]])
    mesh.face("wall", [[0, 0, 0], [0, y, 0], [0, y, z], [0, 0, z]])
    mesh.face("wall", [[0, 0, 0], [0, 0, z], [x, 0, z], [x, 0, 0]])
    mesh.face("wall", [[x, 0, 0], [x, 0, z], [x, y, z], [x, y, 0]])
    mesh.face("wall", [[0, y, 0], [x, y, 0], [x, y, z], [0, y, z]])
    base = 100
    shaft = [(90 - 16 * (k / 5) ** 2, base + 60 + k * (z - 2 * base - 120) / 5, 0.015) for k in range(6)]
    ring = [(92 + 20 * math.sin(math.pi * k / 5), 60 * k / 5, -math.cos(math.pi * k / 5) * 0.95) for k in range(6)]
    for row in (750, 1650):
        for column in range(4):
            center = [500 + 550 * column, row, 0]
            half = 125
            for low in (0, z - base):
                mesh.box("stone", [center[0] - half, row - half, low], [center[0] + half, row + half, low + base])
            mesh.lathe("pillar", center, shaft, 64, 16, 7)
            mesh.lathe("stone", [center[0], row, base], ring, 16)
            mesh.lathe("stone", [center[0], row, z - base - 60], [(r - 12, h, s) for r, h, s in ring], 16)
    materials = {"floor": [0.55, 0.5, 0.45], "ceiling": [0.7, 0.7, 0.7], "wall": [0.68, 0.64, 0.58],
                 "pillar": [0.78, 0.76, 0.72], "stone": [0.6, 0.52, 0.44]}
    mesh.write(folder, materials)
    camera = {"position_mm": [2700, 1290, 860], "target_mm": [600, 1190, 610], "up": [0, 0, 1], "fov_y_deg": 48}
    scene(folder, "pillars", camera, [pose([1750, 1200, 680], [500, 1200, 620])])
    return mesh.triangles


if __name__ == "__main__":
    here = pathlib.Path(__file__).resolve().parent
    for make in (corner, pillars):
        print(make.__name__, make(here / make.__name__), "triangles")
