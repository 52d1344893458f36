#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Draws what run_scene --obj wrote, off-screen, with VTK (Debian: python3-vtk9, xvfb, xauth).

Usage: xvfb-run -a /usr/bin/python3 draw_scene.py scene.obj picture.png [--width PIXELS]
Exit status: 0 drawn; 1 the file has no bodies; 2 wrong usage.
"""
import argparse
import sys

COLOURS = ((0.12, 0.42, 0.70), (0.93, 0.53, 0.13), (0.35, 0.70, 0.90), (0.95, 0.90, 0.25), (0.00, 0.62, 0.45),
           (0.80, 0.47, 0.65), (0.84, 0.37, 0.00))


def bodies(path):
    """Points of the file, and the triangles of each body."""
    points, found = [], []
    with open(path, encoding="utf-8") as lines:
        for line in lines:
            word, *rest = line.split()
            if word == "o":
                found.append([])
            elif word == "v":
                points.append([float(number) for number in rest])
            elif word == "f":
                found[-1].append([int(number) - 1 for number in rest])
    return points, found


def actor(points, triangles, colour, is_floor):
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
    from vtkmodules.vtkFiltersCore import vtkPolyDataNormals
    from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

    data, places, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    for point in points:
        places.InsertNextPoint(point)
    for triangle in triangles:
        cells.InsertNextCell(3, triangle)
    data.SetPoints(places)
    data.SetPolys(cells)
    normals = vtkPolyDataNormals()
    normals.SetInputData(data)
    mapper = vtkPolyDataMapper()
    mapper.SetInputConnection(normals.GetOutputPort())
    result = vtkActor()
    result.SetMapper(mapper)
    result.GetProperty().SetColor(colour)
    result.GetProperty().SetOpacity(0.35 if is_floor else 1)
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene")
    parser.add_argument("picture")
    parser.add_argument("--width", type=int, default=640)
    arguments = parser.parse_args()
    points, found = bodies(arguments.scene)
    if not found:
        print(f"draw_scene.py: {arguments.scene} has no bodies", file=sys.stderr)
        return 1
    import vtkmodules.vtkInteractionStyle  # noqa: F401
    import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
    from vtkmodules.vtkIOImage import vtkPNGWriter
    from vtkmodules.vtkRenderingCore import vtkRenderer, vtkRenderWindow, vtkWindowToImageFilter

    renderer = vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    for number, triangles in enumerate(found):
        is_floor = len(triangles) < 10
        colour = (0.6, 0.6, 0.6) if is_floor else COLOURS[number % len(COLOURS)]
        renderer.AddActor(actor(points, triangles, colour, is_floor))
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(8)
    window.SetSize(arguments.width, arguments.width * 9 // 16)
    window.AddRenderer(renderer)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(30, 42, 62)
    camera.SetFocalPoint(0, 1, 4)
    camera.SetViewUp(0, 1, 0)
    renderer.ResetCameraClippingRange()
    window.Render()
    image = vtkWindowToImageFilter()
    image.SetInput(window)
    writer = vtkPNGWriter()
    writer.SetFileName(arguments.picture)
    writer.SetInputConnection(image.GetOutputPort())
    writer.Write()
    return 0


if __name__ == "__main__":
    sys.exit(main())
