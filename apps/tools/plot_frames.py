# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of a run of several steps: the last one as solution.png, and with --frames all of them, friction and damage too.

result.vtkhdf.series names the results in their order, and their times, as ParaView wants it. All frames have the same
scale, colours and place of the viewer, which first takes a look at every result.
"""

import json
import re
from dataclasses import dataclass
from pathlib import Path

import plot_damage
import plot_deformed
import plot_friction
import plot_solution
from command_line import PlotError
from plot_style import STYLE, caption_of, save, whole
from run_results import Solid, read_result

import matplotlib.pyplot as plt

KEPT = 256e6  # bytes of results; more are read again each time they are looked at
WIDEST = 1000  # pixels of the animation
SECONDS = 6.0  # of the animation, where steps need not be faster than 12 or slower than 2 a second


@dataclass
class Frame:
    path: Path
    time: float

    @property
    def number(self):
        """That of the step, from the name; None if that has none."""
        found = re.search(r"_(\d+)\.vtkhdf$", self.path.name)
        return int(found[1]) if found else None

    @property
    def text(self):
        step = f"step {self.number} \u00b7 " if self.number is not None else ""
        return f"{step}time {self.time:.6g}"


def read_series(path):
    """The results of a run of several steps, in their order."""
    try:
        files = json.loads(path.read_text(encoding="utf-8"))["files"]
        frames = [Frame(path.parent / file["name"], float(file["time"])) for file in files]
    except (ValueError, LookupError, TypeError) as error:
        fault = f"{type(error).__name__}: {error}"
        raise PlotError(f"{path}: no series of results ({fault}); repeat the run") from error
    if not frames:
        raise PlotError(f"{path}: no result in the series; repeat the run")
    for frame in frames:
        if not frame.path.is_file():
            raise PlotError(f"{path}: names {frame.path.name}, which does not exist; repeat the run")
    return frames


def frames_of(directory):
    """Of a run of several steps all results, else the one there is or none."""
    result, series = directory / "result.vtkhdf", directory / "result.vtkhdf.series"
    # What an earlier run of another kind has left is older.
    if series.exists() and not (
        result.exists() and result.stat().st_mtime_ns > series.stat().st_mtime_ns
    ):
        return read_series(series)
    return [Frame(result, None)] if result.exists() else []


class Results:
    """The results in turn, as often as one likes, without having all of many in memory."""

    def __init__(self, frames):
        self.frames = frames
        size = sum(frame.path.stat().st_size for frame in frames)
        self.kept = {} if size <= KEPT else None

    def __iter__(self):
        for k in range(len(self.frames)):
            yield self[k]

    def __getitem__(self, k):
        if self.kept is None:
            return read_result(self.frames[k].path)
        if k not in self.kept:
            self.kept[k] = read_result(self.frames[k].path)
        return self.kept[k]


def painter_of(field):
    """The module that draws a result like this: look_of(results) and a picture."""
    if not isinstance(field, Solid):
        return plot_solution, plot_solution.plot_solution
    if field.dimension == 2:
        return plot_deformed, lambda field, *more, **named: plot_deformed.plot_deformed(
            [field], *more, **named
        )
    # By VTK, which nothing else needs.
    import plot_solid

    return plot_solid, plot_solid.plot_solid


def caption_at(summary, frame):
    """With the energy of the step, not of the last one."""
    steps = summary.get("steps")
    if frame.time is None or not isinstance(steps, list):
        return caption_of(summary)
    found = [s for s in steps if isinstance(s, dict) and s.get("step") == frame.number]
    energy = found[-1].get("energy") if found else None
    return caption_of({**summary, "energy": energy})


def animate(pictures, path):
    """The pictures in turn, the last one three times as long."""
    from PIL import Image

    pace = 1000 * min(0.5, max(1 / 12, SECONDS / len(pictures)))

    def small(picture):
        with Image.open(picture) as image:
            image = image.convert("RGB")
        if image.width > WIDEST:
            size = (WIDEST, round(image.height * WIDEST / image.width))
            image = image.resize(size, Image.LANCZOS)
        return image

    # One palette for all, of the least, middle and greatest load: rare colours count, and none changes on its way.
    some = [small(pictures[k]) for k in sorted({0, len(pictures) // 2, len(pictures) - 1})]
    sheet = Image.new("RGB", (some[0].width, sum(image.height for image in some)))
    for k, image in enumerate(some):
        sheet.paste(image, (0, k * some[0].height))
    palette = sheet.quantize(256, method=Image.Quantize.MAXCOVERAGE)
    turn = (small(p).quantize(palette=palette, dither=Image.Dither.FLOYDSTEINBERG) for p in pictures)
    with whole(path) as temporary:
        next(turn).save(
            temporary, format="GIF", save_all=True, append_images=turn, loop=0,
            duration=[pace] * (len(pictures) - 1) + [3 * pace],
        )


def number_of(frames, k):
    return frames[k].number if frames[k].number is not None else k + 1


def remove_others(output, pattern, pictures):
    """Those of an earlier run with more steps."""
    for left in set(output.glob(pattern)) - set(pictures):
        left.unlink()


def draw_friction(frames, results, output, title, summary, dpi):
    """Of the steps in which something bears friction."""
    look = plot_friction.look_of(results)
    pictures = []
    for k, frame in enumerate(frames):
        if look is not None and plot_friction.bears_friction(results[k]):
            pictures.append(output / f"friction_{number_of(frames, k):04d}.png")
            caption = caption_at(summary, frame)
            figure = plot_friction.plot_friction(results[k], title, caption, look, text=frame.text)
            save(figure, pictures[-1], dpi)
    remove_others(output, "friction_[0-9]*.png", pictures)


def draw_damage(frames, results, output, title, summary, dpi):
    """Of all steps, where interfaces may break."""
    look = plot_damage.look_of(results)
    pictures = []
    for k, frame in enumerate(frames if look is not None else []):
        if plot_damage.may_break(results[k]):
            pictures.append(output / f"damage_{number_of(frames, k):04d}.png")
            caption = caption_at(summary, frame)
            figure = plot_damage.plot_damage(results[k], title, caption, look, text=frame.text)
            save(figure, pictures[-1], dpi)
    remove_others(output, "damage_[0-9]*.png", pictures)
    if pictures:
        animate(pictures, output / "damage.gif")
    else:
        (output / "damage.gif").unlink(missing_ok=True)


def draw_frames(frames, output, title, summary, dpi):
    results = Results(frames)
    module, paint = painter_of(results[0])
    look = module.look_of(results)
    pictures = []
    with plt.rc_context(STYLE):
        for k, frame in enumerate(frames):
            pictures.append(output / f"frame_{number_of(frames, k):04d}.png")
            figure = paint(results[k], title, caption_at(summary, frame), look, text=frame.text)
            save(figure, pictures[-1], dpi)
        draw_friction(frames, results, output, title, summary, dpi)
        draw_damage(frames, results, output, title, summary, dpi)
    remove_others(output, "frame_[0-9]*.png", pictures)
    animate(pictures, output / "steps.gif")
