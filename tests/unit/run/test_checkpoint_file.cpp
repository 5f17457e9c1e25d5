// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CheckpointFile.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TrilinosVersion.hpp"
#include "Harmos_Types.hpp"

#include <Teuchos_DefaultMpiComm.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

namespace test_checkpoint_file {

using namespace Harmos;
using namespace Harmos::run;

namespace {

constexpr GlobalOrdinal length = 101;
using Comm = Teuchos::RCP<const Teuchos::Comm<int>>;

std::string path(const std::string& name) {
  const std::string directory = "checkpoints_np" + std::to_string(testComm()->getSize());
  if (testComm()->getRank() == 0)
    std::filesystem::create_directories(directory);
  testComm()->barrier();
  return directory + "/" + name;
}

// Dealt out in turns, the way rows of constraints may lie.
Teuchos::RCP<const Map> cyclicMap(const Comm& comm) {
  std::vector<GlobalOrdinal> mine;
  for (GlobalOrdinal k = comm->getRank(); k < length; k += comm->getSize())
    mine.push_back(k);
  return Teuchos::rcp(new Map(length, Teuchos::arrayViewFromVector(mine), 0, comm));
}

double entry(GlobalOrdinal row, std::size_t column) {
  return std::sin(1.0 + 0.7 * static_cast<double>(row) + 11.0 * static_cast<double>(column));
}

MultiVector filled(const Teuchos::RCP<const Map>& map, std::size_t columns) {
  MultiVector x(map, columns);
  const auto view = x.getLocalViewHost(Tpetra::Access::OverwriteAll);
  for (std::size_t i = 0; i < view.extent(0); ++i)
    for (std::size_t j = 0; j < columns; ++j)
      view(i, j) = entry(map->getGlobalElement(static_cast<LocalOrdinal>(i)), j);
  return x;
}

void expectFilled(const MultiVector& x) {
  const auto view = x.getLocalViewHost(Tpetra::Access::ReadOnly);
  for (std::size_t i = 0; i < view.extent(0); ++i)
    for (std::size_t j = 0; j < view.extent(1); ++j)
      EXPECT_EQ(view(i, j), entry(x.getMap()->getGlobalElement(static_cast<LocalOrdinal>(i)), j));
}

// G has two orthonormal rows, unit vectors of the unknowns 3 and 50, turned by an angle.
RowBasis turnedBasis(const Comm& comm, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {[c, s](const MultiVector& mu, MultiVector& dual) {
            const auto m = mu.getLocalViewHost(Tpetra::Access::ReadOnly);
            dual.putScalar(0.0);
            const auto d = dual.getLocalViewHost(Tpetra::Access::ReadWrite);
            const auto put = [&](GlobalOrdinal row, double value) {
              const auto place = dual.getMap()->getLocalElement(row);
              if (place != Teuchos::OrdinalTraits<LocalOrdinal>::invalid())
                d(static_cast<std::size_t>(place), 0) = value;
            };
            put(3, c * m(0, 0) - s * m(1, 0));
            put(50, s * m(0, 0) + c * m(1, 0));
          },
          [c, s, comm](const MultiVector& dual, MultiVector& mu) {
            double mine[2] = {0.0, 0.0}, all[2];
            const auto d = dual.getLocalViewHost(Tpetra::Access::ReadOnly);
            const GlobalOrdinal rows[2] = {3, 50};
            for (int k = 0; k < 2; ++k) {
              const auto place = dual.getMap()->getLocalElement(rows[k]);
              if (place != Teuchos::OrdinalTraits<LocalOrdinal>::invalid())
                mine[k] = d(static_cast<std::size_t>(place), 0);
            }
            Teuchos::reduceAll<int, double>(*comm, Teuchos::REDUCE_SUM, 2, mine, all);
            const auto m = mu.getLocalViewHost(Tpetra::Access::OverwriteAll);
            m(0, 0) = c * all[0] + s * all[1];
            m(1, 0) = -s * all[0] + c * all[1];
          }};
}

MultiVector rowVector(const Comm& comm, double first, double second) {
  MultiVector mu(Teuchos::rcp(new Map(Tpetra::global_size_t{2}, 0, comm, Tpetra::LocallyReplicated)), 1);
  const auto view = mu.getLocalViewHost(Tpetra::Access::OverwriteAll);
  view(0, 0) = first;
  view(1, 0) = second;
  return mu;
}

void write(const std::string& name, bool commits = true) {
  const Comm comm = testComm();
  CheckpointWriter writer(*comm, name, turnedBasis(comm, 0.3), 10000);
  const auto map = cyclicMap(comm);
  MultiVector x = filled(map, 3), y = filled(map, 1), mu = rowVector(comm, 0.25, -4.0);
  int count = 7;
  bool flag = true;
  double infinite = std::numeric_limits<double>::infinity();
  std::vector<double> list = {1.0, 2.5}, none;
  writer.vector("block", x);
  writer.number("count", count);
  writer.number("flag", flag);
  writer.vector("x", y);
  writer.rowVector("mu", mu);
  writer.number("infinite", infinite);
  writer.numbers("list", list);
  writer.numbers("none", none);
  writer.text("deck", "<ParameterList/>\n");
  if (commits)
    writer.commit();
}

// @param angle of the rows' basis at present; μ and what it is there.
void read(const Comm& comm, const std::string& name, double angle, double first, double second, double unit) {
  const CheckpointReader reader(*comm, name);
  EXPECT_EQ(reader.text("deck"), "<ParameterList/>\n");
  EXPECT_EQ(reader.text("absent"), "");
  EXPECT_TRUE(reader.holds("list"));
  EXPECT_FALSE(reader.holds("block"));
  reader.restore(turnedBasis(comm, angle), [&](qp::StateArchive<MultiVector>& archive) {
    EXPECT_TRUE(archive.isReading());
    const auto map = cyclicMap(comm);
    MultiVector x(map, 3), y(map, 1), mu = rowVector(comm, 0.0, 0.0);
    int count = 0;
    bool flag = false;
    double infinite = 0.0;
    std::vector<double> list, none = {1.0};
    archive.vector("block", x);
    archive.number("count", count);
    archive.number("flag", flag);
    archive.vector("x", y);
    archive.rowVector("mu", mu);
    archive.number("infinite", infinite);
    archive.numbers("list", list);
    archive.numbers("none", none);
    expectFilled(x);
    expectFilled(y);
    EXPECT_EQ(count, 7);
    EXPECT_TRUE(flag);
    EXPECT_TRUE(std::isinf(infinite));
    EXPECT_EQ(list, (std::vector<double>{1.0, 2.5}));
    EXPECT_TRUE(none.empty());
    const auto view = mu.getLocalViewHost(Tpetra::Access::ReadOnly);
    EXPECT_NEAR(view(0, 0), first, unit);
    EXPECT_NEAR(view(1, 0), second, unit);
  });
}

} // namespace

TEST(CheckpointFile, comes_back_as_it_was) {
  const std::string name = path("same.h5");
  write(name);
  read(testComm(), name, 0.3, 0.25, -4.0, 0.0);
}

// Rows of another basis: μ is what has the same Gᵀμ there. Turned by δ: μ' = (c μ₀ + s μ₁, −s μ₀ + c μ₁).
TEST(CheckpointFile, follows_the_basis_of_the_rows) {
  const std::string name = path("turned.h5");
  write(name);
  const double c = std::cos(0.6), s = std::sin(0.6);
  // Sums of two products of size 4: 10 ε.
  read(testComm(), name, 0.9, 0.25 * c - 4.0 * s, -0.25 * s - 4.0 * c, 1e-14);
}

TEST(CheckpointFile, another_number_of_ranks_reads_it) {
  const std::string name = path("alone.h5");
  write(name);
  // Each rank for itself.
  const Comm self = Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF));
  read(self, name, 0.3, 0.25, -4.0, 0.0);
  testComm()->barrier();
}

TEST(CheckpointFile, an_unfinished_one_is_none) {
  const std::string name = path("unfinished.h5");
  write(name, false);
  testComm()->barrier();
  const std::string message = inputErrorOf([&] { CheckpointReader(*testComm(), name); });
  EXPECT_TRUE(contains(message, "checkpoint not found: \"" + name + "\"")) << message;
}

TEST(CheckpointFile, what_does_not_fit_is_refused_by_name) {
  const std::string name = path("unfit.h5");
  write(name);
  const CheckpointReader reader(*testComm(), name);
  const auto failure = [&](const std::function<void(qp::StateArchive<MultiVector>&)>& exchange) {
    return inputErrorOf([&] { reader.restore(turnedBasis(testComm(), 0.3), exchange); });
  };
  double value = 0.0;
  const std::string absent = failure([&](auto& archive) { archive.number("penalty", value); });
  EXPECT_TRUE(contains(absent, "it has no \"penalty\"")) << absent;
  MultiVector narrow(cyclicMap(testComm()), 2);
  const std::string shape = failure([&](auto& archive) { archive.vector("block", narrow); });
  EXPECT_TRUE(contains(shape, "its \"block\" has 101 rows of 3, not 101 of 2")) << shape;
}

} // namespace test_checkpoint_file
