# SPDX-License-Identifier: BSD-3-Clause
"""What VTK does for pictures of bodies in space: surfaces drawn off screen, and plane cuts of meshes.

Needs no display. VTK before 9.4, as of Debian 12, opens X windows alone; it is given a context of
Mesa's software renderer by EGL (libegl1, on which Debian's python3-vtk9 depends), which also draws the same
picture on every machine. Later ones choose by themselves.
"""

import ctypes
import functools
import os
from dataclasses import dataclass

import numpy as np
from command_line import PlotError, missing
from run_results import places

try:
    import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
    from vtkmodules.util.numpy_support import (
        numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy,
    )
    from vtkmodules.vtkCommonCore import vtkLookupTable, vtkObject, vtkPoints, vtkVersion
    from vtkmodules.vtkCommonDataModel import (
        vtkCellArray, vtkPlane, vtkPolyData, vtkUnstructuredGrid,
    )
    from vtkmodules.vtkFiltersCore import vtkCutter, vtkPolyDataNormals
    from vtkmodules.vtkRenderingCore import (
        vtkActor, vtkLight, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkWindowToImageFilter,
    )
    from vtkmodules.vtkRenderingOpenGL2 import vtkGenericOpenGLRenderWindow
except ImportError as error:
    raise PlotError(f"bodies in space are drawn by VTK, but {missing('vtkmodules', error)}") from error

MOST_PIXELS = 4096  # of a side; what is larger is scaled up
SMOOTH = 35.0  # degrees between faces that still are one smooth surface
LIGHT = (-0.3, 0.5, 0.81)  # right, up, towards the viewer

EGL_PLATFORM_SURFACELESS = 0x31DD
EGL_OPENGL_API = 0x30A2
# Attributes end with EGL_NONE.
EGL_CONFIGURATION = (0x3033, 0x0001, 0x3040, 0x0008, 0x3038)  # pbuffers, OpenGL
EGL_CONTEXT = (0x3098, 3, 0x30FB, 2, 0x30FD, 0x0001, 0x3038)  # version 3.2, core profile


@dataclass
class View:
    """Parallel projection: `right` and `up` are unit vectors of the picture; window its limits along these."""

    right: np.ndarray
    up: np.ndarray
    window: np.ndarray  # ((least, most) along right, (least, most) along up)

    @property
    def back(self):
        """Towards the viewer."""
        return np.cross(self.right, self.up)

    def flat(self, points):
        return points @ np.column_stack([self.right, self.up])


def make_context():
    """A surfaceless OpenGL context, current in this thread for the rest of the program."""
    # One renderer for all machines, in the place of a driver that may want a display.
    os.environ.setdefault("LIBGL_ALWAYS_SOFTWARE", "1")
    # It would say so where it cannot write one.
    os.environ.setdefault("MESA_SHADER_CACHE_DISABLE", "true")
    os.environ.setdefault("MESA_GLSL_CACHE_DISABLE", "true")
    try:
        egl = ctypes.CDLL("libEGL.so.1")
    except OSError as error:
        return f"{error}"
    handle, flag = ctypes.c_void_p, ctypes.c_uint
    for name, result, *arguments in (
        ("eglGetPlatformDisplay", handle, flag, handle, handle),
        ("eglInitialize", flag, handle, handle, handle),
        ("eglBindAPI", flag, flag),
        ("eglChooseConfig", flag, handle, handle, handle, ctypes.c_int, handle),
        ("eglCreateContext", handle, handle, handle, handle, handle),
        ("eglMakeCurrent", flag, handle, handle, handle, handle),
    ):
        function = getattr(egl, name)
        function.restype, function.argtypes = result, arguments

    def attributes(values):
        return (ctypes.c_int * len(values))(*values)

    display = egl.eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS, None, None)
    if not display or not egl.eglInitialize(display, None, None):
        return "EGL has no surfaceless platform"
    configuration, count = ctypes.c_void_p(), ctypes.c_int()
    egl.eglBindAPI(EGL_OPENGL_API)
    wanted = attributes(EGL_CONFIGURATION)
    egl.eglChooseConfig(display, wanted, ctypes.byref(configuration), 1, ctypes.byref(count))
    if not count.value:
        return "EGL has no configuration with OpenGL"
    context = egl.eglCreateContext(display, configuration, None, attributes(EGL_CONTEXT))
    if not context or not egl.eglMakeCurrent(display, None, None, context):
        return "EGL makes no context of OpenGL 3.2"
    return None


def knows_x_alone():
    version = vtkVersion()
    return (version.GetVTKMajorVersion(), version.GetVTKMinorVersion()) < (9, 4)


@functools.cache
def render_window():
    """The one window of the program, off screen."""
    if not knows_x_alone():
        window = vtkRenderWindow()
    else:
        reason = make_context()
        if reason:
            raise PlotError(
                f"VTK cannot draw off screen ({reason}): install Debian's packages libegl1 and libgl1-mesa-dri"
            )
        window = vtkGenericOpenGLRenderWindow()
        window.SetReadyForRendering(True)
        window.SetIsCurrent(True)
        # VTK's loader finds all functions, then complains that there is no X display, and VTK stops before it looks at
        # what the context can do: without the last line nothing that has a texture would be drawn.
        vtkObject.GlobalWarningDisplayOff()
        window.OpenGLInit()
        window.OpenGLInitState()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    return window


def cell_array(cells):
    """Cells of one number of nodes each, (cells, nodes)."""
    result = vtkCellArray()
    offsets = np.arange(len(cells) + 1, dtype=np.int64) * cells.shape[1]
    ids = np.ascontiguousarray(cells, dtype=np.int64).ravel()
    # A copy each: VTK keeps no reference to the array of numpy's.
    result.SetData(
        numpy_to_vtkIdTypeArray(offsets, deep=True), numpy_to_vtkIdTypeArray(ids, deep=True)
    )
    return result


def vtk_points(points):
    result = vtkPoints()
    result.SetData(numpy_to_vtk(np.ascontiguousarray(points, dtype=float), deep=True))
    return result


def triangles_of(cells):
    """Flat pieces (cells, 4), where a triangle repeats its last corner, as triangles."""
    both = np.concatenate([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])
    proper = (both[:, 0] != both[:, 1]) & (both[:, 1] != both[:, 2]) & (both[:, 2] != both[:, 0])
    return both[proper]


def lookup_table(colours, norm):
    table = vtkLookupTable()
    table.SetNumberOfTableValues(256)
    for k, colour in enumerate(colours(np.linspace(0, 1, 256))):
        table.SetTableValue(k, *colour)
    table.SetTableRange(norm.vmin, norm.vmax)
    return table


def surface(points, cells, values, colours, norm, lit=True):
    """Pieces coloured by values at the points; lit ones are smooth where the bodies are."""
    used, local = np.unique(triangles_of(cells), return_inverse=True)
    data = vtkPolyData()
    data.SetPoints(vtk_points(points[used]))
    data.SetPolys(cell_array(local.reshape(-1, 3)))
    data.GetPointData().SetScalars(numpy_to_vtk(np.ascontiguousarray(values[used], float), deep=True))
    mapper = vtkPolyDataMapper()
    if lit:
        normals = vtkPolyDataNormals()
        normals.SetInputData(data)
        normals.SetFeatureAngle(SMOOTH)
        normals.ConsistencyOff()
        normals.Update()
        data = normals.GetOutput()
    mapper.SetInputData(data)
    mapper.SetLookupTable(lookup_table(colours, norm))
    mapper.UseLookupTableScalarRangeOn()
    # Colours between nodes are those of the values between, not mixtures.
    mapper.InterpolateScalarsBeforeMappingOn()
    mapper.SetResolveCoincidentTopologyToPolygonOffset()
    actor = vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    if lit:
        look.SetAmbient(0.6)
        look.SetDiffuse(0.45)
        look.SetSpecular(0.0)
        look.SetInterpolationToPhong()
    else:
        look.LightingOff()
    return actor


def lines(points, pairs, colour, width, before=4.0):
    """Line segments between pairs of points, a little before the surface they lie on, by steps of depth.

    None is translucent: VTK's pass for these does not see what hides them in a window of this kind.
    """
    used, local = np.unique(pairs, return_inverse=True)
    data = vtkPolyData()
    data.SetPoints(vtk_points(points[used]))
    data.SetLines(cell_array(local.reshape(-1, 2)))
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(data)
    mapper.SetRelativeCoincidentTopologyLineOffsetParameters(-1.0, -before)
    actor = vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetColor(*colour)
    look.SetLineWidth(width)
    look.LightingOff()
    return actor


def picture(actors, view, size, depth, background=(1.0, 1.0, 1.0)):
    """The actors as an image (height, width, 3) of about `size` pixels, twice as fine within.

    depth   (least, most) of all points along view.back
    """
    share = min(1.0, MOST_PIXELS / max(size))
    width, height = (max(2, round(share * pixels)) for pixels in size)
    fine = 2 if 2 * max(width, height) <= MOST_PIXELS else 1
    window = render_window()
    renderer = vtkRenderer()
    renderer.SetBackground(*background)
    renderer.RemoveAllLights()
    light = vtkLight()
    light.SetLightTypeToCameraLight()
    light.SetPosition(*LIGHT)
    light.SetFocalPoint(0, 0, 0)
    renderer.AddLight(light)
    renderer.AutomaticLightCreationOff()
    for actor in actors:
        if actor.GetMapper().GetInput().GetNumberOfPoints():
            actor.GetProperty().SetLineWidth(fine * actor.GetProperty().GetLineWidth())
            renderer.AddActor(actor)

    camera = renderer.GetActiveCamera()
    camera.ParallelProjectionOn()
    middle = view.window.mean(axis=1)
    focus = middle[0] * view.right + middle[1] * view.up + np.mean(depth) * view.back
    length = float(max(np.ptp(depth), np.ptp(view.window, axis=1).max())) or 1.0
    camera.SetFocalPoint(*focus)
    camera.SetPosition(*(focus + 2 * length * view.back))
    camera.SetViewUp(*view.up)
    camera.SetClippingRange(length, 3 * length)
    camera.SetParallelScale(np.ptp(view.window[1]) / 2)

    window.AddRenderer(renderer)
    window.SetSize(fine * width, fine * height)
    window.Render()
    grabber = vtkWindowToImageFilter()
    grabber.SetInput(window)
    grabber.SetInputBufferTypeToRGBA()
    grabber.ReadFrontBufferOff()
    grabber.Update()
    image = grabber.GetOutput()
    columns, rows, _ = image.GetDimensions()
    pixels = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(rows, columns, -1)[::-1, :, :3]
    pixels = pixels.reshape(rows // fine, fine, columns // fine, fine, 3).mean(axis=(1, 3))
    window.RemoveRenderer(renderer)
    return np.rint(pixels).astype(np.uint8)


def cut(points, volumes, values, origin, normal):
    """The cells cut by a plane: points, triangles and the values there.

    volumes  cells (cells, nodes) by type of VTK's
    values   (points, any number of columns)
    """
    side = (points - origin) @ normal
    grid = vtkUnstructuredGrid()
    chosen = {}
    for kind, nodes in volumes.items():
        across = (side[nodes].min(axis=1) < 0) & (side[nodes].max(axis=1) >= 0)
        if across.any():
            chosen[kind] = nodes[across]
    if not chosen:
        return np.empty((0, 3)), np.empty((0, 3), dtype=int), np.empty((0, values.shape[1]))
    used = np.unique(np.concatenate([nodes.ravel() for nodes in chosen.values()]))
    local = np.zeros(len(points), dtype=np.int64)
    local[used] = np.arange(len(used))
    grid.SetPoints(vtk_points(points[used]))
    kinds = np.concatenate([np.full(len(n), kind, dtype=np.uint8) for kind, n in chosen.items()])
    sizes = np.concatenate([np.full(len(n), n.shape[1]) for n in chosen.values()])
    ids = np.concatenate([local[nodes].ravel() for nodes in chosen.values()])
    cells = vtkCellArray()
    offsets = np.concatenate([[0], np.cumsum(sizes)])
    cells.SetData(
        numpy_to_vtkIdTypeArray(offsets, deep=True), numpy_to_vtkIdTypeArray(ids, deep=True)
    )
    grid.SetCells(numpy_to_vtk(kinds, deep=True), cells)
    array = numpy_to_vtk(np.ascontiguousarray(values[used], dtype=float), deep=True)
    array.SetName("values")
    grid.GetPointData().AddArray(array)

    plane = vtkPlane()
    plane.SetOrigin(*origin)
    plane.SetNormal(*normal)
    cutter = vtkCutter()
    cutter.SetInputData(grid)
    cutter.SetCutFunction(plane)
    cutter.Update()
    result = cutter.GetOutput()
    if not result.GetNumberOfPolys():
        return np.empty((0, 3)), np.empty((0, 3), dtype=int), np.empty((0, values.shape[1]))
    triangles = vtk_to_numpy(result.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    found = vtk_to_numpy(result.GetPointData().GetArray("values")).reshape(-1, values.shape[1])
    at = vtk_to_numpy(result.GetPoints().GetData()).astype(float)
    # Cells of first order have brought points of their own.
    place = places(at, np.zeros(len(at), dtype=np.int64))
    first = np.unique(place, return_index=True)[1]
    triangles = place[triangles]
    proper = (np.diff(np.sort(triangles, axis=1), axis=1) > 0).all(axis=1)
    return at[first], triangles[proper], found[first]
