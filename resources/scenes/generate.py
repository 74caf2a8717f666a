#!/usr/bin/env python3
"""Writes the demo scenes beside this script: corner/, pillars/ and road/, each scene.json, room.obj and room.mtl.

Scene frame: z up, millimetres. The luminaire's +z is its beam, its +y points up as far as the beam allows.
"""

import json
import math
import pathlib
import struct
import zlib


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
    """Faces by material; a vertex, normal or texture coordinate that comes again is written once."""

    def __init__(self):
        self.vertices, self.normals, self.places, self.faces, self.triangles = {}, {}, {}, {}, 0

    @staticmethod
    def number(table, values, digits):
        key = " ".join(f"{round(v, digits) + 0.0:g}" for v in values)
        return table.setdefault(key, len(table) + 1)

    def face(self, material, corners, normals=None, places=None):
        """A convex polygon, counter-clockwise from outside; one normal a corner, or flat; places on its texture."""
        refs = [str(self.number(self.vertices, c, 3)) for c in corners]
        if places:
            refs = [f"{r}/{self.number(self.places, t, 5)}" for r, t in zip(refs, places)]
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
        with open(folder / "room.mtl", "w") as out:
            for name in self.faces:
                values = materials[name]
                lines = values if isinstance(values, dict) else {"Kd": values}
                out.write(f"newmtl {name}\n")
                for key, value in lines.items():
                    out.write(f"{key} {' '.join(f'{v:g}' for v in value) if isinstance(value, list) else value}\n")
        with open(folder / "room.obj", "w") as out:
            out.write(f"# {self.triangles} triangles, mm, z up; written by generate.py\nmtllib room.mtl\n")
            out.writelines(f"v {v}\n" for v in self.vertices)
            out.writelines(f"vt {t}\n" for t in self.places)
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
    mesh.sphere("brass", [930, 1330, 120], 120, 20, 10)
    materials = {"floor": {"Kd": [0.55, 0.5, 0.45], "Ks": [0.04, 0.04, 0.04], "Pr": 0.3},
                 "brass": {"Kd": [0.89, 0.72, 0.39], "Pr": 0.25, "Pm": 1}, "ceiling": [0.7, 0.7, 0.7],
                 "wall": [0.68, 0.64, 0.58], "pillar": [0.78, 0.76, 0.72], "stone": [0.6, 0.52, 0.44]}
    mesh.write(folder, materials)
    camera = {"position_mm": [2700, 1290, 860], "target_mm": [600, 1190, 610], "up": [0, 0, 1], "fov_y_deg": 48}
    scene(folder, "pillars", camera, [pose([1750, 1200, 680], [500, 1200, 620])])
    return mesh.triangles


def write_png(file, side, colour, parts=4):
    """8 bits, RGB; `colour` of a place from (0, 0) at the lower left to (1, 1), averaged over parts x parts of a pixel."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    fine = side * parts
    rows = []
    for j in range(side):
        row = bytearray([0])
        for i in range(side):
            inside = [colour((i * parts + p + 0.5) / fine, 1 - (j * parts + q + 0.5) / fine)
                      for p in range(parts) for q in range(parts)]
            row += bytes(round(sum(c[k] for c in inside) / len(inside)) for k in range(3))
        rows.append(bytes(row))
    header = struct.pack(">IIBBBBB", side, side, 8, 2, 0, 0, 0)
    file.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(b"".join(rows), 9)) +
                     chunk(b"IEND", b""))


def speed_limit(x, y):
    """A red ring with 30 in it; sRGB codes."""
    radius = math.hypot(x - 0.5, y - 0.5)
    if radius > 0.36:
        return (190, 25, 30) if radius < 0.48 else (225, 225, 220)

    def stroke(cx, cy, half_width, half_height):
        return abs(x - cx) <= half_width and abs(y - cy) <= half_height

    three = any(stroke(0.36, cy, 0.085, 0.025) for cy in (0.34, 0.5, 0.66)) or stroke(0.42, 0.5, 0.027, 0.185)
    nought = stroke(0.62, 0.5, 0.085, 0.185) and not stroke(0.62, 0.5, 0.035, 0.135)
    return (20, 20, 20) if three or nought else (225, 225, 220)


def road(folder):
    """A wet road at night before two headlights: kerbs, a wall of blocks, bollards and a sign."""
    mesh, half, end = Mesh(), 2400, 12000
    start, pavement, top = -3000, 1100, 120
    mesh.face("road", [[start, -half, 0], [end, -half, 0], [end, half, 0], [start, half, 0]])
    for side in (-1, 1):
        low, high = sorted((side * (half + 150), side * (half + pavement)))
        mesh.face("pavement", [[start, low, top], [end, low, top], [end, high, top], [start, high, top]])
        for k in range(25):
            low, high = sorted((side * half, side * (half + 150)))
            mesh.box("kerb", [start + 600 * k, low, 0], [start + 600 * k + 590, high, top + 5])

    # Blocks along the left and across the end, each course shifted by half a block.
    length, height, thick = 750, 300, 200
    for course in range(6):
        z, shift = top - 120 + height * course, length / 2 * (course % 2)
        for k in range(16):
            x = -shift + length * k
            mesh.box("wall", [x, half + pavement, z], [x + length - 12, half + pavement + thick, z + height - 12])
        for k in range(11):
            y = -half - pavement - shift + length * k
            mesh.box("wall", [end, y, z], [end + thick, y + length - 12, z + height - 12])
    mesh.box("kerb", [-400, half + pavement - 40, 6 * height], [end, half + pavement + thick + 40, 6 * height + 90])

    # A bollard is a shaft with a ring and a round head.
    head = [(85 * math.cos(a), 900 + 85 * math.sin(a), math.sin(a)) for a in (math.pi / 16 * k for k in range(9))]
    ring = [(85 + 18 * math.sin(a), 780 - 45 * math.cos(a), -math.cos(a)) for a in (math.pi / 8 * k for k in range(9))]
    bollard = [(110, 0, None), (110, 130, None), (85, 150, None), (85, 150, 0.0), (85, 735, 0.0)] + ring + [(85, 825, 0.0)]
    for center in ([2600, -1150, 0], [4300, 350, 0], [6400, -750, 0]):
        mesh.lathe("bollard", center, bollard, 40)
        mesh.lathe("steel", center, [(85, 825, 0.0)] + head, 40)

    # The sign looks back at the lamps.
    pole, board, radius = [4500, 1900, 0], 590, 300
    mesh.lathe("steel", pole, [(30, 0, 0.0), (30, board + radius, 0.0)], 24)
    rim = [(math.cos(2 * math.pi * k / 64), math.sin(2 * math.pi * k / 64)) for k in range(64)]
    disc = [[pole[0] - 32, pole[1] - radius * c, board + radius * s] for c, s in rim]
    mesh.face("sign", disc, None, [[0.5 + 0.48 * c, 0.5 + 0.48 * s] for c, s in rim])
    write_png(folder / "sign.png", 128, speed_limit)

    materials = {"road": {"Kd": [0.07, 0.07, 0.075], "Ks": [0.04, 0.04, 0.04], "Pr": 0.35},
                 "pavement": [0.28, 0.27, 0.26], "kerb": [0.42, 0.41, 0.39], "wall": [0.45, 0.3, 0.23],
                 "bollard": {"Kd": [0.5, 0.42, 0.1], "Ks": [0.04, 0.04, 0.04], "Pr": 0.4},
                 "steel": {"Kd": [0.6, 0.6, 0.6], "Pr": 0.3, "Pm": 1}, "sign": {"Kd": [0.9, 0.9, 0.9], "map_Kd": "sign.png"}}
    mesh.write(folder, materials)
    camera = {"position_mm": [-3600, 250, 2500], "target_mm": [4300, -100, 300], "up": [0, 0, 1], "fov_y_deg": 33}
    lamps = [pose([0, y, 650], [10000, y, 475]) for y in (600, -600)]
    scene(folder, "road", camera, lamps)
    return mesh.triangles


if __name__ == "__main__":
    here = pathlib.Path(__file__).resolve().parent
    for make in (corner, pillars, road):
        (here / make.__name__).mkdir(exist_ok=True)
        print(make.__name__, make(here / make.__name__), "triangles")
