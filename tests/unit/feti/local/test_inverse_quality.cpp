// SPDX-License-Identifier: BSD-3-Clause

/// The check of local inverses knows the condition number: what rounding errors explain is accepted as long
/// as it is of use, what they do not explain is refused.

#include "Harmos_Elasticity.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_InverseQuality.hpp"
#include "Harmos_LocalInverses.hpp"
#include "Harmos_StructuredBlock.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestModel.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace test_inverse_quality {

using namespace Harmos;
using namespace Harmos::feti;

namespace {

// A floating strip in plane strain, of height one.
struct Strip {
  Strip(fem::CellType type, double length, int columns, int rows, double poisson) {
    fem::StructuredBlock::Options options;
    options.cellType = type;
    options.size = {length, 1.0, 0.0};
    options.elements = {columns, rows, 1};
    mesh = fem::StructuredBlock(options).subdomain(0).mesh;
    fem::Elasticity elasticity;
    elasticity.materials = {fem::Material::isotropic(1.0, poisson)};
    matrix = fem::assembleElasticity(*mesh, elasticity);
    kernel = heldKernel(rigidBodyKernel(mesh->coordinates, 2), {});
    for (int node : mesh->boundary)
      boundary.insert(boundary.end(), {2 * node, 2 * node + 1});
  }

  std::unique_ptr<LocalInverse> inverse(const LocalInverseSettings& settings) const {
    const auto context = std::make_shared<FactorizationContext>();
    return makeCondensedInverse(matrix, kernel, boundary, 1, settings, context);
  }

  // The energy of the error in a uniform stretch, over that of the stretch; any rigid motion may be in it.
  double stretchError(const LocalInverse& inverse) const {
    std::vector<double> u, x(static_cast<std::size_t>(matrix.rows())), image(x.size());
    for (std::size_t i = 0; i < mesh->coordinates.size(); ++i)
      u.push_back(i % 2 == 0 ? mesh->coordinates[i] : 0.0);
    matrix.multiply(u.data(), x.data());
    double whole = 0.0, wrong = 0.0;
    for (std::size_t i = 0; i < u.size(); ++i)
      whole += u[i] * x[i];
    inverse.apply(x.data(), 1);
    for (std::size_t i = 0; i < u.size(); ++i)
      u[i] -= x[i];
    matrix.multiply(u.data(), image.data());
    for (std::size_t i = 0; i < u.size(); ++i)
      wrong += u[i] * image[i];
    return std::abs(wrong) / whole;
  }

  std::shared_ptr<const fem::Mesh> mesh;
  LocalMatrix matrix;
  Kernel kernel;
  std::vector<int> boundary;
};

// What makeLocalInverses says of a strip on rank 0; empty if it is content.
std::string objection(const Strip& strip, const LocalInverseOptions& options) {
  std::vector<Subdomain> subdomains;
  std::vector<ConstraintRow> rows;
  if (testComm()->getRank() == 0) {
    Subdomain s;
    s.stiffness = std::make_shared<LocalMatrix>(strip.matrix);
    s.motions = std::make_shared<Kernel>(strip.kernel);
    s.load = std::make_shared<std::vector<double>>(static_cast<std::size_t>(strip.matrix.rows()), 0.0);
    s.interface = std::make_shared<std::vector<int>>(strip.boundary);
    for (int dof : strip.boundary) {
      s.numbers.push_back(dof);
      s.fixed.push_back({dof, 0.0}); // by a multiplier each: the boundary is as large as it can be
    }
    subdomains.push_back(s);
  }
  const SubdomainSystem system(testComm(), subdomains, DirichletForm::Dual);
  const Constraints constraints(system, rows);
  try {
    makeLocalInverses(system, constraints, options);
  } catch (const NumericalError& error) {
    return error.what();
  }
  return "";
}

LocalInverseOptions condensed(Precision precision) {
  LocalInverseOptions options;
  options.form = DualForm::Condensed;
  options.precision = precision;
  return options;
}

constexpr auto linear = fem::CellType::Quadrilateral4, quadratic = fem::CellType::Quadrilateral9;

} // namespace

// Strips whose inverses are as good as rounding allows, above the limits for small condition numbers.
TEST(InverseQuality, ill_conditioned_but_right) {
  const struct {
    Strip strip;
    Precision precision;
  } cases[] = {{Strip(quadratic, 55, 55, 1, 0.499999), Precision::Double},
               {Strip(linear, 1000, 100, 4, 0.4999), Precision::Double},
               {Strip(quadratic, 1000, 100, 4, 0.49), Precision::Double},
               {Strip(linear, 55, 55, 1, 0.3), Precision::Single},
               {Strip(linear, 55, 8, 8, 0.49), Precision::Single},
               {Strip(quadratic, 15, 40, 4, 0.4999), Precision::Single}};
  for (const auto& [strip, precision] : cases) {
    const LocalInverseOptions options = condensed(precision);
    const auto inverse = strip.inverse(options);
    const InverseQuality quality = inverseQuality(strip.matrix, strip.kernel, *inverse);
    EXPECT_GT(quality.defect, precision == Precision::Single ? 1e-4 : 1e-8) << strip.matrix.rows();
    EXPECT_LE(quality.defect, defectLimit(quality, options).acceptable);
    EXPECT_EQ(objection(strip, options), "");
    // Rounding errors enter the energy squared, with the condition number once more.
    EXPECT_LE(strip.stretchError(*inverse), 1e-2);
  }
}

// An inverse of another matrix, off by a millionth, or with a motion for a rigid one that is not: rounding
// does not explain that.
TEST(InverseQuality, well_conditioned_but_wrong) {
  const Strip strip(linear, 1, 8, 8, 0.3);
  for (double error : {1e-6, 1e-2}) {
    LocalMatrix other = strip.matrix;
    for (double& value : other.values)
      value *= 1.0 + error;
    Strip wrong = strip;
    wrong.matrix = other;
    const LocalInverseOptions options = condensed(error < 1e-4 ? Precision::Double : Precision::Single);
    const InverseQuality quality = inverseQuality(strip.matrix, strip.kernel, *wrong.inverse(options));
    EXPECT_GT(quality.defect, defectLimit(quality, options).rounding) << error;
  }
  Strip wrong = strip;
  ++wrong.kernel.columns;
  for (std::size_t i = 0; i < strip.mesh->coordinates.size(); ++i)
    wrong.kernel.values.push_back(i % 2 == 0 ? strip.mesh->coordinates[i] - 0.5 : 0.0);
  for (Precision precision : {Precision::Double, Precision::Single}) {
    const LocalInverseOptions options = condensed(precision);
    const InverseQuality quality = inverseQuality(strip.matrix, strip.kernel, *wrong.inverse(options));
    EXPECT_GT(quality.defect, defectLimit(quality, options).rounding);
  }
}

// Where κε is no longer small the cause, the place and the remedy are told.
TEST(InverseQuality, too_ill_conditioned_for_the_precision) {
  const std::string single = objection(Strip(linear, 300, 300, 1, 0.4999), condensed(Precision::Single));
  for (const char* part : {"subdomain 0", "the condition number of its matrix", "of single precision",
                           "\"Dual operator/Precision\" = \"double\""})
    EXPECT_TRUE(contains(single, part)) << single;
  const Strip hardest(linear, 1e5, 16, 8, 0.49);
  // In double precision solves take the place of the condensed inverse.
  EXPECT_EQ(objection(hardest, condensed(Precision::Double)), "");
  // And the remedies help.
  EXPECT_EQ(objection(Strip(linear, 300, 300, 1, 0.4999), condensed(Precision::Double)), "");
  LocalInverseOptions options;
  options.form = DualForm::Implicit;
  EXPECT_EQ(objection(hardest, options), "");
  // Factors in single precision that do not exist; where they are made in double and kept in single they do.
  options.precision = Precision::Single;
  EXPECT_EQ(objection(Strip(quadratic, 55, 55, 1, 0.4999), options), "");
  options.solver.name = "MUMPS";
  const std::string factors = objection(Strip(quadratic, 55, 55, 1, 0.4999), options);
  EXPECT_TRUE(contains(factors, "too large for single precision")) << factors;
}

} // namespace test_inverse_quality
