# SPDX-License-Identifier: BSD-3-Clause
"""Runs of decks that are measured several times, for the performance programs."""

import shutil
import statistics

import harmos_runs as runs


class RunFailed(RuntimeError):
    """A run that left no answer, with what it printed."""


def repeated(repetitions, deck, sets, np=2, program="signorini"):
    """The summaries of so many runs; their files are removed, fields may be gigabytes.

    @throws RunFailed if a run ends with a status other than 0, converged.
    """
    summaries = []
    for _ in range(repetitions):
        run = runs.run(deck, sets, np=np, program=program)
        shutil.rmtree(run.directory, ignore_errors=True)
        if run.returncode != 0:
            raise RunFailed(f"{run}")
        summaries.append(run.summary)
    return summaries


def median_seconds(summaries):
    """By stage."""
    return {
        stage: statistics.median(summary["seconds"][stage] for summary in summaries)
        for stage in summaries[-1]["seconds"]
    }


def median_memory(summaries):
    """MiB of all ranks together."""
    return statistics.median(summary["peak_memory_mib"] for summary in summaries)


def version():
    """What a program says of itself: version and commit."""
    status, out, errors = runs.execute([runs.application(), "--version"])
    assert status == 0, errors
    return out.strip()
