#!/usr/bin/env python3
"""Converts an NFF file (host/scene/nff.hpp) to a POV-Ray 3.7 scene with the same image.

    tools/povray_scene.py SCENE.nff BOUNCES WxH     writes the scene to stdout, for an image of W x H pixels

Differences between POV-Ray and the shading of kernels/README.md, and how the scene works around them:

- In POV-Ray a surface with transmittance T keeps only 1 - T of its own colour, so Kd is divided by 1 - T (at T = 1 all colour is lost).
- In POV-Ray light passes through transmitting objects. Their shadow comes from an opaque second object that only shadow rays hit.
- In POV-Ray the objects that a ray has entered decide which side of a surface is glass; normals do not.
- In POV-Ray objects are visible from both sides. An object of negative radius gets a clear outside; a ray that passes through it uses up a bounce.
- Polygons become triangles, and the triangles of one surface a mesh, which POV-Ray intersects fastest.
- Checkers are cubes. They are stretched along the axis that the checker ignores.

Exit codes: 0 done; 1 the file cannot be converted, for example because of an entity of another NFF dialect.
"""
import math, re, sys
from pathlib import Path
from typing import NamedTuple

LONG = 1e9  # length of a checker's cubes along the axis that the checker ignores: the largest number allowed in NFF
VIEW = {"from": 3, "at": 3, "up": 3, "angle": 1, "hither": 1, "resolution": 2}  # numbers of each part


class SceneError(Exception):
    """An error in a file."""


class Surface(NamedTuple):
    """NFF's `f`, with the checker that replaces its colour, if any."""
    colour: tuple = (1.0, 1.0, 1.0)
    diffuse: float = 1.0
    specular: float = 0.0
    shine: float = 0.0
    transmittance: float = 0.0
    refraction_index: float = 1.0
    checker: tuple = None  # even r g b, odd r g b, size
    axis: int = None  # the axis that the checker ignores


# Vectors are tuples of three numbers.
def minus(a, b):
    return tuple(x - y for x, y in zip(a, b))


def times(s, a):
    return tuple(s * x for x in a)


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def normalized(a):
    length = math.hypot(*a)
    return times(1 / length, a) if length > 0 else a


def newell_normal(vertices):
    """Returns Newell's normal of a polygon; its length is twice the area."""
    total = (0.0, 0.0, 0.0)
    for a, b in zip(vertices, vertices[1:] + vertices[:1]):
        total = tuple(t + c for t, c in zip(total, cross(a, b)))
    return total


def largest_axis(normal):
    """Returns the axis of the component with the largest magnitude; of equal ones, the first."""
    return max(range(3), key=lambda axis: abs(normal[axis]))


def triangles(vertices):
    """Triangulates a polygon, also a concave one, by ear clipping. Returns triples of vertex indices."""
    normal = newell_normal(vertices)
    axis = largest_axis(normal)
    turn = math.copysign(1, normal[axis])
    projected = [(v[(axis + 1) % 3], turn * v[(axis + 2) % 3]) for v in vertices]  # counter-clockwise

    def area(a, b, c):
        return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])

    def is_ear(corner, remaining):
        a, b, c = (projected[i] for i in corner)
        other_points = (projected[i] for i in remaining if projected[i] not in (a, b, c))
        return area(a, b, c) > 0 and not any(min(area(a, b, p), area(b, c, p), area(c, a, p)) >= 0 for p in other_points)

    remaining, found = list(range(len(vertices))), []
    while len(remaining) > 3:
        corners = [(remaining[i - 1], remaining[i], remaining[(i + 1) % len(remaining)]) for i in range(len(remaining))]
        ear = next((corner for corner in corners if is_ear(corner, remaining)), corners[1])  # a self-intersecting polygon may have no ear
        found.append(ear)
        remaining.remove(ear[1])
    return found + [tuple(remaining)]


def vector(v):
    return "<" + ", ".join(f"{x!r}" for x in v) + ">"


def camera(view, width, height):
    """Returns POV-Ray's camera: right and up span the image at distance 1 along the gaze, in NFF's handedness."""
    gaze = normalized(minus(view["at"], view["from"]))
    right = normalized(cross(gaze, view["up"]))
    image_height = 2 * math.tan(math.radians(view["angle"][0]) / 2)
    parts = {"location": view["from"], "direction": gaze, "right": times(image_height * width / height, right),
             "up": times(image_height, cross(right, gaze))}
    return "camera { perspective " + " ".join(f"{name} {vector(value)}" for name, value in parts.items()) + " }"


class Scene:
    """A POV-Ray scene made of the words of an NFF file. Raises ValueError, KeyError or IndexError if they are not NFF as raya reads it."""

    def __init__(self, words):
        self.view, self.background, self.lights, self.solids = {}, (0.0, 0.0, 0.0), [], []  # lights: (position, colour or None)
        self.surfaces, self.faces = {}, {}  # number and triangles of each surface
        self.surface, self.checker = Surface(), None
        self.words = words[::-1]  # the next word is the last
        while self.words:
            entity = self.words.pop()
            self.read(entity + " " + self.words.pop() if entity == "#raya" else entity)
        for surface, faces in self.faces.items():  # one mesh for each surface
            self.add("mesh { " + "\n".join(faces), surface)
        if not self.view:
            raise ValueError("no 'v'")

    def numbers(self, count):
        return tuple(float(self.words.pop()) for _ in range(count))

    def read(self, entity):
        """Reads an entity after its name."""
        if entity == "v":
            for _ in VIEW:
                part = self.words.pop()
                self.view[part] = self.numbers(VIEW[part])
        elif entity == "b":
            self.background = self.numbers(3)
        elif entity == "l":
            position, has_colour = self.numbers(3), self.words and re.match(r"[-+]?\.?\d", self.words[-1])
            self.lights.append((position, self.numbers(3) if has_colour else None))
        elif entity == "f":
            self.surface = Surface(self.numbers(3), *self.numbers(5))
        elif entity == "s":
            *centre, radius = self.numbers(4)
            self.add(f"sphere {{ {vector(centre)}, {abs(radius)!r}", self.surface, radius < 0)
        elif entity in ("p", "pp"):
            corners = [self.numbers(6 if entity == "pp" else 3) for _ in range(int(self.words.pop()))]
            self.add_polygon([corner[:3] for corner in corners], [normalized(corner[3:]) for corner in corners] if entity == "pp" else None)
        elif entity == "c":
            base, (radius,), apex, (apex_radius,) = (self.numbers(count) for count in (3, 1, 3, 1))
            shape = f"cone {{ {vector(base)}, {abs(radius)!r}, {vector(apex)}, {abs(apex_radius)!r} open"
            if radius == apex_radius:
                shape = f"cylinder {{ {vector(base)}, {vector(apex)}, {abs(radius)!r} open"
            self.add(shape, self.surface, min(radius, apex_radius) < 0)
        elif entity == "#raya plane":
            normal, (distance,) = self.numbers(3), self.numbers(1)
            self.add(f"plane {{ {vector(normalized(normal))}, {distance / math.hypot(*normal)!r}", self.flat_surface(normal))
        elif entity == "#raya checker":
            self.checker = self.numbers(7)
        else:
            raise ValueError(f"unknown entity '{entity}'")

    def flat_surface(self, normal):
        """Returns the surface of a plane or polygon, with the checker that precedes it, if any."""
        checker, self.checker = self.checker, None
        return self.surface._replace(checker=checker, axis=largest_axis(normal)) if checker else self.surface

    def add_polygon(self, vertices, normals):
        normal = newell_normal(vertices)
        surface = self.flat_surface(normal)
        for corners in triangles(vertices) if any(normal) else ():  # a polygon without area is invisible
            points = (f"{vector(vertices[i])}, {vector(normals[i])}" if normals else vector(vertices[i]) for i in corners)
            self.faces.setdefault(surface, []).append(("smooth_" if normals else "") + "triangle { " + ", ".join(points) + " }")

    def add(self, shape, surface, inside_only=False):
        """Adds an object and, if it transmits light, a second object that casts its shadow."""
        texture = f"texture {{ Surface{self.surfaces.setdefault(surface, len(self.surfaces))} }}"
        if inside_only:
            texture = "texture { Clear } interior_" + texture
        if surface.transmittance <= 0:
            self.solids.append(f"{shape} {texture} }}")
        else:
            interior = f"interior {{ ior {surface.refraction_index!r} }}"
            self.solids += [f"{shape} {texture} {interior} no_shadow }}", f"{shape} no_image no_reflection }}"]


def pigment(surface):
    clear = f" transmit {surface.transmittance!r}" if surface.transmittance > 0 else ""
    if not surface.checker:
        return f"color rgb {vector(surface.colour)}{clear}"
    even, odd, size = surface.checker[:3], surface.checker[3:6], surface.checker[6]
    stretch = tuple(LONG if axis == surface.axis else size for axis in range(3))
    shift = tuple(-LONG / 2 if axis == surface.axis else 0.0 for axis in range(3))
    return f"checker color rgb {vector(even)}{clear} color rgb {vector(odd)}{clear} scale {vector(stretch)} translate {vector(shift)}"


def finish(surface, ambient):
    opacity = 1 - surface.transmittance
    diffuse = surface.diffuse / opacity if opacity != 0 else 0.0
    shiny = f" phong {surface.specular!r} phong_size {surface.shine!r} reflection {{ {surface.specular!r} }}" if surface.specular > 0 else ""
    return f"ambient {ambient * diffuse!r} diffuse {diffuse!r}{shiny}"


def povray_scene(text, name, bounces, width, height):
    """Returns the POV-Ray scene of an NFF file, as text. Raises SceneError. `raya info` checks files and names lines."""
    try:
        scene = Scene([word for line in text.splitlines() for word in (line if line.startswith("#raya ") else line.partition("#")[0]).split()])
    except (ValueError, KeyError, IndexError) as problem:
        raise SceneError(f"{name}: not NFF as raya reads it: {problem}") from None
    count = len(scene.lights)
    intensity = math.sqrt(count) / (2 * count) if count else 1.0  # SPD's default for lights and ambient light
    lights = [f"light_source {{ {vector(position)} color rgb {vector(colour or 3 * (intensity,))} }}" for position, colour in scene.lights]
    textures = [f"#declare Surface{number} = texture {{ pigment {{ {pigment(surface)} }} finish {{ {finish(surface, intensity)} }} }}"
                for surface, number in scene.surfaces.items()]
    head = ["#version 3.7;",
            f"global_settings {{ assumed_gamma 1 max_trace_level {bounces + 1} adc_bailout 0 ambient_light rgb 1 }}",
            f"background {{ color rgb {vector(scene.background)} }}",
            "#declare Clear = texture { pigment { color rgb 1 transmit 1 } finish { ambient 0 diffuse 0 } }",
            camera(scene.view, width, height)]
    return "\n".join([*head, *lights, *textures, *scene.solids]) + "\n"


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    file, bounces, (width, height) = Path(sys.argv[1]), int(sys.argv[2]), map(int, sys.argv[3].split("x"))
    try:
        print(povray_scene(file.read_text(), file.name, bounces, width, height), end="")
    except (SceneError, OSError) as problem:
        sys.exit(f"povray_scene.py: {problem}")


if __name__ == "__main__":
    main()
