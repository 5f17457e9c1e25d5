# SPDX-License-Identifier: BSD-3-Clause
"""An installed tree of this build, for the tests of it."""

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

SOURCE = Path(os.environ["HARMOS_SOURCE_DIR"])
BINARY = Path(os.environ["HARMOS_BINARY_DIR"])


def run(*command, directory=None, check=True):
    """Its standard output; what went wrong, with all that it printed."""
    done = subprocess.run(
        [str(word) for word in command], cwd=directory, capture_output=True, text=True, check=False
    )
    if check and done.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, command))}\n{done.stdout}\n{done.stderr}")
    return done


class InstalledTree:
    """Installed in one place and moved to another: nothing may point to where it was."""

    def __init__(self):
        self.scratch = Path(tempfile.mkdtemp(prefix="harmos_install_"))
        first = self.scratch / "first"
        run("cmake", "--install", BINARY, "--prefix", first)
        self.prefix = self.scratch / "prefix"
        first.rename(self.prefix)

    def remove(self):
        shutil.rmtree(self.scratch, ignore_errors=True)
