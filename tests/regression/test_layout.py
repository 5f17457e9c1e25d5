# SPDX-License-Identifier: BSD-3-Clause
"""The order of the source tree, which no compiler checks.

What each class guards against:

    Packages   a package that includes or links what it must not know: qp and FETI, FETI and
               meshes, or anything that would close a cycle; a library that prints by itself or
               assumes that all of MPI belongs to it; folders of a package that include each
               other in a circle
    Tree       files without licence, headers without include guard, folders too full to find
               anything, things at the top level that belong further down, a second place that
               knows about releases of Trilinos
    Planted    this checker finding nothing because it looks at nothing: each fault is planted in
               a copy of the tree and must be found
"""

import re
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import harmos_runs as runs  # noqa: E402

# What a package may see; a new package enters here.
SEES = {
    "core": set(),
    "io": {"core"},
    "qp": {"core"},
    "feti": {"core", "qp"},
    "thyra": {"core", "qp", "feti"},
    "fem": {"core", "io"},
    "contact": {"core", "fem"},
    "scene": {"core", "feti", "fem", "contact"},
    "effects": {"core", "feti", "fem", "contact", "scene"},
    "sensitivity": {"core", "feti", "fem", "contact", "scene"},
    "rol": {"core", "sensitivity"},
    "run": {"core", "io", "qp", "feti", "fem", "contact", "scene"},
    "plan": {"core", "qp", "feti", "fem", "contact", "scene", "run"},
}

# Headers that the build makes, and the package that they belong to.
GENERATED = {"Harmos_GitHash.hpp": "core"}

TOP_LEVEL = {
    "CMakeLists.txt",
    "CMakePresets.json",
    "CHANGELOG.md",
    "LICENSE",
    "README.md",
    "apps",
    "cmake",
    "docs",
    "packages",
    "tests",
}

LICENCE = "SPDX-License-Identifier: BSD-3-Clause"
LICENSED = {".cpp", ".hpp", ".h", ".c", ".cmake", ".py", ".sh"}
MOST_MODULES = 20  # side by side in a folder

INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]', re.MULTILINE)
COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
FORBIDDEN = {
    "std::cout": re.compile(r"\bcout\b"),
    "std::cerr": re.compile(r"\bcerr\b|\bclog\b"),
    # Not snprintf(), which prints into memory.
    "printf": re.compile(r"(?<![A-Za-z_])v?f?printf\s*\(|(?<![A-Za-z_])f?puts\s*\("),
    "MPI_COMM_WORLD": re.compile(r"\bMPI_COMM_WORLD\b"),
}


class Source:
    """The files of a source tree, by path relative to its top."""

    def __init__(self, top, files):
        self.top = Path(top)
        self.files = sorted(files)

    def text(self, file):
        return (self.top / file).read_text(encoding="utf-8")

    def below(self, *parts, suffixes=(".hpp", ".cpp")):
        prefix = "/".join(parts) + "/"
        return [f for f in self.files if f.startswith(prefix) and Path(f).suffix in suffixes]

    def packages(self):
        return sorted({f.split("/")[1] for f in self.files if re.match("packages/[^/]+/", f)})


def owners(source):
    """The package of each header; a name that two packages use would hide one of them."""
    owner = dict(GENERATED)
    faults = []
    for package in source.packages():
        # Code that is included more than once, within a namespace, is named .inc.
        for file in source.below("packages", package, suffixes=(".hpp", ".inc")):
            name = Path(file).name
            if name in owner:
                faults.append(f"{file}: {name} also belongs to {owner[name]}")
            owner[name] = package
    return owner, faults


def include_faults(source):
    """Includes of packages and applications that do not resolve, or that must not be."""
    owner, faults = owners(source)
    for package in source.packages():
        if package not in SEES:
            faults.append(f"packages/{package}: not in the table SEES of this test")
            continue
        for file in source.below("packages", package):
            for mark, name in INCLUDE.findall(source.text(file)):
                if "Harmos_" not in name:
                    if mark == '"':
                        faults.append(f'{file}: "{name}" is no header of Harmos; use <{name}>')
                elif mark == "<" or "/" in name:
                    faults.append(f'{file}: include {name} as "{Path(name).name}"')
                elif name not in owner:
                    faults.append(f"{file}: no package has {name}")
                elif owner[name] != package and owner[name] not in SEES[package]:
                    faults.append(f"{file}: {package} must not see {name} of {owner[name]}")
    own = {Path(file).name for file in source.below("apps", suffixes=(".hpp",))}
    for file in source.below("apps"):
        for _, name in INCLUDE.findall(source.text(file)):
            if name.startswith("Harmos_") and name not in own and name not in owner:
                faults.append(f"{file}: neither a package nor apps has {name}")
    return faults


def link_faults(source):
    """Packages that link what they must not see."""
    faults = []
    for package in source.packages():
        text = source.text(f"packages/{package}/CMakeLists.txt")
        for other in re.findall(r"\bHarmos::(\w+)", text):
            if other not in SEES.get(package, set()):
                faults.append(f"packages/{package}/CMakeLists.txt: must not link Harmos::{other}")
    return faults


def output_faults(source):
    faults = []
    for file in source.below("packages"):
        code = COMMENT.sub("", source.text(file))
        faults += [f"{file}: {name}" for name, found in FORBIDDEN.items() if found.search(code)]
    return faults


def package_faults(source):
    faults = []
    for package in source.packages():
        for name in ("README.md", "CMakeLists.txt"):
            if f"packages/{package}/{name}" not in source.files:
                faults.append(f"packages/{package}: no {name}")
        for file in source.below("packages", package):
            if not re.fullmatch(rf"packages/{package}/src/(?:[a-z]+/)?Harmos_\w+\.[ch]pp", file):
                faults.append(
                    f"{file}: the place is packages/{package}/src[/<folder>]/Harmos_<Class>.*pp"
                )
    return faults


def circle_of(sees):
    """Those that a walk along `sees`, from name to names, may come back to; empty for none."""
    left = dict(sees)
    while left:
        free = [name for name, seen in left.items() if not seen & set(left)]
        if not free:
            return set(left)
        for name in free:
            del left[name]
    return set()


def folder_faults(source):
    """Folders that include what their package names after them, and circles of folders."""
    faults = []
    for package in source.packages():
        cmake = source.text(f"packages/{package}/CMakeLists.txt")
        named = re.search(r"\bFOLDERS\s+([a-z\s]+?)\n", cmake)
        order = [f"packages/{package}/src/{name}" for name in named.group(1).split()] if named else []
        files = source.below("packages", package, suffixes=(".hpp", ".cpp", ".inc"))
        place = {Path(file).name: str(Path(file).parent) for file in files}
        sees = {folder: set() for folder in place.values()}
        for file in files:
            names = {Path(name).name for _, name in INCLUDE.findall(source.text(file))}
            sees[str(Path(file).parent)] |= {place[name] for name in names & set(place)}
        for number, folder in enumerate(order):
            for other in sorted(sees.get(folder, set()) & set(order[number + 1 :])):
                faults.append(f"{folder} includes {other}, which FOLDERS names after it")
        circle = circle_of({folder: seen - {folder} for folder, seen in sees.items()})
        if circle:
            faults.append(f"packages/{package}: a circle of includes in {', '.join(sorted(circle))}")
    return faults


def module_faults(source):
    """Folders with more modules, header and source counted once, than a reader takes in."""
    modules = {}
    for file in source.files:
        path = Path(file)
        if path.suffix in (".hpp", ".cpp", ".inc", ".py", ".sh"):
            stem = re.sub(r"_(def|product)$", "", path.stem)
            modules.setdefault(str(path.parent), set()).add(stem)
    return [
        f"{folder}: {len(names)} modules side by side, more than {MOST_MODULES}"
        for folder, names in sorted(modules.items())
        if len(names) > MOST_MODULES
    ]


def is_source(file):
    # Commands have no suffix.
    command = re.fullmatch(r"apps/tools/harmos-[a-z-]+", file)
    return command or Path(file).suffix in LICENSED or Path(file).name == "CMakeLists.txt"


def licence_faults(source):
    return [
        f"{file}: no {LICENCE} in the first two lines"
        for file in source.files
        if is_source(file) and LICENCE not in "\n".join(source.text(file).splitlines()[:2])
    ]


def header_faults(source):
    return [
        f"{file}: no #pragma once"
        for file in source.files
        if Path(file).suffix in (".hpp", ".h")
        and not re.search(r"^#pragma once$", source.text(file), re.MULTILINE)
    ]


CONFLICT = re.compile(r"^(?:<{7} |>{7} |={7}$)", re.MULTILINE)


def conflict_faults(source):
    """Files that a merge was left in."""
    texts = (".md", ".xml", ".json", ".txt", ".geo", ".log", ".yaml", *LICENSED)
    return [
        f"{file}: marks of a merge"
        for file in source.files
        if Path(file).suffix in texts and CONFLICT.search(source.text(file))
    ]


# Where differences between releases of Trilinos are confined to, and what tells of one elsewhere.
VERSION_HEADER = "packages/core/src/Harmos_TrilinosVersion.hpp"
VERSION = re.compile(r"\bTRILINOS_(?:MAJOR|MINOR|VERSION|RELEASE)\w*|\bTrilinos_version\.h\b")


def version_faults(source):
    """Sources that ask for the release of Trilinos, or include what tells it."""
    faults = []
    for top in ("packages", "apps", "tests", "docs"):
        for file in source.below(top, suffixes=(".hpp", ".cpp", ".h", ".c", ".inc")):
            if file != VERSION_HEADER:
                names = set(VERSION.findall(COMMENT.sub("", source.text(file))))
                faults += [f"{file}: {name} belongs to {VERSION_HEADER}" for name in sorted(names)]
    return faults


GUARD = re.compile(r"\btests/[\w/]+\.(?:cpp|py)\b")


def guard_faults(source):
    """Tests that a comment names as its guard and that are not there."""
    faults = []
    for file in source.below("packages", suffixes=(".hpp", ".cpp")):
        for name in sorted(set(GUARD.findall(source.text(file)))):
            if name not in source.files:
                faults.append(f"{file}: names {name}, which does not exist")
    return faults


def top_level_faults(source):
    found = {file.split("/")[0] for file in source.files}
    return [
        f"{name}: does not belong at the top level"
        for name in sorted(found - TOP_LEVEL)
        if not name.startswith(".")
    ]


def git(*words):
    # The tree may belong to another user than the one that tests it, in a container for instance.
    command = ["git", "-c", "safe.directory=*", "-C", str(runs.SOURCE), *words]
    return subprocess.run(command, capture_output=True, text=True)


_source = None


def this_source():
    """The tree as git sees it: with what is about to be added, without what it ignores."""
    global _source
    if _source is None:
        if not shutil.which("git"):
            raise unittest.SkipTest("git is missing")
        listed = git("ls-files", "-z", "--cached", "--others", "--exclude-standard")
        if listed.returncode != 0:
            raise unittest.SkipTest(f"not a git work tree: {listed.stderr.strip()}")
        files = [file for file in listed.stdout.split("\0") if file]
        _source = Source(runs.SOURCE, [f for f in files if (runs.SOURCE / f).is_file()])
    return _source


class Checks(unittest.TestCase):
    def setUp(self):
        self.source = this_source()

    def assert_none(self, faults):
        self.assertFalse(faults, "\n  ".join(["", *faults]))


class Packages(Checks):
    def test_packages_are_those_of_the_design(self):
        self.assertEqual(self.source.packages(), sorted(SEES))

    def test_table_has_no_cycle(self):
        self.assertEqual(circle_of(SEES), set())

    def test_includes(self):
        self.assert_none(include_faults(self.source))

    def test_links(self):
        self.assert_none(link_faults(self.source))

    def test_folders_have_no_circle(self):
        self.assert_none(folder_faults(self.source))

    def test_libraries_do_not_print(self):
        self.assert_none(output_faults(self.source))

    def test_each_has_its_files(self):
        self.assert_none(package_faults(self.source))


class Tree(Checks):
    def test_licence(self):
        self.assert_none(licence_faults(self.source))

    def test_include_guards(self):
        self.assert_none(header_faults(self.source))

    def test_no_marks_of_a_merge(self):
        self.assert_none(conflict_faults(self.source))

    def test_modules_of_a_folder(self):
        self.assert_none(module_faults(self.source))

    def test_guards_exist(self):
        self.assert_none(guard_faults(self.source))

    def test_trilinos_version_in_one_header(self):
        self.assert_none(version_faults(self.source))

    def test_top_level(self):
        self.assert_none(top_level_faults(self.source))

    def test_builds_and_runs_are_ignored(self):
        for path in ("build/x", "build-dev/x", "run/x", "run1/x", "tests/__pycache__/x"):
            self.assertEqual(git("check-ignore", "-q", path).returncode, 0, path)


class Planted(Checks):
    """Each check on a copy with one fault more than the tree itself has."""

    def setUp(self):
        super().setUp()
        self.top = runs.scratch("copy")
        for file in self.source.files:
            (self.top / file).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(self.source.top / file, self.top / file)

    def header(self, package):
        return Path(self.source.below("packages", package, suffixes=(".hpp",))[0]).name

    def assert_found(self, check, file, text, fault):
        before = check(self.source)
        target = self.top / file
        target.parent.mkdir(parents=True, exist_ok=True)
        with open(target, "a", encoding="utf-8") as stream:
            stream.write(text)
        copy = Source(self.top, set(self.source.files) | {file})
        found = check(copy)
        self.assertEqual([line for line in found if line not in before], [fault])

    def test_guard_that_is_not_there(self):
        file = "packages/qp/src/Harmos_Planted.hpp"
        name = "tests/unit/qp/test_planted.cpp"
        fault = f"{file}: names {name}, which does not exist"
        self.assert_found(guard_faults, file, f"#pragma once\n/// Guarded by {name}.\n", fault)

    def test_forbidden_includes(self):
        for package, other in (
            ("qp", "feti"),
            ("qp", "fem"),
            ("feti", "fem"),
            ("feti", "contact"),
            ("fem", "qp"),
            ("fem", "feti"),
            ("contact", "qp"),
            ("contact", "feti"),
            ("core", "qp"),
            ("feti", "scene"),
            ("scene", "effects"),
            ("scene", "run"),
            ("io", "scene"),
            ("run", "plan"),
        ):
            with self.subTest(package=package, other=other):
                name = self.header(other)
                file = f"packages/{package}/src/Harmos_Planted{other}.hpp"
                fault = f"{file}: {package} must not see {name} of {other}"
                text = f'#pragma once\n#include "{name}"\n'
                self.assert_found(include_faults, file, text, fault)
                (self.top / file).unlink()

    def test_include_that_does_not_resolve(self):
        for file, who in (
            ("packages/qp/src/Harmos_Planted.cpp", "no package has"),
            ("apps/signorini/Harmos_Planted.cpp", "neither a package nor apps has"),
        ):
            fault = f"{file}: {who} Harmos_Nothing.hpp"
            self.assert_found(include_faults, file, '#include "Harmos_Nothing.hpp"\n', fault)
            (self.top / file).unlink()

    def test_header_of_two_packages(self):
        name = self.header("core")
        file = f"packages/scene/src/{name}"
        fault = f"{file}: {name} also belongs to core"
        # The others then include the wrong one, too; the first fault names the cause.
        source = Source(self.top, {*self.source.files, file})
        (self.top / file).write_text("#pragma once\n", encoding="utf-8")
        self.assertIn(fault, include_faults(source))

    def test_forbidden_link(self):
        file = "packages/fem/CMakeLists.txt"
        fault = f"{file}: must not link Harmos::qp"
        text = "target_link_libraries(harmos_fem PUBLIC Harmos::qp)\n"
        self.assert_found(link_faults, file, text, fault)

    def test_output(self):
        file = "packages/feti/src/Harmos_Planted.cpp"
        for text, name in (
            ("std::cout << 1;", "std::cout"),
            ("std::cerr << 1;", "std::cerr"),
            ('printf("x");', "printf"),
            ("comm = MPI_COMM_WORLD;", "MPI_COMM_WORLD"),
        ):
            with self.subTest(text=text):
                self.assert_found(output_faults, file, text + "\n", f"{file}: {name}")
                (self.top / file).unlink()
        # Neither a comment nor printing into memory is output.
        (self.top / file).write_text("// std::cout\nstd::snprintf(a, 1, b);\n", encoding="utf-8")
        found = output_faults(Source(self.top, {*self.source.files, file}))
        self.assertEqual(found, output_faults(self.source))

    def test_package_without_its_files(self):
        files = [f for f in self.source.files if f != "packages/core/CMakeLists.txt"]
        found = package_faults(Source(self.top, files))
        self.assertIn("packages/core: no CMakeLists.txt", found)
        files = [f for f in self.source.files if f != "packages/core/README.md"]
        found = package_faults(Source(self.top, files))
        self.assertIn("packages/core: no README.md", found)

    def test_licence(self):
        for file in ("apps/tools/harmos-planted", "cmake/Planted.cmake", "tests/planted.py", "docs/planted.sh"):
            fault = f"{file}: no {LICENCE} in the first two lines"
            self.assert_found(licence_faults, file, f"#\n#\n# {LICENCE}\n", fault)
            (self.top / file).unlink()

    def test_header_without_guard(self):
        file = "tests/support/Planted.hpp"
        self.assert_found(header_faults, file, "#include <a>\n", f"{file}: no #pragma once")

    def test_trilinos_version_elsewhere(self):
        for name, text in (
            ("TRILINOS_MAJOR_MINOR_VERSION", "#if TRILINOS_MAJOR_MINOR_VERSION > 160100\n#endif\n"),
            ("Trilinos_version.h", "#include <Trilinos_version.h>\n"),
        ):
            file = "packages/feti/src/Harmos_Planted.cpp"
            fault = f"{file}: {name} belongs to {VERSION_HEADER}"
            self.assert_found(version_faults, file, text, fault)
            (self.top / file).unlink()

    def test_marks_of_a_merge(self):
        file = "docs/planted.md"
        self.assert_found(conflict_faults, file, 7 * "<" + " HEAD\n", f"{file}: marks of a merge")

    def test_folder_that_looks_up(self):
        file = "packages/scene/src/model/Harmos_Planted.hpp"
        text = '#pragma once\n#include "Harmos_Decomposition.hpp"\n'
        places = [f"packages/scene/src/{folder}" for folder in ("model", "discretisation")]
        before = folder_faults(self.source)
        (self.top / file).write_text(text, encoding="utf-8")
        found = folder_faults(Source(self.top, {*self.source.files, file}))
        fault = f"{places[0]} includes {places[1]}, which FOLDERS names after it"
        self.assertIn(fault, [line for line in found if line not in before])

    def test_full_folder(self):
        names = [f"docs/planted/module{k}.py" for k in range(MOST_MODULES + 1)]
        fault = f"docs/planted: {MOST_MODULES + 1} modules side by side, more than {MOST_MODULES}"
        self.assertEqual(module_faults(Source(self.top, names)), [fault])

    def test_folders_in_a_circle(self):
        file = "packages/fem/src/elements/Harmos_Planted.hpp"
        text = '#pragma once\n#include "Harmos_Mesh.hpp"\n'
        (self.top / file).write_text(text, encoding="utf-8")
        found = folder_faults(Source(self.top, {*self.source.files, file}))
        circle = "packages/fem/src/elements, packages/fem/src/files, packages/fem/src/integrals"
        self.assertIn(f"packages/fem: a circle of includes in {circle}, packages/fem/src/mesh", found)

    def test_top_level(self):
        fault = "notes: does not belong at the top level"
        self.assert_found(top_level_faults, "notes/today.md", "\n", fault)


if __name__ == "__main__":
    runs.main()
