// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CohesiveLaw.hpp"
#include "Harmos_CompositeCell.hpp"
#include "Harmos_Scene.hpp"

#include <optional>
#include <string>

namespace Harmos::composite {

/// A sample of a fibre composite (Dostál, Horák, Vlach, section 5): columns × rows of square cells, each a
/// fibre in its hole, the matrix squares making one body.
struct Sample {
  enum class Interface {
    Contact,    ///< fibres inserted without adhesion
    Adhesive,   ///< fibres glued to the matrix, until that breaks
    Tie,        ///< fibres bonded to the matrix
    Holes,      ///< no fibres
    Homogeneous ///< bonded fibres of the matrix' material
  };
  enum class Load { Stretch, Compression, Biaxial };

  int columns = 4;
  int rows = 4;
  Cell cell;                  ///< radius from the volume fraction
  double radiusScatter = 0.0; ///< radii vary by this much, relative
  double offsetScatter = 0.0; ///< centres vary by this much in x and in y, in sides of the cell
  int seed = 1;
  int fibreSubdomains = 1;  ///< of each fibre
  int matrixSubdomains = 1; ///< of each cell's matrix
  Interface interface = Interface::Contact;
  std::optional<effects::CohesiveLaw> adhesion; ///< of adhesive ones
  // Of friction in the contacts, one of these; 0: none.
  double slipBound = 0.0;           ///< Tresca: force per area
  double frictionCoefficient = 0.0; ///< Coulomb
  Load load = Load::Stretch;
  double strain = 0.01;
  std::string history; ///< of the load; "": from zero to all of it
  scene::Physics physics = scene::Physics::PlaneStrain;
  fem::Material matrix, fibre;
  std::string dilatation = "auto"; ///< "full", "projected", or by Poisson's ratio

  double area() const { return columns * rows * cell.size * cell.size; }
};

/// The scene of a sample. Left side: u_x = 0, right side: u_x = ± strain · width, bottom: u_y = 0; biaxial:
/// top u_y = strain · height too. Told of each step: strain, stress (force on the right side over the
/// height), biaxial: stress_y (on the top over the width).
/// @throws InputError if fibres do not fit into their cells.
scene::Scene makeScene(const Sample& sample);

} // namespace Harmos::composite
