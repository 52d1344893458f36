#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Draws runs beside one another as one moving picture: rows of scenes, columns of contact methods, as a .gif.

Usage: render_moving_picture.py GIF TITLE=PVD@SECONDS... [--columns N] [--frames N] [--width PIXELS]

Runs of one row start alike and share a camera; each is shown up to its SECONDS, and the last frame is held. As
render_two_bodies.py it needs X: run it under xvfb-run -a (packages python3-vtk9, python3-pil, xvfb, xauth).
"""

import argparse
import os
import sys
import xml.etree.ElementTree as ElementTree
from typing import NamedTuple

import render_two_bodies as pictures


class Run(NamedTuple):
    title: str
    frames: list  # paths and times
    seconds: float

    def at(self, part):
        """The surface and time of the frame nearest to this part of the time shown."""
        path, time = min(self.frames, key=lambda frame: abs(frame[1] - part * self.seconds))
        return pictures.read(path), time


def run_of(text):
    title, _, rest = text.partition("=")
    pvd, _, seconds = rest.rpartition("@")
    if not pvd:
        raise ValueError(f"'{text}' is not TITLE=PVD@SECONDS")
    return Run(title, pictures.frames(pvd), float(seconds))


def picture(window, runs, columns, part):
    """One frame of all runs, as an image of Pillow's."""
    from PIL import Image
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkRenderingCore import vtkWindowToImageFilter

    renderers = window.GetRenderers()
    while renderers.GetNumberOfItems():
        window.RemoveRenderer(renderers.GetFirstRenderer())
    rows = -(-len(runs) // columns)
    for row in range(rows):
        beside = runs[row * columns : (row + 1) * columns]
        views = []
        for column, run in enumerate(beside):
            frame, time = run.at(part)
            left, right = column / columns, (column + 1) / columns
            bottom, top = (rows - 1 - row) / rows, (rows - row) / rows
            middle = bottom + pictures.CAPTION_HEIGHT * (top - bottom)
            views.append(pictures.add_view(window, frame, (left, middle, right, top)))
            caption = f"{run.title}: {pictures.percent_inside(frame):.0f} % inside at {time:.2f} s"
            font_size = max(9, window.GetSize()[0] // (columns * 28))
            pictures.add_caption(window, caption, (left, bottom, right, middle), font_size)
        # One camera a row, for the whole of the first run: so all frames can be compared.
        ends = [beside[0].at(0)[0], beside[0].at(1)[0]]
        width, height = window.GetSize()
        pictures.aim(views, ends, (width / columns) / (height / rows * (1 - pictures.CAPTION_HEIGHT)))
    window.Render()
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    grab.Update()
    image = grab.GetOutput()
    width, height, _ = image.GetDimensions()
    pixels = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, -1)[::-1, :, :3]
    return Image.fromarray(pixels.copy())


def draw(gif, runs, columns, count, width):
    import vtkmodules.vtkRenderingFreeType  # noqa: F401  (draws text)
    import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  (draws everything else)
    from vtkmodules.vtkRenderingCore import vtkRenderWindow

    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(8)
    window.SetSize(width, -(-len(runs) // columns) * width * 2 // (3 * columns))
    drawn = []
    for number in range(count):
        drawn.append(picture(window, runs, columns, number / (count - 1)))
        if sys.stderr.isatty():
            print(f"\rframe {number + 1} of {count}", end="", file=sys.stderr)
    # One palette for all frames, without dithering: what does not move takes no bytes.
    palette = drawn[count // 2].quantize(48)
    drawn = [frame.quantize(palette=palette, dither=0) for frame in drawn]
    times = [700] + [90] * (count - 2) + [2000]
    drawn[0].save(gif, save_all=True, append_images=drawn[1:], duration=times, loop=0, optimize=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("gif")
    parser.add_argument("runs", nargs="+", metavar="TITLE=PVD@SECONDS")
    parser.add_argument("--columns", type=int, default=2, help="runs beside one another (2)")
    parser.add_argument("--frames", type=int, default=30, help="of the picture (30)")
    parser.add_argument("--width", type=int, default=720, help="of the picture, pixels (720)")
    arguments = parser.parse_args()
    if arguments.columns < 1 or arguments.frames < 2 or arguments.width < 100:
        parser.error("give at least 1 column, 2 frames and 100 pixels")
    # VTK ends the whole process when there is no X server; say what to do before it does.
    if not os.environ.get("DISPLAY"):
        sys.exit("render_moving_picture: no display; run it under xvfb-run -a (Debian packages xvfb and xauth)")
    try:
        runs = [run_of(text) for text in arguments.runs]
        draw(arguments.gif, runs, arguments.columns, arguments.frames, arguments.width)
    except ImportError as error:
        sys.exit(f"render_moving_picture: {error}; install Debian's python3-vtk9 and python3-pil, use /usr/bin/python3")
    except (OSError, ValueError, ElementTree.ParseError) as error:
        sys.exit(f"render_moving_picture: {error}")
    print(f"wrote {arguments.gif}")


if __name__ == "__main__":
    main()
