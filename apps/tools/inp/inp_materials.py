# SPDX-License-Identifier: BSD-3-Clause
"""Materials of a deck, from those of a model and the axes of its sections."""

import numpy as np
from inp_parts import safe


class Materials:
    """One for each material and orientation that sections name."""

    def __init__(self, model):
        self.model = model
        self.lists, self.names, self.notes = {}, {}, []  # of the deck, by name

    def add(self, section):
        name, material = self.name_of(section), self.model.materials.get(section.material)
        if material is None or material.elastic is None:
            raise ValueError(f"{section.place}: \"{section.material}\" is no elastic material")
        if name not in self.lists:
            self.lists[name] = self.describe(material, section)

    def name_of(self, section):
        """One for each material and orientation."""
        key = (section.material, section.orientation)
        if key not in self.names:
            name = safe(section.material) + (f"_{safe(section.orientation)}" if section.orientation else "")
            while name in self.names.values():
                name += "_"
            self.names[key] = name
        return self.names[key]

    def describe(self, material, section):
        kind, numbers = material.elastic["kind"], material.elastic["numbers"]
        values = {}
        if self.model.motion.there():
            if not material.density:
                raise ValueError(f"{material.place}: *DYNAMIC needs the *DENSITY of each material")
            values["Density"] = material.density
        uneven = len(set(material.expansion or ())) > 1
        if kind == "ISOTROPIC" and section.orientation and uneven:
            young, ratio = numbers
            shear = 0.5 * young / (1.0 + ratio)
            values.update({"Type": "orthotropic", "Young's moduli": [young] * 3})
            values.update({"Poisson's ratios": [ratio] * 3, "Shear moduli": [shear] * 3})
        elif kind == "ISOTROPIC":
            values["Young's modulus"], values["Poisson's ratio"] = numbers
            if numbers[1] > 0.4:
                self.notes.append(
                    f"{material.place}: nearly incompressible; \"Dilatation\" = \"projected\" of the bodies keeps "
                    "elements of full integration from locking"
                )
        elif kind == "ANISOTROPIC":
            values.update({"Type": "anisotropic", "Stiffness": list(numbers)})
        else:
            values["Type"] = "orthotropic"
            try:
                values.update(self.engineering(kind, numbers))
            except np.linalg.LinAlgError:
                raise ValueError(f"{material.elastic['place']}: the moduli make a singular matrix") from None
        if section.orientation and (kind != "ISOTROPIC" or uneven):
            values.update(self.axes_of_material(section))
        if material.expansion:
            values["Thermal expansion"] = list(material.expansion)
        if material.plastic:
            if kind != "ISOTROPIC" or uneven:
                raise ValueError(f"{material.plastic['place']}: *PLASTIC is for isotropic materials alone")
            values["Plasticity"] = self.plasticity(material.plastic)
        return values

    @staticmethod
    def plasticity(plastic):
        strains, stresses = ([float(point[k]) for point in plastic["points"]] for k in range(2))
        if plastic["kind"] == "ISOTROPIC":
            return {"Plastic strains": strains, "Stresses": stresses}
        slope = (stresses[-1] - stresses[0]) / (strains[-1] - strains[0]) if len(strains) > 1 else 0.0
        return {"Yield stress": stresses[0], "Kinematic hardening": slope}

    def engineering(self, kind, numbers):
        if kind == "ENGINEERING CONSTANTS":
            young, poisson, shear = numbers[:3], numbers[3:6], numbers[6:]
        else:
            d11, d12, d22, d13, d23, d33, *shear = numbers
            s = np.linalg.inv(np.array([[d11, d12, d13], [d12, d22, d23], [d13, d23, d33]]))
            young = [1.0 / s[k, k] for k in range(3)]
            poisson = [-s[0, 1] / s[0, 0], -s[0, 2] / s[0, 0], -s[1, 2] / s[1, 1]]
        return {"Young's moduli": young, "Poisson's ratios": poisson, "Shear moduli": list(shear)}

    def axes_of_material(self, section):
        numbers = self.model.orientations.get(section.orientation)
        if numbers is None:
            raise ValueError(f"{section.place}: there is no orientation \"{section.orientation}\"")
        return {"Axis 1": numbers[:3], "Axis 2": numbers[3:]}
