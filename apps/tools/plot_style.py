# SPDX-License-Identifier: BSD-3-Clause
"""Colours, fonts, captions and places of all pictures.

Colours, made for colour-blind readers: M. Okabe, K. Ito, "Color universal design", 2008, and the
map viridis of N. Smith and S. van der Walt.
"""

import contextlib
import os
from pathlib import Path

import matplotlib
from command_line import PlotError

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402

# Okabe-Ito colours and a perceptually uniform map, see the sources above.
CLOSED = "#D55E00"
OPEN = "#56B4E9"
BODY_COLOURS = ("#0072B2", "#009E73", "#CC79A7", "#000000")
PRESSURE = "#D55E00"
INK = "#222222"
FAINT = "#8A8A8A"
DISPLACEMENT_MAP = plt.get_cmap("viridis")

STYLE = {
    "font.family": "DejaVu Sans",
    "font.size": 10,
    "axes.edgecolor": FAINT,
    "axes.labelcolor": INK,
    "axes.titlesize": 11,
    "axes.titlecolor": INK,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "legend.frameon": False,
    "mathtext.fontset": "dejavusans",
}
# Margins about axes in space: matplotlib 3.6 always has them, 3.10 if it is asked to.
if "axes3d.automargin" in matplotlib.rcParams:
    STYLE["axes3d.automargin"] = True


def caption_of(summary):
    """The figures to print below a picture; what the summary does not tell is left out."""
    words = []

    def add(key, form):
        value = summary.get(key)
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            words.append(form.format(value))

    add("primal_dimension", "primal dimension {:,}")
    add("dual_dimension", "dual dimension {:,}")
    add("subdomains", "{} subdomains")
    add("ranks", "{} ranks")
    add("energy", "energy {:.10g}")
    if isinstance(summary.get("converged"), bool):
        reason = summary.get("reason")
        words.append("converged" if summary["converged"] else "NOT converged")
        if reason and reason != "converged":
            words[-1] += f" ({reason})"
    version = summary.get("harmos")
    if isinstance(version, dict) and version.get("version"):
        git = f" ({version['git']})" if version.get("git") else ""
        words.append(f"Harmos {version['version']}{git}")
    return words


def finish(figure, title, caption):
    if title:
        figure.suptitle(title, fontsize=13, y=0.985)
    lines = [""]
    for words in caption:
        longer = f"{lines[-1]} \u00b7 {words}" if lines[-1] else words
        # About 15 characters of this size fit an inch.
        if len(longer) > 14 * figure.get_figwidth() and lines[-1]:
            lines.append(words)
        else:
            lines[-1] = longer
    text = "\n".join(lines)
    figure.text(0.5, 0.015, text, ha="center", va="bottom", fontsize=8, color="#555555")


def output_of(options):
    """The directory that --output names, made; else that of the data."""
    output = Path(options.output or options.directory)
    try:
        output.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise PlotError(f"{output}: cannot be created ({error.strerror}); use another directory") from error
    return output


@contextlib.contextmanager
def whole(path):
    """A place beside the path, renamed when it has been written: the name never stands for half a picture."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        yield temporary
        os.replace(temporary, path)
    except OSError as error:
        raise PlotError(
            f"{path}: cannot write ({error.strerror}); give a writable directory with --output"
        ) from error
    finally:
        temporary.unlink(missing_ok=True)
    print(path)


def save(figure, path, dpi, close=True):
    """SVG where the path ends in .svg, else PNG."""
    form = "svg" if path.suffix == ".svg" else "png"
    # No entry that differs between two runs on the same data.
    metadata = {"Software": None} if form == "png" else {"Date": None}
    try:
        with whole(path) as temporary:
            figure.savefig(temporary, format=form, dpi=dpi, metadata=metadata)
    finally:
        if close:
            plt.close(figure)
