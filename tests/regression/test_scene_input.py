# SPDX-License-Identifier: BSD-3-Clause
"""Scenes that make no sense, from outside: decks, mesh files and loads of the application harmos.

Each is refused with exit status 2 (1 where the scene makes sense but has no solution) and one
message, which says what is wrong, where, and what to do; on one rank and on two, where a rank left
waiting would be a hang. What each class guards against:

    Names       names that lead nowhere and are passed over, or refused without the nearest one
    Settings    values that contradict each other or lie out of range
    MeshFiles   files that are missing, and cells that no element can use
    Surfaces    boundary parts that cannot be in contact
    Steps       times, histories and values prescribed over time that are taken without a word
    NoSolution  bodies that nothing holds and whose load pulls them away, without a word of which
"""

import concurrent.futures
import copy
import re
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import harmos_runs as runs  # noqa: E402
from harmos_decks import xml  # noqa: E402


def block(origin, material="steel", **more):
    usual = {"Source": "block", "Elements a side": [2, 2, 2], "Materials": [material]}
    return {**usual, "Origin": [float(x) for x in origin], **more}


# Two blocks on top of each other, the lower one held: a scene with nothing wrong.
SCENE = {
    "Materials": {"steel": {"Young's modulus": 1.0, "Poisson's ratio": 0.3}},
    "Bodies": {"lower": block((0, 0, 0)), "upper": block((0, 1, 0))},
    "Effects": {
        "Contact": {"joint": {"First": "upper/bottom", "Second": "lower/top"}},
        "Body force": {"weight": {"Body": "upper", "Density": [0.0, -1.0, 0.0]}},
        "Prescribed displacement": {
            "ground": {"Part": "lower/bottom"},
            "side": {"Part": "upper/left", "Components": ["x"]},
        },
    },
}

# One body from a file, held at its left side.
FILED = {
    "Model": {"Mesh file": "mesh.msh"},
    "Materials": SCENE["Materials"],
    "Bodies": {"plate": {"Materials": ["steel"]}},
    "Effects": {"Prescribed displacement": {"wall": {"Part": "plate/left"}}},
}


def changed(scene, path, value):
    """The scene with another value at a path, or without it if the value is None."""
    result = copy.deepcopy(scene)
    *lists, name = path.split("/")
    place = result
    for key in lists:
        place = place.setdefault(key, {})
    if value is None:
        del place[name]
    else:
        place[name] = value
    return result


def msh(nodes, elements):
    """A mesh of format 2.2. Elements are (type, physical group, nodes); groups 1 "plate", surfaces,
    2 "left" and 3 "rim", curves."""
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat"]
    lines += ["$PhysicalNames", "3", '1 2 "left"', '1 3 "rim"', '2 1 "plate"', "$EndPhysicalNames"]
    lines += ["$Nodes", str(len(nodes))]
    lines += [f"{k + 1} {x} {y} 0" for k, (x, y) in enumerate(nodes)]
    lines += ["$EndNodes", "$Elements", str(len(elements))]
    for k, (kind, group, *corners) in enumerate(elements):
        lines.append(" ".join(map(str, [k + 1, kind, 2, group, group, *corners])))
    return "\n".join([*lines, "$EndElements", ""])


LINE, TRIANGLE, QUADRILATERAL = 1, 2, 3
SQUARE = ((0, 0), (1, 0), (1, 1), (0, 1))


class Case(unittest.TestCase):
    def setUp(self):
        self.place = runs.scratch("place")
        self.place.mkdir()

    def write(self, scene, mesh=None):
        if mesh is not None:
            (self.place / "mesh.msh").write_text(mesh, encoding="utf-8")
        path = self.place / "deck.xml"
        path.write_text(xml("harmos", scene), encoding="utf-8")
        return path

    def assert_told(self, result, fragments):
        """One message, which holds all fragments, each once."""
        self.assertEqual(len(result.errors), 1, result)
        text = re.sub("(?m)^warning: .*$", "", result.stderr)
        for fragment in fragments:
            self.assertEqual(text.count(fragment), 1, f"{fragment!r}{result}")

    @staticmethod
    def together(deck, ways):
        """Runs at the same time, in directories of their own: (ranks, more words) each."""
        with concurrent.futures.ThreadPoolExecutor() as pool:
            jobs = [
                pool.submit(runs.run, deck, np=np, extra=extra, program="harmos")
                for np, extra in ways
            ]
            return [job.result() for job in jobs]

    def refuse(self, scene, *fragments, mesh=None, reported=False):
        """Refused by --check on one rank, and by a run on two.

        reported  the run begins before it finds out: its summary holds the reason
        """
        deck = self.write(scene, mesh)
        ways = ((0, ["--check"]), (2, []))
        for (np, extra), result in zip(ways, self.together(deck, ways)):
            with self.subTest(ranks=max(np, 1), words=extra):
                self.assertEqual(result.returncode, 2, result)
                self.assert_told(result, fragments)
                if reported and not extra:
                    self.assertIs(result.summary["converged"], False)
                    self.assertIn(fragments[0], result.summary["reason"])
                else:
                    self.assertIsNone(result.summary, result)

    def has_no_solution(self, scene, *fragments):
        """Valid, but runs end with exit status 1 and say why."""
        deck = self.write(scene)
        checked, *ran = self.together(deck, ((0, ["--check"]), (0, []), (2, [])))
        self.assertEqual(checked.returncode, 0, checked)
        for result in ran:
            with self.subTest(command=result.command[:3]):
                self.assertEqual(result.returncode, 1, result)
                self.assert_told(result, fragments)
                self.assertIs(result.summary["converged"], False)
                for fragment in fragments:
                    self.assertIn(fragment, result.summary["reason"])


class Good(Case):
    def test_the_scenes_that_the_others_spoil(self):
        plate = msh(SQUARE, [(QUADRILATERAL, 1, 1, 2, 3, 4), (LINE, 2, 1, 4)])
        for scene, mesh in ((SCENE, None), (FILED, plate)):
            runs.solved(self, self.write(scene, mesh), np=0, program="harmos")


    def test_elements_that_lock_are_told(self):
        scene = changed(SCENE, "Materials/steel/Poisson's ratio", 0.49)
        for element, told in (("P1", 1), ("Q1", 0), ("P2", 0)):
            deck = self.write(changed(scene, "Bodies/lower/Element", element))
            run = runs.solved(self, deck, np=0, program="harmos")
            self.assertEqual(run.stdout.count('Body "lower": a triangle of 3 nodes locks'), told)

    def test_ragged_parts_are_told(self):
        # A row of squares: its halves are twenty times as long as wide, however it is cut.
        length = 40
        nodes = [(float(x), float(y)) for y in (0, 1) for x in range(length + 1)]
        cells = [
            (QUADRILATERAL, 1, k, k + 1, k + length + 2, k + length + 1) for k in range(1, length + 1)
        ]
        deck = self.write(
            changed(FILED, "Bodies/plate/Subdomains", 1), msh(nodes, [*cells, (LINE, 2, 1, length + 2)])
        )
        for parts, partition, told in (
            (1, "compact", ""),
            (2, "compact", 'try another "Partition seed" or number of "Subdomains"'),
            (2, "METIS", 'use "Partition" = "compact" for rounder parts'),
        ):
            settings = {"Bodies/plate/Subdomains": parts, "Bodies/plate/Expert/Partition": partition}
            run = runs.solved(self, deck, settings, np=0, program="harmos")
            self.assertEqual(run.stdout.count("ragged"), 1 if told else 0, run)
            if told:
                self.assertIn(
                    'Body "plate": 2 of 2 parts are ragged (parts 0 and 1), narrowest neck 0.32, recommended at '
                    f"least 0.40; this can cost iterations: {told}\n", run.stdout,
                )


class Names(Case):
    def test_material(self):
        self.refuse(
            changed(SCENE, "Bodies/upper/Materials", ["stel"]),
            '"Bodies/upper/Materials" names the material "stel", which is not in "Materials"',
            'did you mean "steel"?',
        )

    def test_body_of_an_effect(self):
        self.refuse(
            changed(SCENE, "Effects/Body force/weight/Body", "uper"),
            '"Effects/Body force/weight/Body" names the body "uper", which is not in "Bodies"',
            'did you mean "upper"?',
        )
        self.refuse(
            changed(SCENE, "Effects/Contact/joint/Second", "louwer/top"),
            '"Effects/Contact/joint/Second" names the body "louwer"',
            'did you mean "lower"?',
        )

    def test_boundary_part(self):
        for path, name in (
            ("Effects/Contact/joint/First", "upper/botom"),
            ("Effects/Prescribed displacement/ground/Part", "lower/botom"),
        ):
            self.refuse(
                changed(SCENE, path, name),
                'names the boundary part "botom" of body "' + name.split("/")[0],
                'did you mean "bottom"?',
                reported=True,
            )

    def test_boundary_part_without_a_body(self):
        self.refuse(
            changed(SCENE, "Effects/Contact/joint/First", "bottom"),
            '"Effects/Contact/joint/First" = "bottom" is not of the form "body/boundary part"',
        )

    def test_part_that_is_not_given(self):
        self.refuse(
            changed(SCENE, "Effects/Contact/joint/Second", None),
            '"Effects/Contact/joint/Second" = "" is not of the form "body/boundary part"',
        )

    def test_parameters_of_members_of_families(self):
        self.refuse(
            changed(SCENE, "Bodies/lower/Sise", [1.0, 1.0, 1.0]),
            'unknown parameter "Bodies/lower/Sise"',
            'did you mean "Size"?',
        )
        self.refuse(
            changed(SCENE, "Materials/steel/Young modulus", 1.0),
            'unknown parameter "Materials/steel/Young modulus"',
            'did you mean "Young\'s modulus"?',
        )
        self.refuse(
            changed(SCENE, "Effects/Contact/joint/Gp", 0.0),
            'unknown parameter "Effects/Contact/joint/Gp"',
            'did you mean "Gap"?',
        )

    def test_kind_of_effect(self):
        self.refuse(
            changed(SCENE, "Effects/Contct", {"joint": {}}),
            'unknown list "Effects/Contct"',
            'did you mean "Contact"?',
        )

    def test_physical_group(self):
        plate = msh(SQUARE, [(QUADRILATERAL, 1, 1, 2, 3, 4), (LINE, 2, 1, 4)])
        self.refuse(
            changed(FILED, "Bodies/plate/Groups", ["plat"]),
            'body "plate": ',
            'mesh.msh" has no physical surface "plat"',
            'did you mean "plate"?',
            mesh=plate,
        )
        self.refuse(
            changed(FILED, "Effects/Prescribed displacement/wall/Part", "plate/lft"),
            'names the boundary part "lft" of body "plate"',
            'did you mean "left"?',
            mesh=plate,
            reported=True,
        )


class Settings(Case):
    def test_no_bodies(self):
        self.refuse({"Model": {"Name": "nothing"}}, '"Bodies" is empty; add at least one body')

    def test_incompressible_and_negative(self):
        self.refuse(
            changed(SCENE, "Materials/steel/Poisson's ratio", 0.5),
            '"Materials/steel/Poisson\'s ratio" = 0.5 is out of range',
            "in (-1, 0.5)",
        )
        self.refuse(
            changed(SCENE, "Materials/steel/Young's modulus", -1.0),
            '"Materials/steel/Young\'s modulus" = -1 is out of range',
        )

    def test_orthotropic_material_without_energy(self):
        # nu_12^2 E_2 / E_1 = 1.44: stretched along 1 it would give energy away.
        ratios = {"Type": "orthotropic", "Poisson's ratios": [1.2, 0.3, 0.3]}
        self.refuse(
            changed(SCENE, "Materials/steel", ratios),
            'material "steel"',
            "energy must be positive definite",
        )

    def test_number_of_materials(self):
        for materials in ([], ["steel", "steel"]):
            scene = changed(SCENE, "Bodies/upper/Materials", materials or None)
            self.refuse(
                scene,
                f'"Bodies/upper/Materials" names {len(materials)} materials for 1 regions',
            )

    def test_length_of_an_array(self):
        self.refuse(
            changed(SCENE, "Bodies/lower/Size", [1.0, 1.0]),
            '"Bodies/lower/Size" is an array ({1, 1}), expected 3 real numbers',
        )

    def test_component_that_is_none(self):
        path = "Effects/Prescribed displacement/side/Components"
        self.refuse(
            changed(SCENE, path, ["u"]), f'"{path}" contains "u", expected "x", "y" or "z"'
        )

    def test_component_that_the_physics_does_not_have(self):
        path = "Effects/Prescribed displacement/side/Components"
        self.refuse(
            changed(SCENE, path, ["z"]), f'"{path}" names no component of this physics'
        )

    def test_elastic_effects_on_membranes(self):
        membranes = changed(SCENE, "Model/Physics", "membrane")
        del membranes["Effects"]["Prescribed displacement"]["side"]
        for kind, effect in (
            ("Traction", {"Part": "upper/top"}),
            ("Thermal strain", {"Body": "upper"}),
            ("Obstacle", {"Part": "upper/top"}),
        ):
            self.refuse(
                changed(membranes, f"Effects/{kind}/extra", effect),
                f'"Effects/{kind}/extra" needs elastic bodies, but "Model/Physics" = "membrane"',
            )

    def test_obstacle_without_direction_or_radius(self):
        obstacle = {"Part": "upper/top", "Direction": [0.0, 0.0, 0.0]}
        path = "Effects/Obstacle/plate"
        self.refuse(
            changed(SCENE, path, obstacle),
            f'"{path}/Direction" is a zero vector',
        )
        obstacle = {"Part": "upper/top", "Shape": "cylinder"}
        self.refuse(changed(SCENE, path, obstacle), f'"{path}/Radius" is 0')

    def test_effects_that_do_nothing(self):
        self.refuse(
            changed(SCENE, "Effects/Contact/joint/Second", "upper/bottom"),
            '"Effects/Contact/joint": "First" and "Second" are the same',
        )


class MeshFiles(Case):
    def test_missing_file(self):
        self.refuse(FILED, 'mesh file not found: "', "mesh.msh")

    def test_file_that_is_not_named(self):
        self.refuse(
            changed(FILED, "Model/Mesh file", None),
            '"Model/Mesh file" is empty, but body "plate" has the source "file"',
        )

    def test_file_that_is_no_mesh(self):
        self.refuse(FILED, 'mesh.msh"', mesh="This is no mesh.\n")

    def test_cells_that_cover_each_other(self):
        # The second triangle lies on the first one, from their common side on.
        nodes = (*SQUARE, (0.2, 0.2))
        cells = [(TRIANGLE, 1, 1, 2, 4), (TRIANGLE, 1, 2, 4, 5), (LINE, 2, 1, 4)]
        self.refuse(
            FILED,
            'body "plate"',
            "with the corner nodes 1, 2, 4 and the cell at",
            "the mesh is folded",
            mesh=msh(nodes, cells),
        )

    def test_cell_without_area(self):
        nodes = (*SQUARE, (0.5, 0.5))
        cells = [(TRIANGLE, 1, 1, 2, 3), (TRIANGLE, 1, 1, 3, 5), (LINE, 2, 1, 2)]
        self.refuse(
            FILED,
            "the cell at (0, 0, 0) with the corner nodes 1, 3, 5 has no area",
            mesh=msh(nodes, cells),
        )

    def test_quadrilateral_that_is_not_convex(self):
        # Its Jacobian changes sign within: no rule of its corners alone tells.
        nodes = ((0, 0), (1, 0), (0.2, 0.2), (0, 1))
        cells = [(QUADRILATERAL, 1, 1, 2, 3, 4), (LINE, 2, 1, 4)]
        self.refuse(
            FILED,
            'body "plate", subdomain 0',
            "cell 0 (quadrilateral of 4 nodes) is inverted or has no area",
            mesh=msh(nodes, cells),
            reported=True,
        )

    def test_more_subdomains_than_cells(self):
        plate = msh(SQUARE, [(QUADRILATERAL, 1, 1, 2, 3, 4), (LINE, 2, 1, 4)])
        self.refuse(
            changed(FILED, "Bodies/plate/Subdomains", 2),
            'body "plate" cannot be partitioned into 2 parts: it has 1 cells',
            mesh=plate,
        )

    def test_body_of_another_dimension(self):
        plate = msh(SQUARE, [(QUADRILATERAL, 1, 1, 2, 3, 4), (LINE, 2, 1, 4)])
        self.refuse(
            changed(FILED, "Model/Physics", "solid"),
            'mesh.msh" holds no cells of dimension 3',
            mesh=plate,
        )


class Surfaces(Case):
    def test_that_never_meet(self):
        self.refuse(
            changed(SCENE, "Bodies/upper/Origin", [0.0, 5.0, 0.0]),
            "upper/bottom and lower/top: the surfaces never meet",
            "give a longer reach",
            reported=True,
        )

    def test_that_look_the_same_way(self):
        scene = changed(SCENE, "Bodies/upper/Origin", [0.0, 0.0, 0.0])
        scene = changed(scene, "Effects/Contact/joint/First", "upper/top")
        self.refuse(
            scene, "upper/top and lower/top: ", "both surfaces point the same way", reported=True
        )

    def test_that_do_not_match(self):
        scene = changed(SCENE, "Effects/Contact/joint/Coupling", "nodes")
        self.refuse(
            changed(scene, "Bodies/upper/Elements a side", [3, 2, 2]),
            "upper/bottom and lower/top: the surfaces do not match",
            "mortar coupling",
            reported=True,
        )

    def test_that_are_no_manifold(self):
        # Two triangles that touch at a corner, where four sides of the rim meet.
        nodes = ((0, 0), (1, 0), (0.5, 1), (0, 2), (1, 2))
        cells = [(TRIANGLE, 1, 1, 2, 3), (TRIANGLE, 1, 3, 5, 4), (LINE, 2, 1, 2)]
        cells += [(LINE, 3, a, b) for a, b in ((2, 3), (1, 3), (3, 5), (3, 4))]
        scene = changed(
            FILED,
            "Effects/Obstacle/wall",
            {"Part": "plate/rim", "Point": [0.0, -1.0, 0.0]},
        )
        self.refuse(
            scene,
            "surface plate/rim: not a manifold",
            "4 facets meet at the node at (0.500000, 1.000000, 0.000000)",
            mesh=msh(nodes, cells),
            reported=True,
        )

    def test_nodes_alone_are_no_surface(self):
        cells = [(QUADRILATERAL, 1, 1, 2, 3, 4), (LINE, 2, 1, 4), (15, 1, 3)]
        mesh = msh(SQUARE, cells).replace('3\n1 2 "left"', '4\n0 1 "tip"\n1 2 "left"')
        scene = changed(FILED, "Effects/Obstacle/wall", {"Part": "plate/tip"})
        self.refuse(
            scene,
            'obstacle "wall" names the boundary part "tip" of body "plate", which has nodes but no cell sides',
            mesh=mesh,
            reported=True,
        )


class NoSolution(Case):
    def test_body_that_is_pulled_off_its_support(self):
        self.has_no_solution(
            changed(SCENE, "Effects/Body force/weight/Density", [0.0, 1.0, 0.0]), '"upper"'
        )

    def test_body_that_is_pushed_sideways(self):
        # Nothing holds the upper block along the joint, for there is no friction.
        scene = changed(SCENE, "Effects/Prescribed displacement/side", None)
        self.has_no_solution(
            changed(scene, "Effects/Body force/weight/Density", [0.5, -1.0, 0.0]), '"upper"'
        )

    def test_body_that_nothing_touches(self):
        scene = changed(SCENE, "Bodies/loose", block((5, 0, 0)))
        force = {"Body": "loose", "Density": [1.0, 0.0, 0.0]}
        self.has_no_solution(changed(scene, "Effects/Body force/wind", force), '"loose"')

    def test_body_that_nothing_holds_without_contact(self):
        scene = changed(SCENE, "Effects/Contact", None)
        self.has_no_solution(scene, '"upper"')


class Steps(unittest.TestCase):
    def refused(self, sets, *parts):
        deck = runs.SOURCE / "apps" / "harmos" / "decks" / "two_blocks.xml"
        run = runs.run(deck, sets, np=2, program="harmos")
        self.assertEqual(run.returncode, 2, run)
        self.assertEqual(len(run.errors), 1, run)
        for part in parts:
            self.assertIn(part, run.errors[0])

    def test_times(self):
        self.refused(
            {"Steps/Times": "{0.5,0.25}"},
            '"Steps/Times": times must increase, but 2.50e-01 comes after 5.00e-01',
        )
        self.refused({"Steps/Number": 0}, '"Steps/Number" = 0 is out of range')
        self.refused(
            {"Steps/Number": 3, "Steps/Times": "{0.5,1.0}"},
            '"Steps/Number" = 3 and "Steps/Times" with 2 entries; give one of the two',
        )

    def test_histories(self):
        load = "Effects/Traction/load/History"
        press = {
            "Steps/Number": 2,
            "Steps/Histories/press/Times": "{0,1}",
            "Steps/Histories/press/Values": "{0,1}",
        }
        self.refused(press | {load: "pres"}, "which is not defined", 'did you mean "press"?')
        self.refused(
            press | {"Effects/Tie/joint/History": "press"},
            'unknown parameter "Effects/Tie/joint/History"',
            "have no magnitude to scale by a history",
        )
        self.refused(
            press | {"Effects/Contact/joint/History": "press"},
            'contact "joint" follows the history "press", but has no magnitude to scale',
        )
        self.refused(
            press | {"Steps/Histories/press/Values": "{0,1,2}", load: "press"},
            '"Steps/Histories/press": a history needs a value for each time',
        )

    def test_contradictions(self):
        kind = "Effects/Prescribed displacement"
        sets = {
            "Steps/Number": 4,
            f"{kind}/one/Part": "lower/bottom",
            f"{kind}/one/Components": "{y}",
            f"{kind}/one/Displacement": "{0,-0.01,0}",
        }
        # Zero by what holds it already, and another at the end of the ramp.
        self.refused(sets, "contradict each other at time 1.00e+00", '"one"', "body \"lower\"")
        # Equal at the end, but not before.
        sets[f"{kind}/two/Part"] = "upper/top"
        sets[f"{kind}/two/Components"] = "{y}"
        sets[f"{kind}/two/Displacement"] = "{0,-0.01,0}"
        sets[f"{kind}/one/Part"] = "upper/top"
        sets[f"{kind}/two/History"] = "constant"
        self.refused(sets, "contradict each other at time 0.00e+00", "component 1 of a node")


if __name__ == "__main__":
    runs.main()
