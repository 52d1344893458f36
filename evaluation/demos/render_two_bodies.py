#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Draws the start and the end of a run of two_bodies or of a scene side by side, off-screen, with VTK.

Usage: render_two_bodies.py [out/two_bodies.pvd [out/two_bodies.png]] [--width PIXELS]

Debian's VTK draws through X: without a display, run it as
    xvfb-run -a /usr/bin/python3 evaluation/demos/render_two_bodies.py
(packages python3-vtk9, xvfb, xauth).
"""

import argparse
import math
import os
import sys
import xml.etree.ElementTree as ElementTree

# Blue and orange first: told apart by colour-blind readers too. Scenes of more bodies go on and start again.
COLOURS = (
    (0.12, 0.42, 0.70),
    (0.93, 0.53, 0.13),
    (0.35, 0.70, 0.90),
    (0.95, 0.90, 0.25),
    (0.00, 0.62, 0.45),
    (0.80, 0.47, 0.65),
    (0.84, 0.37, 0.00),
)


def frames(pvd):
    """The paths of all frames, with their times."""
    entries = ElementTree.parse(pvd).getroot().findall("./Collection/DataSet")
    if not entries:
        raise ValueError(f"{pvd} lists no frames: run two_bodies again")
    folder = os.path.dirname(os.path.abspath(pvd))
    return [(os.path.join(folder, e.get("file")), float(e.get("timestep"))) for e in entries]


def read(path):
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    if not os.path.exists(path):
        raise FileNotFoundError(f"{path} is listed but missing: run two_bodies again")
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def split(frame, body):
    """One body of a frame, with normals that keep sharp edges sharp."""
    from vtkmodules.vtkFiltersCore import vtkPolyDataNormals, vtkThreshold
    from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter

    threshold = vtkThreshold()
    threshold.SetInputData(frame)
    threshold.SetInputArrayToProcess(0, 0, 0, 0, "body")
    threshold.SetLowerThreshold(body - 0.5)
    threshold.SetUpperThreshold(body + 0.5)
    surface = vtkGeometryFilter()
    surface.SetInputConnection(threshold.GetOutputPort())
    normals = vtkPolyDataNormals()
    normals.SetFeatureAngle(40)
    normals.SetInputConnection(surface.GetOutputPort())
    normals.Update()
    return normals.GetOutput()


CAPTION_HEIGHT = 0.1  # of the picture


def add_view(window, frame, viewport):
    from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper, vtkRenderer

    renderer = vtkRenderer()
    renderer.SetViewport(*viewport)
    renderer.SetBackground(1, 1, 1)
    for body in range(1 + int(frame.GetPointData().GetArray("body").GetRange()[1])):
        mapper = vtkPolyDataMapper()
        mapper.SetInputData(split(frame, body))
        mapper.ScalarVisibilityOff()
        actor = vtkActor()
        actor.SetMapper(mapper)
        actor.GetProperty().SetColor(*COLOURS[body % len(COLOURS)])
        actor.GetProperty().SetSpecular(0.25)
        actor.GetProperty().SetSpecularPower(30)
        actor.GetProperty().SetAmbient(0.15)
        renderer.AddActor(actor)
    window.AddRenderer(renderer)
    return renderer


def add_caption(window, caption, viewport, font_size):
    from vtkmodules.vtkRenderingCore import vtkRenderer, vtkTextActor

    text = vtkTextActor()
    text.SetInput(caption)
    text.GetTextProperty().SetFontSize(font_size)
    text.GetTextProperty().SetColor(0.1, 0.1, 0.1)
    text.GetTextProperty().SetJustificationToCentered()
    text.GetPositionCoordinate().SetCoordinateSystemToNormalizedViewport()
    text.GetPositionCoordinate().SetValue(0.5, 0.3)
    renderer = vtkRenderer()
    renderer.SetViewport(*viewport)
    renderer.SetBackground(1, 1, 1)
    renderer.AddActor2D(text)
    window.AddRenderer(renderer)


def centre_of(body):
    return [sum(body.GetBounds()[2 * a : 2 * a + 2]) / 2 for a in range(3)]


def viewing_direction(start, end):
    """From above and aside, turned so that the bodies lie beside one another rather than one behind the other."""

    def apart(frame):
        first, second = (centre_of(split(frame, body)) for body in (0, 1))
        return [b - a for a, b in zip(first, second)]

    shift = apart(start)
    side = math.hypot(shift[0], shift[2])
    base = (-shift[2] / side, 0.5, shift[0] / side) if side > 0 else (0, 0.5, 1)
    parting = apart(end)
    length = sum(x * x for x in parting) or 1.0
    along = sum(b * a for b, a in zip(base, parting)) / length
    return [b - 0.4 * along * a for b, a in zip(base, parting)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    length = math.sqrt(sum(x * x for x in a))
    return [x / length for x in a]


def aim(renderers, surfaces, aspect):
    """One camera for both views, so that they can be compared; both bodies fill it at the start or at the end."""
    towards = unit(viewing_direction(*surfaces))
    right = unit(cross((0, 1, 0), towards))
    axes = (right, cross(towards, right))
    points = [surface.GetPoint(i) for surface in surfaces for i in range(surface.GetNumberOfPoints())]
    seen = [[sum(a * x for a, x in zip(axis, point)) for point in points] for axis in axes]
    far = 100 * max(abs(x) for point in points for x in point)  # in front of everything
    middle = [(min(s) + max(s)) / 2 for s in seen]
    half = [(max(s) - min(s)) / 2 for s in seen]
    focus = [middle[0] * r + middle[1] * u for r, u in zip(*axes)]
    camera = renderers[0].GetActiveCamera()
    camera.ParallelProjectionOn()
    camera.SetParallelScale(1.04 * max(half[1], half[0] / aspect))
    camera.SetFocalPoint(*focus)
    camera.SetPosition(*(f + far * t for f, t in zip(focus, towards)))
    camera.SetViewUp(0, 1, 0)
    for renderer in renderers:
        renderer.SetActiveCamera(camera)
        renderer.ResetCameraClippingRange()


def percent_inside(frame):
    inside = frame.GetPointData().GetArray("inside")
    count = inside.GetNumberOfTuples()
    return 100.0 * sum(inside.GetValue(i) for i in range(count)) / count


def draw(pvd, png, width):
    import vtkmodules.vtkRenderingFreeType  # noqa: F401  (draws text)
    import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  (draws everything else)
    from vtkmodules.vtkIOImage import vtkPNGWriter
    from vtkmodules.vtkRenderingCore import vtkRenderWindow, vtkWindowToImageFilter

    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(8)
    window.SetSize(width, width * 9 // 20)
    renderers, surfaces = [], []
    listed = frames(pvd)
    for side, (name, (path, time)) in enumerate((("start", listed[0]), ("end", listed[-1]))):
        frame = read(path)
        surfaces.append(frame)
        caption = f"{name}: {percent_inside(frame):.1f} % of the vertices inside (t = {time:.2f} s)"
        left, right = side / 2, (side + 1) / 2
        renderers.append(add_view(window, frame, (left, CAPTION_HEIGHT, right, 1)))
        add_caption(window, caption, (left, 0, right, CAPTION_HEIGHT), max(12, window.GetSize()[1] // 26))
    aim(renderers, surfaces, (width / 2) / (window.GetSize()[1] * (1 - CAPTION_HEIGHT)))
    window.Render()
    image = vtkWindowToImageFilter()
    image.SetInput(window)
    image.ReadFrontBufferOff()
    writer = vtkPNGWriter()
    writer.SetCompressionLevel(9)
    writer.SetFileName(png)
    writer.SetInputConnection(image.GetOutputPort())
    writer.Write()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pvd", nargs="?", default="out/two_bodies.pvd")
    parser.add_argument("png", nargs="?", help="default: beside the .pvd, with .png")
    parser.add_argument("--width", type=int, default=1600, help="of the picture, pixels (1600)")
    arguments = parser.parse_args()
    png = arguments.png or os.path.splitext(arguments.pvd)[0] + ".png"
    # VTK ends the whole process when there is no X server; say what to do before it does.
    if not os.environ.get("DISPLAY"):
        sys.exit("render_two_bodies: no display; run it under xvfb-run -a (Debian packages xvfb and xauth)")
    try:
        draw(arguments.pvd, png, arguments.width)
    except ImportError as error:
        sys.exit(f"render_two_bodies: {error}; install Debian's python3-vtk9 and use /usr/bin/python3")
    except (OSError, ValueError, ElementTree.ParseError) as error:
        sys.exit(f"render_two_bodies: {error}")
    print(f"wrote {png}")


if __name__ == "__main__":
    main()
