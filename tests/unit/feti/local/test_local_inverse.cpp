// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Assembly.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_FixingDofs.hpp"
#include "Harmos_InverseQuality.hpp"
#include "Harmos_LocalInverses.hpp"
#include "Harmos_StructuredBlock.hpp"
#include "Harmos_TestElasticity.hpp"
#include "Harmos_TestModel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <set>

namespace test_local_inverse {

using namespace Harmos;
using namespace Harmos::feti;

namespace {

LocalMatrix chain(int n) {
  std::vector<MatrixEntry> entries;
  for (int i = 0; i + 1 < n; ++i)
    for (const auto& [a, b, v] :
         {std::tuple{i, i, 1.0}, {i + 1, i + 1, 1.0}, {i, i + 1, -1.0}, {i + 1, i, -1.0}})
      entries.push_back({a, b, v});
  return makeLocalMatrix(n, entries);
}

LocalMatrix square(int n) {
  return fem::assembleLaplace(*fem::makeRectangle({0, 0, 0}, {1, 1}, {1, 1}, {n, n}, 0).subdomain(0).mesh);
}

Dense toDense(const LocalMatrix& matrix) {
  const int n = matrix.rows();
  Dense result(n, n);
  for (int j = 0; j < n; ++j) {
    std::vector<double> unit(static_cast<std::size_t>(n), 0.0), column(static_cast<std::size_t>(n));
    unit[static_cast<std::size_t>(j)] = 1.0;
    matrix.multiply(unit.data(), column.data());
    for (int i = 0; i < n; ++i)
      result(i, j) = column[static_cast<std::size_t>(i)];
  }
  return result;
}

// K⁺ by its action on all unit vectors at once.
Dense toDense(const LocalInverse& inverse, int n) {
  Dense result(n, n);
  for (int i = 0; i < n; ++i)
    result(i, i) = 1.0;
  inverse.apply(result.values.data(), n);
  return result;
}

Dense toDense(const BoundaryOperator& op) {
  const int n = op.size();
  Dense unit(n, n), result(n, n);
  for (int i = 0; i < n; ++i)
    unit(i, i) = 1.0;
  op.apply(unit.values.data(), result.values.data(), n);
  return result;
}

// A floating piece of one of the kinds that the kernels are for.
struct Piece {
  std::string name;
  LocalMatrix matrix;
  Kernel kernel;
  std::vector<int> boundary;
};

std::vector<Piece> pieces() {
  std::vector<Piece> result;
  result.push_back({"scalar", square(4), heldKernel(constantKernel(25), {}), {0, 4, 10, 14, 20, 24}});
  for (int dimension : {2, 3}) {
    const TestSolid solid = testSolid(dimension, 3, 7.0);
    Piece piece = {
        std::to_string(dimension) + "D elastic", solid.stiffness, heldKernel(solid.motions, {}), {}};
    for (std::size_t node = 0; node < solid.nodes.size(); ++node)
      if (solid.nodes[node][0] == 0.0 || solid.nodes[node][0] == 1.0)
        for (int p = 0; p < dimension; ++p)
          piece.boundary.push_back(dimension * static_cast<int>(node) + p);
    result.push_back(piece);
  }
  return result;
}

std::unique_ptr<LocalInverse> make(const Piece& piece, DualForm form,
                                   const LocalInverseSettings& settings = {}) {
  const auto context = std::make_shared<FactorizationContext>();
  if (form == DualForm::Implicit)
    return makeImplicitInverse(piece.matrix, piece.kernel, piece.boundary, settings, context);
  return makeCondensedInverse(piece.matrix, piece.kernel, piece.boundary, 4, settings, context);
}

// One subdomain on rank 0, with an interface that holds it.
struct OneSubdomain {
  OneSubdomain(const LocalMatrix& matrix, const Kernel& motions) {
    if (testComm()->getRank() == 0) {
      Subdomain s;
      s.stiffness = std::make_shared<LocalMatrix>(matrix);
      s.motions = std::make_shared<Kernel>(motions);
      s.load = std::make_shared<std::vector<double>>(static_cast<std::size_t>(matrix.rows()), 0.0);
      s.interface = std::make_shared<std::vector<int>>();
      subdomains.push_back(s);
    }
    system = std::make_unique<SubdomainSystem>(testComm(), subdomains, DirichletForm::Dual);
    constraints = std::make_unique<Constraints>(*system, std::vector<ConstraintRow>());
  }

  // The text of the error, on every rank.
  std::string failure(const LocalInverseOptions& options = {}) const {
    try {
      makeLocalInverses(*system, *constraints, options);
    } catch (const NumericalError& error) {
      return error.what();
    }
    return "";
  }

  std::vector<Subdomain> subdomains;
  std::unique_ptr<SubdomainSystem> system;
  std::unique_ptr<Constraints> constraints;
};

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

} // namespace

TEST(FixingDofs, are_spread_and_distinct) {
  const Kernel eleven = heldKernel(constantKernel(11), {});
  EXPECT_EQ(fixingDofs(chain(11), eleven, 2), (std::vector<int>{0, 10}));
  EXPECT_EQ(fixingDofs(chain(11), eleven, 3), (std::vector<int>{0, 5, 10}));
  EXPECT_EQ(fixingDofs(chain(3), heldKernel(constantKernel(3), {}), 8).size(), 3u);
  const std::vector<int> many = fixingDofs(chain(40), heldKernel(constantKernel(40), {}), 10);
  EXPECT_EQ(std::set<int>(many.begin(), many.end()).size(), 10u);
}

// At each place all components of the displacement, and three places that are not on a line although one was
// asked for: the smallest singular value is no worse than a tenth of that of evenly spread dofs.
TEST(FixingDofs, hold_elastic_kernels) {
  for (const Piece& piece : pieces()) {
    for (int places : {1, 4, 8}) {
      const std::vector<int> dofs = fixingDofs(piece.matrix, piece.kernel, places);
      const Kernel rows = restricted(piece.kernel, dofs);
      EXPECT_GE(smallestSingularValue(rows), 0.1 * std::sqrt(double(rows.rows) / piece.matrix.rows()))
          << piece.name << " " << places;
      EXPECT_LE(rows.rows, 3 * std::max(4, places)) << piece.name; // not everything
    }
  }
}

// A disconnected part is infinitely far: it gets a fixing dof before any part gets its second one.
TEST(FixingDofs, reach_every_connected_part) {
  LocalMatrix two = makeLocalMatrix(6, {{0, 0, 1},
                                        {0, 1, -1},
                                        {1, 0, -1},
                                        {1, 1, 1},
                                        {2, 2, 1},
                                        {2, 3, -1},
                                        {3, 2, -1},
                                        {3, 3, 1},
                                        {4, 4, 1},
                                        {5, 5, 1}});
  const std::vector<int> fixing = fixingDofs(two, heldKernel(constantKernel(6), {}), 4);
  EXPECT_TRUE(std::count(fixing.begin(), fixing.end(), 4) == 1 &&
              std::count(fixing.begin(), fixing.end(), 5) == 1);
}

// K_ρ is positive definite, and its smallest eigenvalue is not below that of K on the complement by more than
// the number of dofs.
TEST(FixingDofs, regularized_matrix_is_positive_definite) {
  const LocalMatrix k = chain(12);
  const Kernel kernel = heldKernel(constantKernel(12), {});
  for (int count : {1, 2, 4, 12}) {
    const std::vector<double> spectrum =
        eigenvalues(toDense(regularized(k, kernel, fixingDofs(k, kernel, count))));
    EXPECT_GT(spectrum.front(), 1e-3) << count;
    EXPECT_LT(spectrum.back(), 8.0) << count; // ‖K‖ ≤ 4, ρ = 2
  }
}

// K K⁺ K = K and K⁺ symmetric, entry by entry; (K⁺)_bb is K⁺ at the boundary. Relative to ‖K‖ and to the
// largest entry of K⁺: errors are of the order κε.
TEST(LocalInverse, is_a_symmetric_generalised_inverse_of_each_kernel_in_each_form) {
  for (const Piece& piece : pieces())
    for (DualForm form : {DualForm::Implicit, DualForm::Condensed}) {
      const std::unique_ptr<LocalInverse> inverse = make(piece, form);
      const int n = piece.matrix.rows();
      const Dense k = toDense(piece.matrix), plus = toDense(*inverse, n);
      double largest = 0.0;
      for (double value : plus.values)
        largest = std::max(largest, std::abs(value));
      const double scale = piece.matrix.maxNorm();
      Dense product(n, n);
      for (int r = 0; r < n; ++r)
        for (int a = 0; a < n; ++a)
          for (int b = 0; k(r, a) != 0.0 && b < n; ++b)
            product(r, b) += k(r, a) * plus(a, b);
      for (int r = 0; r < n; ++r)
        for (int c = 0; c < n; ++c) {
          EXPECT_NEAR(plus(r, c), plus(c, r), 1e-12 * largest) << piece.name;
          double whole = 0.0;
          for (int b = 0; b < n; ++b)
            whole += product(r, b) * k(b, c);
          EXPECT_NEAR(whole, k(r, c), 1e-11 * scale) << piece.name;
        }
      const Dense boundary = toDense(inverse->boundaryOperator());
      for (std::size_t i = 0; i < piece.boundary.size(); ++i)
        for (std::size_t j = 0; j < piece.boundary.size(); ++j)
          EXPECT_NEAR(boundary(static_cast<int>(i), static_cast<int>(j)),
                      plus(piece.boundary[i], piece.boundary[j]), 1e-12 * largest)
              << piece.name;
    }
}

// S by the condensed form (MUMPS' Schur complement), by the implicit one (solves with K_ii), and by
// elimination.
TEST(LocalInverse, schur_complements_of_both_forms_agree_with_elimination) {
  for (const Piece& piece : pieces()) {
    LocalInverseSettings settings;
    settings.keepSchur = true;
    const int b = static_cast<int>(piece.boundary.size()), n = piece.matrix.rows();
    std::vector<int> interior;
    for (int i = 0; i < n; ++i)
      if (!std::binary_search(piece.boundary.begin(), piece.boundary.end(), i))
        interior.push_back(i);
    const int m = static_cast<int>(interior.size());
    const Dense k = toDense(piece.matrix);
    Dense kii(m, m), expected(b, b);
    for (int i = 0; i < m; ++i)
      for (int j = 0; j < m; ++j)
        kii(i, j) = k(interior[static_cast<std::size_t>(i)], interior[static_cast<std::size_t>(j)]);
    for (int c = 0; c < b; ++c) {
      const int column = piece.boundary[static_cast<std::size_t>(c)];
      std::vector<double> kib;
      for (int i : interior)
        kib.push_back(k(i, column));
      const std::vector<double> x = solveDense(kii, kib);
      for (int r = 0; r < b; ++r) {
        const int row = piece.boundary[static_cast<std::size_t>(r)];
        expected(r, c) = k(row, column);
        for (int i = 0; i < m; ++i)
          expected(r, c) -= k(row, interior[static_cast<std::size_t>(i)]) * x[static_cast<std::size_t>(i)];
      }
    }
    for (DualForm form : {DualForm::Implicit, DualForm::Condensed}) {
      const std::unique_ptr<LocalInverse> inverse = make(piece, form, settings);
      const Dense s = toDense(*inverse->schurComplement());
      for (std::size_t e = 0; e < s.values.size(); ++e)
        EXPECT_NEAR(s.values[e], expected.values[e], 1e-12 * piece.matrix.maxNorm() * n) << piece.name;
    }
  }
}

// Single precision: of dense blocks, or of sparse factors with one refinement. Errors of some 1e-7 κ in the
// block, larger than in double by orders, or the option would do nothing; of (1e-7 κ)² after refinement,
// which is little, but factors are half as large.
TEST(LocalInverse, single_precision_loses_what_it_should) {
  for (const Piece& piece : pieces())
    for (DualForm form : {DualForm::Implicit, DualForm::Condensed}) {
      LocalInverseSettings single;
      single.precision = Precision::Single;
      const auto inDouble = make(piece, form), inSingle = make(piece, form, single);
      const Dense exact = toDense(inDouble->boundaryOperator()),
                  rounded = toDense(inSingle->boundaryOperator());
      double difference = 0.0, largest = 0.0;
      for (std::size_t e = 0; e < exact.values.size(); ++e) {
        difference = std::max(difference, std::abs(exact.values[e] - rounded.values[e]));
        largest = std::max(largest, std::abs(exact.values[e]));
      }
      EXPECT_LT(difference, (form == DualForm::Condensed ? 1e-6 : 1e-10) * largest) << piece.name;
      EXPECT_GT(difference, (form == DualForm::Condensed ? 1e-9 : 1e-17) * largest) << piece.name;
      // Half of the factors, and the matrix, which the residuals need: regularised, somewhat larger.
      if (form == DualForm::Implicit)
        EXPECT_LE(inSingle->bytes(),
                  0.5 * inDouble->bytes() + 18.0 * static_cast<double>(piece.matrix.entries()));
    }
}

// Rounded products: of half the factor, the same to some 1e-7 κ, still symmetric; solutions of all dofs are
// refined. A limit that rounding errors do not keep to leaves all as it is, as does another matrix.
TEST(LocalInverse, products_are_rounded_within_a_limit) {
  for (const Piece& piece : pieces()) {
    const int n = piece.matrix.rows();
    const auto exact = make(piece, DualForm::Implicit), rounded = make(piece, DualForm::Implicit);
    const Dense products = toDense(exact->boundaryOperator());
    const auto difference = [&](const Dense& a, const Dense& b) {
      double most = 0.0, largest = 0.0;
      for (std::size_t e = 0; e < a.values.size(); ++e) {
        most = std::max(most, std::abs(a.values[e] - b.values[e]));
        largest = std::max(largest, std::abs(b.values[e]));
      }
      return most / largest;
    };
    rounded->roundProducts(7e-8); // above the unit roundoff, below what is left of it
    EXPECT_FALSE(rounded->hasRoundedProducts()) << piece.name;
    EXPECT_EQ(toDense(rounded->boundaryOperator()).values, products.values) << piece.name;
    EXPECT_EQ(rounded->bytes(), exact->bytes()) << piece.name;
    rounded->roundProducts(1e-5);
    ASSERT_TRUE(rounded->hasRoundedProducts()) << piece.name;
    const Dense found = toDense(rounded->boundaryOperator());
    EXPECT_LT(difference(found, products), 1e-5) << piece.name;
    EXPECT_GT(difference(found, products), 1e-9) << piece.name;
    const int b = found.rows;
    for (int i = 0; i < b; ++i)
      for (int j = 0; j < i; ++j) // sums in double: a rounded operator, not a noisy one
        EXPECT_NEAR(found(i, j), found(j, i), 1e-13 * products.values[0] * n) << piece.name;
    EXPECT_LT(difference(toDense(*rounded, n), toDense(*exact, n)), 1e-10) << piece.name;
    EXPECT_EQ(rounded->bytes(), 0.5 * exact->bytes()) << piece.name;
    EXPECT_EQ(rounded->boundaryOperator().bytesRead(1), 0.5 * exact->boundaryOperator().bytesRead(1));
    LocalMatrix twice = piece.matrix;
    for (double& value : twice.values)
      value *= 2.0;
    rounded->refactor(twice, piece.kernel);
    EXPECT_FALSE(rounded->hasRoundedProducts()) << piece.name;
    Dense half = products;
    for (double& value : half.values)
      value *= 0.5;
    EXPECT_LT(difference(toDense(rounded->boundaryOperator()), half), 1e-12) << piece.name;
  }
}

// Other direct solvers of Amesos2 in the implicit form, by name.
TEST(LocalInverse, klu2_does_as_mumps) {
  for (const Piece& piece : pieces()) {
    LocalInverseSettings klu;
    klu.solver.name = "KLU2";
    const Dense a = toDense(*make(piece, DualForm::Implicit), piece.matrix.rows());
    const Dense b = toDense(*make(piece, DualForm::Implicit, klu), piece.matrix.rows());
    double largest = 0.0;
    for (double value : a.values)
      largest = std::max(largest, std::abs(value));
    for (std::size_t e = 0; e < a.values.size(); ++e)
      EXPECT_NEAR(a.values[e], b.values[e], 1e-11 * largest) << piece.name;
  }
  LocalInverseSettings unknown;
  unknown.solver.name = "Magic";
  EXPECT_THROW(make(pieces()[0], DualForm::Implicit, unknown), InputError);
}

// A subdomain touched at one node, or at nodes on a line, has not enough boundary to hold its kernel: places
// that do join it.
TEST(LocalInverse, boundary_is_extended_where_it_does_not_hold_the_kernel) {
  for (const Piece& piece : pieces()) {
    std::vector<int> few = {piece.boundary.front()};
    const std::vector<int> extended = boundaryWithSupport(piece.matrix, piece.kernel, few, 4);
    EXPECT_TRUE(std::includes(extended.begin(), extended.end(), few.begin(), few.end()));
    if (piece.kernel.columns > 1)
      EXPECT_GT(extended.size(), few.size()) << piece.name;
    else
      EXPECT_EQ(extended, few);
    EXPECT_EQ(boundaryWithSupport(piece.matrix, piece.kernel, piece.boundary, 4), piece.boundary);
    EXPECT_FALSE(boundaryWithSupport(piece.matrix, piece.kernel, {}, 4).empty());
    const auto context = std::make_shared<FactorizationContext>();
    const auto inverse = makeCondensedInverse(piece.matrix, piece.kernel, extended, 1, {}, context);
    EXPECT_LT(inverseQuality(piece.matrix, piece.kernel, *inverse).defect, 1e-12) << piece.name;
  }
}

// The Schur complement of as many boundary dofs as rigid motions vanishes: its rounding errors, of either
// sign, must not be taken for stiffness.
TEST(LocalInverse, boundary_that_only_just_holds_the_kernel) {
  for (const Piece& piece : pieces())
    for (int dof : piece.boundary) {
      if (piece.kernel.columns != 1)
        continue;
      const auto context = std::make_shared<FactorizationContext>();
      const auto inverse = makeCondensedInverse(piece.matrix, piece.kernel, {dof}, 1, {}, context);
      EXPECT_LT(inverseQuality(piece.matrix, piece.kernel, *inverse).defect, 1e-12) << piece.name;
      // K⁺ holds the dof by the square root of ε times its stiffness.
      double largest = 0.0;
      for (double value : toDense(*inverse, piece.matrix.rows()).values)
        largest = std::max(largest, std::abs(value));
      const std::vector<double> diagonal = piece.matrix.diagonal();
      EXPECT_LT(largest, 1e2 / (1.5e-8 * *std::min_element(diagonal.begin(), diagonal.end()))) << piece.name;
    }
}

// The estimate is a lower bound of κ on the complement of the kernel, and not far below it.
TEST(LocalInverse, condition_estimate_is_of_the_right_order) {
  for (const Piece& piece : pieces()) {
    const std::vector<double> spectrum = eigenvalues(toDense(piece.matrix));
    const double condition = spectrum.back() / spectrum[static_cast<std::size_t>(piece.kernel.columns)];
    const double estimate =
        inverseQuality(piece.matrix, piece.kernel, *make(piece, DualForm::Condensed)).condition();
    EXPECT_LT(estimate, 10.0 * condition) << piece.name; // in the maximum norm
    EXPECT_GT(estimate, 0.02 * condition) << piece.name;
  }
}

// Subdomains with one matrix share one inverse, whatever their place; a content that differs by rounding
// counts as the same, one that differs by more does not.
TEST(LocalInverses, congruent_subdomains_share_a_factorisation) {
  TestModel model = testModel(4, 3);
  const auto count = [&](bool share, DirichletForm form) {
    const SubdomainSystem system(testComm(), model.subdomains, form);
    const Constraints constraints(system, model.rows);
    LocalInverseOptions options;
    options.share = share;
    return makeLocalInverses(system, constraints, options).distinctFactorizations();
  };
  const int here = static_cast<int>(model.subdomains.size());
  EXPECT_EQ(count(true, DirichletForm::Dual), 1);
  EXPECT_LE(count(true, DirichletForm::Primal), 2); // those at x = 0 are held
  EXPECT_EQ(count(false, DirichletForm::Dual), here);
  // Copies with noise of the size of rounding errors, each its own object.
  for (Subdomain& subdomain : model.subdomains) {
    auto copy = std::make_shared<LocalMatrix>(*subdomain.stiffness);
    for (std::size_t k = 0; k < copy->values.size(); ++k)
      copy->values[k] *=
          1.0 + 1e-15 * static_cast<double>((subdomain.number + static_cast<long long>(k)) % 5);
    subdomain.stiffness = copy;
  }
  EXPECT_EQ(count(true, DirichletForm::Dual), 1);
  // A material of its own for every other subdomain.
  for (Subdomain& subdomain : model.subdomains)
    if (subdomain.number % 2 == 1) {
      auto copy = std::make_shared<LocalMatrix>(*subdomain.stiffness);
      for (double& value : copy->values)
        value *= 1.0 + 1e-9;
      subdomain.stiffness = copy;
    }
  EXPECT_EQ(count(true, DirichletForm::Dual), 2);
}

// Two parts that are not connected, with the kernel of one: the subdomain and the cause are named on all
// ranks. Their singular K_ρ mostly factorises with a tiny positive pivot, and KK⁺Kx = Kx holds to rounding:
// only a probe outside of the range of K shows the second constant.
TEST(LocalInverses, disconnected_parts_are_found_at_every_size_in_both_forms) {
  for (int n : {3, 4, 5, 7, 9, 12})
    for (DualForm form : {DualForm::Implicit, DualForm::Condensed}) {
      const LocalMatrix block = square(n);
      const int size = block.rows();
      std::vector<MatrixEntry> entries;
      for (int part : {0, size})
        for (int i = 0; i < size; ++i)
          for (std::size_t k = block.offsets[static_cast<std::size_t>(i)];
               k < block.offsets[static_cast<std::size_t>(i) + 1]; ++k)
            entries.push_back({part + i, part + block.columns[k], block.values[k]});
      const OneSubdomain one(makeLocalMatrix(2 * size, entries), constantKernel(2 * size));
      LocalInverseOptions options;
      options.form = form;
      const std::string text = one.failure(options);
      EXPECT_TRUE(contains(text, "subdomain 0")) << n << text;
      EXPECT_TRUE(contains(text, "2 parts that are not connected")) << n << text;
    }
}

// A body said to be held that is not; a hinge.
TEST(LocalInverses, missing_support_and_mechanisms_are_told_apart) {
  const LocalMatrix k = square(4);
  const std::string unsupported = OneSubdomain(k, Kernel{k.rows(), 0, {}}).failure();
  EXPECT_TRUE(contains(unsupported, "lacks support")) << unsupported;
  for (int dimension : {2, 3}) {
    const TestSolid hinge = testSolid(dimension, 3, 1.0, true);
    const std::string text = OneSubdomain(hinge.stiffness, hinge.motions).failure();
    EXPECT_TRUE(contains(text, "a mechanism or a hinge")) << text;
  }
}

// The cross-check by MUMPS' null pivots, for each kernel; and its objection to a kernel that is too small
// where the other checks are not asked.
TEST(LocalInverses, null_pivots_count_the_kernel) {
  for (const Piece& piece : pieces())
    EXPECT_EQ(countNullPivots(piece.matrix), piece.kernel.columns) << piece.name;
  EXPECT_EQ(countNullPivots(testSolid(2, 3, 1.0, true).stiffness), 4);
  LocalInverseOptions options;
  options.checkNullPivots = true;
  EXPECT_EQ(OneSubdomain(square(4), constantKernel(25)).failure(options), "");
}

// A jump of the material inside of a subdomain: the regularisation must not wipe out the digits of the soft
// part, and a soft part is not a mechanism. Units of any size.
TEST(LocalInverses, jumps_inside_and_units) {
  for (double contrast : {1.0, 1e6, 1e9, 1e12})
    for (double unit : {1e-300, 1e-17, 1.0, 1e45})
      for (DualForm form : {DualForm::Implicit, DualForm::Condensed}) {
        const int n = 8;
        const fem::PlacedMesh mesh = fem::makeRectangle({0, 0, 0}, {1, 1}, {1, 1}, {n, n}, 0).subdomain(0);
        // Two halves assembled apart.
        std::vector<MatrixEntry> entries;
        for (int half : {0, 1}) {
          fem::Mesh part = *mesh.mesh;
          part.cells.clear();
          for (std::size_t c = 0; c < mesh.mesh->cells.size(); c += 4)
            if ((static_cast<int>(c / 4) % n < n / 2) == (half == 0))
              part.cells.insert(part.cells.end(), mesh.mesh->cells.begin() + static_cast<std::ptrdiff_t>(c),
                                mesh.mesh->cells.begin() + static_cast<std::ptrdiff_t>(c + 4));
          const LocalMatrix k = fem::assembleLaplace(part);
          for (int i = 0; i < k.rows(); ++i)
            for (std::size_t e = k.offsets[static_cast<std::size_t>(i)];
                 e < k.offsets[static_cast<std::size_t>(i) + 1]; ++e)
              entries.push_back({i, k.columns[e], unit * k.values[e] * (half == 0 ? contrast : 1.0)});
        }
        LocalInverseOptions options;
        options.form = form;
        const OneSubdomain one(makeLocalMatrix((n + 1) * (n + 1), entries),
                               constantKernel((n + 1) * (n + 1)));
        EXPECT_EQ(one.failure(options), "") << contrast << " " << unit;
      }
}

// Equal matrices of which one is said to have another kernel: the wrong one is found, shared or not.
TEST(LocalInverses, a_kernel_of_its_own_is_tried_by_itself) {
  TestModel model = testModel(2, 3);
  for (Subdomain& subdomain : model.subdomains)
    if (subdomain.number == 3)
      subdomain.motions = std::make_shared<Kernel>(Kernel{subdomain.stiffness->rows(), 0, {}});
  const SubdomainSystem system(testComm(), model.subdomains, DirichletForm::Dual);
  const Constraints constraints(system, model.rows);
  for (bool share : {true, false}) {
    LocalInverseOptions options;
    options.share = share;
    try {
      makeLocalInverses(system, constraints, options);
      FAIL() << "nothing was thrown";
    } catch (const NumericalError& error) {
      EXPECT_TRUE(contains(error.what(), "subdomain 3")) << error.what();
      EXPECT_TRUE(contains(error.what(), "lacks support")) << error.what();
    }
  }
}

// Prescribed displacements are no parts of their own in a diagnosis.
TEST(LocalInverses, held_dofs_do_not_count_as_parts) {
  const LocalMatrix matrix = makeLocalMatrix(3, {{0, 0, 1}, {1, 1, 1}, {1, 2, -1}, {2, 1, -1}, {2, 2, 1}});
  EXPECT_TRUE(contains(causeOfHiddenMotion(matrix, Kernel{3, 0, {}}).cause, "lacks support"));
}

} // namespace test_local_inverse
