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

Exit codes: 0 done; 1 the file cannot be converted (the message names the line), for example because of an entity of another NFF dialect.
"""
import math
import sys
from dataclasses import dataclass, field, replace
from pathlib import Path

LONG = 1e9  # length of a checker's cubes along the axis that the checker ignores: the largest number allowed in NFF


class SceneError(Exception):
    """An error in a file, as FILE:LINE: reason."""


@dataclass(frozen=True)
class Surface:
    """NFF's `f`, with the checker that replaces its colour, if any."""

    colour: tuple = (1.0, 1.0, 1.0)
    diffuse: float = 1.0
    specular: float = 0.0
    shine: float = 0.0
    transmittance: float = 0.0
    refraction_index: float = 1.0
    checker: tuple = None  # even r g b, odd r g b, size
    axis: int = None  # the axis that the checker ignores


@dataclass
class Scene:
    """Objects by kind; the last item of each object is its surface."""

    view: dict = field(default_factory=dict)
    background: tuple = (0.0, 0.0, 0.0)
    lights: list = field(default_factory=list)  # (position, colour or None)
    spheres: list = field(default_factory=list)  # (centre, radius, surface)
    planes: list = field(default_factory=list)  # (normal, distance, surface)
    polygons: list = field(default_factory=list)  # (vertices, normals or None, surface)
    cones: list = field(default_factory=list)  # (base, radius, apex, radius, surface)


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


class Tokens:
    """The tokens of a file, without comments, each with its line."""

    def __init__(self, text, name):
        self.name, self.position, self.tokens = name, 0, []
        for number, line in enumerate(text.splitlines(), 1):
            kept = line if line.split()[:1] == ["#raya"] else line.partition("#")[0]
            self.tokens += [(token, number) for token in kept.split()]

    def refuse(self, reason):
        line = self.tokens[max(0, self.position - 1)][1] if self.tokens else 1
        raise SceneError(f"{self.name}:{line}: {reason}")

    def has_more(self):
        return self.position < len(self.tokens)

    def take(self):
        if not self.has_more():
            self.refuse("the file ends within an entity")
        self.position += 1
        return self.tokens[self.position - 1][0]

    def number(self):
        token = self.take()
        try:
            return float(token)
        except ValueError:
            self.refuse(f"expected a number, found '{token}'")

    def numbers(self, count):
        return tuple(self.number() for _ in range(count))

    def number_follows(self):
        return self.has_more() and self.tokens[self.position][0].lstrip("+-").lstrip(".")[:1].isdigit()


def take_view(tokens):
    parts = {"from": 3, "at": 3, "up": 3, "angle": 1, "hither": 1, "resolution": 2}
    view = {}
    while len(view) < len(parts):
        part = tokens.take()
        if part not in parts or part in view:
            tokens.refuse(f"'v': unknown or repeated part '{part}'")
        view[part] = tokens.numbers(parts[part])
    return view


def take_polygon(tokens, patch):
    """Reads the vertices of a polygon or patch. Returns (vertices, normals or None)."""
    corners = [tokens.numbers(6 if patch else 3) for _ in range(int(tokens.number()))]
    normals = [normalized(corner[3:]) for corner in corners] if patch else None
    return [corner[:3] for corner in corners], normals


def parse_nff(text, name="scene"):
    """Returns the scene of an NFF file. Raises SceneError."""
    tokens, scene, surface, checker = Tokens(text, name), Scene(), Surface(), None

    def flat_surface(normal):
        """Returns the surface of a plane or polygon, with the checker that precedes it, if any."""
        nonlocal checker
        squares, checker = checker, None
        return replace(surface, checker=squares, axis=largest_axis(normal)) if squares else surface

    while tokens.has_more():
        entity = tokens.take()
        entity += " " + tokens.take() if entity == "#raya" else ""
        if entity == "v":
            scene.view = take_view(tokens)
        elif entity == "b":
            scene.background = tokens.numbers(3)
        elif entity == "l":
            scene.lights.append((tokens.numbers(3), tokens.numbers(3) if tokens.number_follows() else None))
        elif entity == "f":
            surface = Surface(tokens.numbers(3), *tokens.numbers(5))
        elif entity == "s":
            scene.spheres.append((tokens.numbers(3), tokens.number(), surface))
        elif entity in ("p", "pp"):
            vertices, normals = take_polygon(tokens, entity == "pp")
            normal = newell_normal(vertices)
            polygon_surface = flat_surface(normal)
            if any(normal):  # a polygon without area is invisible
                scene.polygons.append((vertices, normals, polygon_surface))
        elif entity == "c":
            scene.cones.append((tokens.numbers(3), tokens.number(), tokens.numbers(3), tokens.number(), surface))
        elif entity == "#raya plane":
            normal, distance = tokens.numbers(3), tokens.number()
            scene.planes.append((normalized(normal), distance / math.hypot(*normal), flat_surface(normal)))
        elif entity == "#raya checker":
            checker = tokens.numbers(7)
        else:
            tokens.refuse(f"unknown entity '{entity}'")
    if not scene.view:
        tokens.refuse("no 'v'")
    return scene


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


class Surfaces:
    """Textures; each surface is declared once."""

    def __init__(self, ambient):
        self.ambient, self.numbers = ambient, {}

    def number(self, surface):
        return self.numbers.setdefault(surface, len(self.numbers))

    def pigment(self, surface):
        clear = f" transmit {surface.transmittance!r}" if surface.transmittance > 0 else ""
        if not surface.checker:
            return f"color rgb {vector(surface.colour)}{clear}"
        even, odd, size = surface.checker[:3], surface.checker[3:6], surface.checker[6]
        stretch = tuple(LONG if axis == surface.axis else size for axis in range(3))
        shift = tuple(-LONG / 2 if axis == surface.axis else 0.0 for axis in range(3))
        return f"checker color rgb {vector(even)}{clear} color rgb {vector(odd)}{clear} scale {vector(stretch)} translate {vector(shift)}"

    def finish(self, surface):
        opacity = 1 - surface.transmittance
        diffuse = surface.diffuse / opacity if opacity != 0 else 0.0
        shiny = f" phong {surface.specular!r} phong_size {surface.shine!r} reflection {{ {surface.specular!r} }}" if surface.specular > 0 else ""
        return f"ambient {self.ambient * diffuse!r} diffuse {diffuse!r}{shiny}"

    def declarations(self):
        for surface, number in self.numbers.items():
            yield f"#declare Surface{number} = texture {{ pigment {{ {self.pigment(surface)} }} finish {{ {self.finish(surface)} }} }}"

    def solid(self, shape, surface, inside_only=False):
        """Returns the texts of an object and, if it transmits light, of a second object that casts its shadow."""
        texture = f"texture {{ Surface{self.number(surface)} }}"
        if inside_only:
            texture = "texture { Clear } interior_" + texture
        if surface.transmittance <= 0:
            return [f"{shape} {texture} }}"]
        interior = f"interior {{ ior {surface.refraction_index!r} }}"
        return [f"{shape} {texture} {interior} no_shadow }}", f"{shape} no_image no_reflection }}"]


def camera(view, width, height):
    """Returns POV-Ray's camera: right and up span the image at distance 1 along the gaze, in NFF's handedness."""
    gaze = normalized(minus(view["at"], view["from"]))
    right = normalized(cross(gaze, view["up"]))
    image_height = 2 * math.tan(math.radians(view["angle"][0]) / 2)
    parts = {"location": view["from"], "direction": gaze, "right": times(image_height * width / height, right),
             "up": times(image_height, cross(right, gaze))}
    return "camera { perspective " + " ".join(f"{name} {vector(value)}" for name, value in parts.items()) + " }"


def meshes(polygons, surfaces):
    """Yields one mesh for each surface."""
    by_surface = {}
    for vertices, normals, surface in polygons:
        faces = by_surface.setdefault(surface, [])
        for corners in triangles(vertices):
            if normals:
                faces.append("smooth_triangle { " + ", ".join(f"{vector(vertices[i])}, {vector(normals[i])}" for i in corners) + " }")
            else:
                faces.append("triangle { " + ", ".join(vector(vertices[i]) for i in corners) + " }")
    for surface, faces in by_surface.items():
        yield from surfaces.solid("mesh { " + "\n".join(faces), surface)


def objects(scene, surfaces):
    for centre, radius, surface in scene.spheres:
        yield from surfaces.solid(f"sphere {{ {vector(centre)}, {abs(radius)!r}", surface, radius < 0)
    for normal, distance, surface in scene.planes:
        yield from surfaces.solid(f"plane {{ {vector(normal)}, {distance!r}", surface)
    yield from meshes(scene.polygons, surfaces)
    for base, base_radius, apex, apex_radius, surface in scene.cones:
        shape = f"cone {{ {vector(base)}, {abs(base_radius)!r}, {vector(apex)}, {abs(apex_radius)!r} open"
        if base_radius == apex_radius:
            shape = f"cylinder {{ {vector(base)}, {vector(apex)}, {abs(base_radius)!r} open"
        yield from surfaces.solid(shape, surface, min(base_radius, apex_radius) < 0)


def povray_scene(scene, bounces, width, height):
    """Returns the text of the POV-Ray scene."""
    count = len(scene.lights)
    intensity = math.sqrt(count) / (2 * count) if count else 1.0  # SPD's default for lights and ambient light
    surfaces = Surfaces(intensity)
    solids = list(objects(scene, surfaces))
    lights = [f"light_source {{ {vector(position)} color rgb {vector(colour or 3 * (intensity,))} }}" for position, colour in scene.lights]
    head = ["#version 3.7;",
            f"global_settings {{ assumed_gamma 1 max_trace_level {bounces + 1} adc_bailout 0 ambient_light rgb 1 }}",
            f"background {{ color rgb {vector(scene.background)} }}",
            "#declare Clear = texture { pigment { color rgb 1 transmit 1 } finish { ambient 0 diffuse 0 } }",
            camera(scene.view, width, height)]
    return "\n".join([*head, *lights, *surfaces.declarations(), *solids]) + "\n"


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    file, bounces, (width, height) = Path(sys.argv[1]), int(sys.argv[2]), map(int, sys.argv[3].split("x"))
    try:
        print(povray_scene(parse_nff(file.read_text(), file.name), bounces, width, height), end="")
    except (SceneError, OSError) as problem:
        sys.exit(f"povray_scene.py: {problem}")


if __name__ == "__main__":
    main()
