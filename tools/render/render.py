#!/usr/bin/python3
"""Draws result files of Lariat (.vtu) as a picture: the body as it is deformed, panel by panel.

    xvfb-run -a tools/render/render.py --out uterus.png results/uterus_000000.vtu \\
        results/uterus_000030.vtu --caption "at rest" --caption "pulled" --color parts
    xvfb-run -a tools/render/render.py --out stress.png --color von_mises results/uterus_000030.vtu
    xvfb-run -a tools/render/render.py --film --out film results/uterus.pvd

Needs VTK for the system's Python, and a display; without one, a virtual display does:

    apt-get install python3-vtk9 xvfb xauth

Nothing else in Lariat needs either. pictures.sh beside this file makes the pictures of docs/images.
"""
import argparse
import math
import os
import shutil
import subprocess
import xml.etree.ElementTree

import numpy
import vtkmodules.vtkRenderingFreeType  # noqa: F401  (text)
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  (the graphics backend)
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkLookupTable
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkCommonTransforms import vtkTransform
from vtkmodules.vtkFiltersCore import (vtkAppendFilter, vtkCellDataToPointData, vtkFeatureEdges,
                                       vtkImageAppend, vtkPolyDataNormals, vtkThreshold)
from vtkmodules.vtkFiltersGeneral import vtkTransformPolyDataFilter, vtkWarpVector
from vtkmodules.vtkFiltersGeometry import vtkDataSetSurfaceFilter
from vtkmodules.vtkFiltersSources import vtkArrowSource
from vtkmodules.vtkImagingCore import vtkImageResize
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
from vtkmodules.vtkRenderingAnnotation import vtkScalarBarActor
from vtkmodules.vtkRenderingCore import (vtkActor, vtkLight, vtkPolyDataMapper, vtkRenderer,
                                         vtkRenderWindow, vtkTextActor, vtkWindowToImageFilter)
from vtkmodules.vtkRenderingOpenGL2 import vtkRenderStepsPass, vtkSSAOPass

# Colours of the parts of the demonstration organ by cell tag (1 to 4), then of other tags.
PARTS = [(208, 112, 102), (224, 148, 128), (236, 208, 182), (200, 160, 148),
         (150, 170, 200), (170, 200, 160)]
# Of processors, in turn: neighbours in number differ in hue.
PROCESSORS = [(208, 112, 102), (110, 160, 180), (232, 190, 110), (140, 168, 120), (176, 132, 172),
              (226, 150, 110), (96, 128, 160), (200, 180, 150), (120, 176, 160), (196, 116, 140),
              (170, 170, 120), (140, 140, 190)]
FINE = 2  # drawn so many times larger and averaged: no jagged edges
INK = (0.16, 0.16, 0.18)
# Light where nothing happens, dark where most does; the lightness falls evenly.
STOPS = [(0.00, (240, 232, 222)), (0.22, (250, 200, 140)), (0.48, (238, 118, 82)),
         (0.74, (180, 44, 92)), (1.00, (66, 16, 82))]


def pull_apart(grid, factor):
    """Moves the part of each processor away from the middle, by this share of its distance."""
    middle = numpy.array(grid.GetCenter())
    parts = vtkAppendFilter()
    count = int(grid.GetCellData().GetArray("processor").GetRange()[1]) + 1
    for p in range(count):
        part = vtkThreshold()
        part.SetInputData(grid)
        part.SetInputArrayToProcess(0, 0, 0, 1, "processor")
        part.SetLowerThreshold(p - 0.5)
        part.SetUpperThreshold(p + 0.5)
        part.Update()
        piece = part.GetOutput()
        points = vtk_to_numpy(piece.GetPoints().GetData())
        points += (factor * (points.mean(axis=0) - middle)).astype(points.dtype)
        parts.AddInputData(piece)
    parts.Update()
    return parts.GetOutput()


def read_grid(path, scale, color, apart):
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    grid = reader.GetOutput()
    if grid.GetNumberOfCells() == 0:
        raise SystemExit(f"{path}: no cells could be read; give a .vtu that lariat run wrote")
    wanted = "tag" if color == "parts" else color
    if not grid.GetCellData().HasArray(wanted) and not grid.GetPointData().HasArray(wanted):
        raise SystemExit(f"{path}: there is no array '{wanted}'; choose another --color, or add "
                         "the field to the scene's output")
    if grid.GetPointData().HasArray("displacement"):
        grid.GetPointData().SetActiveVectors("displacement")
        warp = vtkWarpVector()
        warp.SetInputData(grid)
        warp.SetScaleFactor(scale)
        warp.Update()
        grid = warp.GetOutput()
    return pull_apart(grid, apart) if color == "processor" and apart > 0 else grid


def surface_of(grid, crease):
    """The boundary, shaded smoothly up to the crease angle; cell arrays become point arrays too."""
    surface = vtkDataSetSurfaceFilter()
    surface.SetInputData(grid)
    points = vtkCellDataToPointData()
    points.SetInputConnection(surface.GetOutputPort())
    points.PassCellDataOn()
    normals = vtkPolyDataNormals()
    normals.SetInputConnection(points.GetOutputPort())
    normals.SetSplitting(crease < 180)
    normals.SetFeatureAngle(crease)
    normals.ConsistencyOn()
    normals.Update()
    return normals.GetOutput()


def color_by_parts(surface, processors):
    """Mixes the colours of the parts at their common nodes, as tissue does."""
    if processors:
        number = vtk_to_numpy(surface.GetCellData().GetArray("processor")).astype(int)
        cell = numpy.array(PROCESSORS, dtype=float)[number % len(PROCESSORS)]
    else:
        tags = vtk_to_numpy(surface.GetCellData().GetArray("tag")).astype(int)
        cell = numpy.array(PARTS, dtype=float)[numpy.clip(tags - 1, 0, len(PARTS) - 1)]
    total = numpy.zeros((surface.GetNumberOfPoints(), 3))
    count = numpy.zeros(surface.GetNumberOfPoints())
    for c in range(surface.GetNumberOfCells()):
        ids = surface.GetCell(c).GetPointIds()
        for k in range(ids.GetNumberOfIds()):
            total[ids.GetId(k)] += cell[c]
            count[ids.GetId(k)] += 1
    mixed = (total / count[:, None]).astype(numpy.uint8)
    array = numpy_to_vtk(mixed, deep=True)
    array.SetName("color")
    surface.GetPointData().SetScalars(array)


def lookup_table(low, high):
    table = vtkLookupTable()
    table.SetNumberOfTableValues(256)
    table.SetRange(low, high)
    for i in range(256):
        t = i / 255
        k = max(j for j in range(len(STOPS) - 1) if STOPS[j][0] <= t)
        (t0, a), (t1, b) = STOPS[k], STOPS[k + 1]
        s = (t - t0) / (t1 - t0)
        table.SetTableValue(i, *[(a[j] + s * (b[j] - a[j])) / 255 for j in range(3)], 1)
    table.Build()
    return table


def body_actor(surface, options, table):
    mapper = vtkPolyDataMapper()
    if options.color in ("parts", "processor"):
        color_by_parts(surface, options.color == "processor")
    else:
        surface.GetPointData().SetActiveScalars(options.color)
        mapper.SetLookupTable(table)
        mapper.UseLookupTableScalarRangeOn()
        mapper.InterpolateScalarsBeforeMappingOn()
    mapper.SetInputData(surface)
    actor = vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetInterpolationToPhong()
    look.SetAmbient(0.16)
    look.SetDiffuse(0.84)
    look.SetSpecular(0.32 if options.color == "parts" else 0.12)
    look.SetSpecularPower(38)
    return actor


def edge_actor(surface, opacity, width):
    """The edges of the elements on the surface."""
    edges = vtkFeatureEdges()
    edges.SetInputData(surface)
    edges.BoundaryEdgesOn()
    edges.ManifoldEdgesOn()
    edges.FeatureEdgesOff()
    edges.NonManifoldEdgesOn()
    edges.ColoringOff()
    mapper = vtkPolyDataMapper()
    mapper.SetInputConnection(edges.GetOutputPort())
    mapper.ScalarVisibilityOff()
    mapper.SetResolveCoincidentTopologyToPolygonOffset()
    mapper.SetRelativeCoincidentTopologyLineOffsetParameters(-1, -1)
    actor = vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetColor(0.20, 0.06, 0.05)
    look.SetOpacity(opacity)
    look.SetLineWidth(width)
    look.LightingOff()
    return actor


def arrow_actor(at, vector):
    """An arrow from `at` along `vector` (both in metres)."""
    length = math.sqrt(sum(x * x for x in vector))
    source = vtkArrowSource()
    source.SetTipResolution(40)
    source.SetShaftResolution(40)
    source.SetShaftRadius(0.045)
    source.SetTipRadius(0.13)
    source.SetTipLength(0.36)
    yaw = math.degrees(math.atan2(vector[1], vector[0]))
    pitch = math.degrees(math.asin(vector[2] / length))
    transform = vtkTransform()
    transform.Translate(*at)
    transform.RotateZ(yaw)
    transform.RotateY(-pitch)
    transform.Scale(length, length, length)
    moved = vtkTransformPolyDataFilter()
    moved.SetTransform(transform)
    moved.SetInputConnection(source.GetOutputPort())
    mapper = vtkPolyDataMapper()
    mapper.SetInputConnection(moved.GetOutputPort())
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(0.10, 0.34, 0.52)
    actor.GetProperty().SetSpecular(0.2)
    return actor


def text_actor(text, size, x, y, center=True):
    actor = vtkTextActor()
    actor.SetInput(text)
    look = actor.GetTextProperty()
    look.SetFontFamilyToArial()
    look.SetFontSize(size)
    look.SetColor(*INK)
    if center:
        look.SetJustificationToCentered()
    actor.GetPositionCoordinate().SetCoordinateSystemToNormalizedViewport()
    actor.SetPosition(x, y)
    return actor


def legend_actor(table, title, size):
    bar = vtkScalarBarActor()
    bar.SetLookupTable(table)
    bar.SetTitle(title.replace("\\n", "\n"))
    bar.SetNumberOfLabels(5)
    bar.SetLabelFormat("%.0f")
    bar.UnconstrainedFontSizeOn()
    bar.SetBarRatio(0.25)
    bar.SetPosition(0.86, 0.16)
    bar.SetWidth(0.10)
    bar.SetHeight(0.64)
    bar.SetVerticalTitleSeparation(int(0.6 * size))
    for look in (bar.GetTitleTextProperty(), bar.GetLabelTextProperty()):
        look.SetColor(*INK)
        look.SetFontFamilyToArial()
        look.SetFontSize(size)
        look.ItalicOff()
        look.BoldOff()
        look.ShadowOff()
    return bar


def add_lights(renderer):
    """A key light beside the camera, as an endoscope has it, and a weak one from the other side."""
    renderer.RemoveAllLights()
    renderer.AutomaticLightCreationOff()
    for position, strength, color in (((0.35, 0.55, 1.0), 0.92, (1.0, 0.985, 0.96)),
                                      ((-0.9, 0.1, 0.4), 0.26, (0.84, 0.90, 1.0)),
                                      ((0.2, -0.9, 0.3), 0.14, (1.0, 0.93, 0.90))):
        light = vtkLight()
        light.SetLightTypeToCameraLight()
        light.SetPosition(*position)
        light.SetFocalPoint(0, 0, 0)
        light.SetIntensity(strength)
        light.SetColor(*color)
        renderer.AddLight(light)


def add_occlusion(renderer, bounds):
    """Darkens creases, which tells the eye what lies in front of what."""
    size = math.sqrt(sum((bounds[2 * i + 1] - bounds[2 * i]) ** 2 for i in range(3)))
    occlusion = vtkSSAOPass()
    occlusion.SetRadius(0.07 * size)
    occlusion.SetBias(0.004 * size)
    occlusion.SetKernelSize(128)
    occlusion.BlurOn()
    occlusion.SetDelegatePass(vtkRenderStepsPass())
    renderer.SetPass(occlusion)


def aim(renderer, bounds, options):
    """Looks at the middle of the bounds from azimuth (0: from the front, -y) and elevation."""
    azimuth, elevation = math.radians(options.azimuth), math.radians(options.elevation)
    center = [(bounds[2 * i] + bounds[2 * i + 1]) / 2 for i in range(3)]
    size = math.sqrt(sum((bounds[2 * i + 1] - bounds[2 * i]) ** 2 for i in range(3)))
    direction = (math.sin(azimuth) * math.cos(elevation), -math.cos(azimuth) * math.cos(elevation),
                 math.sin(elevation))
    camera = renderer.GetActiveCamera()
    camera.SetFocalPoint(*center)
    camera.SetPosition(*[center[i] + 4 * size * direction[i] for i in range(3)])
    camera.SetViewUp(0, 0, 1)
    camera.SetViewAngle(15 / options.zoom)
    renderer.ResetCameraClippingRange(*bounds)


def parse_arguments():
    parser = argparse.ArgumentParser(description="Draws result files of Lariat as a picture.")
    parser.add_argument("frames", nargs="+", metavar="FRAME.vtu",
                        help="one panel each; a .pvd stands for all of its frames")
    parser.add_argument("--out", required=True, metavar="FILE.png", help="with --film: a folder")
    parser.add_argument("--film", action="store_true",
                        help="a picture of each frame, numbered, all seen alike; and a video where "
                        "ffmpeg is installed")
    parser.add_argument("--rate", type=float, default=25.0,
                        help="pictures per second of the video")
    parser.add_argument("--color", default="parts",
                        help="parts (cell tags), processor (a file of lariat partition --vtu), "
                        "or the name of an array, such as von_mises")
    parser.add_argument("--apart", type=float, default=0.0,
                        help="with --color processor: pulls the parts apart by this share")
    parser.add_argument("--range", nargs=2, type=float, metavar=("LOW", "HIGH"),
                        help="of the colours; the array's own when left out")
    parser.add_argument("--legend", default="", help="title of the colour legend")
    parser.add_argument("--caption", action="append", default=[], help="under a panel, in order")
    parser.add_argument("--arrow", nargs=7, type=float, action="append", default=[],
                        metavar=("PANEL", "X", "Y", "Z", "DX", "DY", "DZ"),
                        help="an arrow in a panel (counted from 0): from where, and how far [m]")
    parser.add_argument("--together", action="store_true", help="all frames in one panel")
    parser.add_argument("--scale", type=float, default=1.0, help="of the displacements")
    parser.add_argument("--azimuth", type=float, default=0.0, help="degrees, 0 looks along +y")
    parser.add_argument("--elevation", type=float, default=15.0, help="degrees")
    parser.add_argument("--zoom", type=float, default=1.0)
    parser.add_argument("--shift", type=float, default=0.0,
                        help="moves the body up by this share of its height")
    parser.add_argument("--edges", type=float, default=0.25, help="opacity of element edges")
    parser.add_argument("--crease", type=float, default=180.0,
                        help="degrees; sharper edges than this stay sharp")
    parser.add_argument("--size", nargs=2, type=int, default=(1400, 700), metavar=("W", "H"))
    return parser.parse_args()


def draw(renderer, width, height):
    """One panel as an image; the passes of VTK 9.1 draw one renderer per window."""
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(width, height)
    window.AddRenderer(renderer)
    window.Render()
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    grab.Update()
    image = vtkImageData()
    image.DeepCopy(grab.GetOutput())
    return image


def frames_of(paths):
    """The frames, with those of a series in the place of its .pvd."""
    frames = []
    for path in paths:
        if not path.endswith(".pvd"):
            frames.append(path)
            continue
        sets = xml.etree.ElementTree.parse(path).getroot().iter("DataSet")
        frames += [os.path.join(os.path.dirname(path), s.get("file")) for s in sets]
    return frames


def surface_from(path, options):
    return surface_of(read_grid(path, options.scale, options.color, options.apart), options.crease)


def measure(surface, options):
    """Corners of the body, and the range of its colours."""
    if options.color in ("parts", "processor"):
        return surface.GetBounds(), (0, 0)
    values = vtk_to_numpy(surface.GetPointData().GetArray(options.color))
    return surface.GetBounds(), (values.min(), values.max())


def common(measures, options):
    """Bounds and colours that fit all of them."""
    bounds = [(min if i % 2 == 0 else max)(m[0][i] for m in measures) for i in range(6)]
    for i in (4, 5):
        bounds[i] -= options.shift * (bounds[5] - bounds[4])
    if options.color in ("parts", "processor"):
        return bounds, None
    low, high = options.range or (min(m[1][0] for m in measures), max(m[1][1] for m in measures))
    return bounds, lookup_table(low, high)


def draw_panel(number, surfaces, last, width, view, options):
    """Panel `number` with these surfaces; the last one has the legend."""
    bounds, table = view
    renderer = vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    for surface in surfaces:
        renderer.AddActor(body_actor(surface, options, table))
        if options.edges > 0:
            renderer.AddActor(edge_actor(surface, options.edges, 0.9 * FINE))
    for arrow in options.arrow:
        if int(arrow[0]) == number:
            renderer.AddActor(arrow_actor(arrow[1:4], arrow[4:7]))
    if number < len(options.caption):
        renderer.AddActor2D(text_actor(options.caption[number], 20 * FINE, 0.5, 0.05))
    if table and last:
        renderer.AddActor2D(legend_actor(table, options.legend or options.color, 16 * FINE))
    add_lights(renderer)
    add_occlusion(renderer, bounds)
    aim(renderer, bounds, options)
    return draw(renderer, FINE * width, FINE * options.size[1])


def write_png(path, panels, options):
    join = vtkImageAppend()
    join.SetAppendAxis(0)
    for panel in panels:
        join.AddInputData(panel)
    small = vtkImageResize()
    small.SetInputConnection(join.GetOutputPort())
    small.SetOutputDimensions(*options.size, 1)
    small.InterpolateOn()
    writer = vtkPNGWriter()
    writer.SetCompressionLevel(9)
    writer.SetFileName(path)
    writer.SetInputConnection(small.GetOutputPort())
    writer.Write()


def picture(options):
    surfaces = [surface_from(path, options) for path in frames_of(options.frames)]
    view = common([measure(surface, options) for surface in surfaces], options)
    groups = [surfaces] if options.together else [[surface] for surface in surfaces]
    width = options.size[0] // len(groups)
    panels = [draw_panel(i, group, i == len(groups) - 1, width, view, options)
              for i, group in enumerate(groups)]
    write_png(options.out, panels, options)


def film(options):
    """A picture of each frame, all seen alike: read twice, so that memory holds one at a time."""
    frames = frames_of(options.frames)
    view = common([measure(surface_from(path, options), options) for path in frames], options)
    os.makedirs(options.out, exist_ok=True)
    for i, path in enumerate(frames):
        panel = draw_panel(0, [surface_from(path, options)], True, options.size[0], view, options)
        write_png(os.path.join(options.out, f"frame_{i:06d}.png"), [panel], options)
    print(f"{options.out}: {len(frames)} pictures, frame_000000.png and so on")
    if not shutil.which("ffmpeg"):
        print("no ffmpeg here, so no video; with it: ffmpeg -framerate "
              f"{options.rate:g} -i {options.out}/frame_%06d.png -pix_fmt yuv420p film.mp4")
        return
    video = os.path.join(options.out, "film.mp4")
    subprocess.run(["ffmpeg", "-loglevel", "error", "-y", "-framerate", f"{options.rate:g}", "-i",
                    os.path.join(options.out, "frame_%06d.png"), "-pix_fmt", "yuv420p", video],
                   check=True)
    print(f"{video}: {len(frames) / options.rate:.1f} s")


if __name__ == "__main__":
    if not os.environ.get("DISPLAY"):
        raise SystemExit("render.py: there is no display; put xvfb-run -a in front of the command")
    arguments = parse_arguments()
    if arguments.film:
        film(arguments)
    else:
        picture(arguments)
