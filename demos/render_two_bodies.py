#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Draws the start and the end of a two_bodies run side by side, off-screen, with VTK.

Usage: render_two_bodies.py [out/two_bodies.pvd [out/two_bodies.png]] [--width PIXELS]

Debian's VTK draws through X: without a display, run it as
    xvfb-run -a /usr/bin/python3 demos/render_two_bodies.py
(packages python3-vtk9, xvfb, xauth).
"""

import argparse
import os
import sys
import xml.etree.ElementTree as ElementTree

COLOURS = ((0.12, 0.42, 0.70), (0.93, 0.53, 0.13))  # blue and orange: told apart by colour-blind readers too


def frames(pvd):
    """The paths of the first and the last frame, with their times."""
    entries = ElementTree.parse(pvd).getroot().findall("./Collection/DataSet")
    if not entries:
        raise ValueError(f"{pvd} lists no frames: run two_bodies again")
    folder = os.path.dirname(os.path.abspath(pvd))
    return [(os.path.join(folder, e.get("file")), float(e.get("timestep"))) for e in (entries[0], entries[-1])]


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


def add_view(window, frame, caption, viewport):
    from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper, vtkRenderer, vtkTextActor

    renderer = vtkRenderer()
    renderer.SetViewport(*viewport)
    renderer.SetBackground(1, 1, 1)
    for body, colour in enumerate(COLOURS):
        mapper = vtkPolyDataMapper()
        mapper.SetInputData(split(frame, body))
        mapper.ScalarVisibilityOff()
        actor = vtkActor()
        actor.SetMapper(mapper)
        actor.GetProperty().SetColor(*colour)
        actor.GetProperty().SetSpecular(0.25)
        actor.GetProperty().SetSpecularPower(30)
        actor.GetProperty().SetAmbient(0.15)
        renderer.AddActor(actor)
    text = vtkTextActor()
    text.SetInput(caption)
    text.GetTextProperty().SetFontSize(max(14, window.GetSize()[1] // 24))
    text.GetTextProperty().SetColor(0.1, 0.1, 0.1)
    text.GetTextProperty().SetJustificationToCentered()
    text.GetPositionCoordinate().SetCoordinateSystemToNormalizedViewport()
    text.GetPositionCoordinate().SetValue(0.5, 0.03)
    renderer.AddActor2D(text)
    window.AddRenderer(renderer)
    return renderer


def centre_of(body):
    return [sum(body.GetBounds()[2 * a : 2 * a + 2]) / 2 for a in range(3)]


def viewing_direction(end):
    """From above and aside, turned so that the bodies lie beside one another rather than one behind the other."""
    base = (0.45, 0.5, 1.0)
    first, second = (centre_of(split(end, body)) for body in (0, 1))
    apart = [b - a for a, b in zip(first, second)]
    length = sum(x * x for x in apart) or 1.0
    along = sum(b * a for b, a in zip(base, apart)) / length
    return [b - 0.7 * along * a for b, a in zip(base, apart)]


def aim(renderers, surfaces):
    """One camera for both views, so that they can be compared."""
    boxes = [surface.GetBounds() for surface in surfaces]
    low = [min(box[2 * a] for box in boxes) for a in range(3)]
    high = [max(box[2 * a + 1] for box in boxes) for a in range(3)]
    centre = [(lo + hi) / 2 for lo, hi in zip(low, high)]
    camera = renderers[0].GetActiveCamera()
    camera.SetFocalPoint(*centre)
    camera.SetPosition(*(c + d for c, d in zip(centre, viewing_direction(surfaces[-1]))))
    camera.SetViewUp(0, 1, 0)
    renderers[0].ResetCamera([value for pair in zip(low, high) for value in pair])
    camera.Zoom(1.35)
    for renderer in renderers[1:]:
        renderer.SetActiveCamera(camera)
    for renderer in renderers:
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
    for side, (name, (path, time)) in enumerate(zip(("start", "end"), frames(pvd))):
        frame = read(path)
        surfaces.append(frame)
        caption = f"{name}: {percent_inside(frame):.1f} % of the vertices inside (t = {time:.2f} s)"
        renderers.append(add_view(window, frame, caption, (side / 2, 0, (side + 1) / 2, 1)))
    aim(renderers, surfaces)
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
