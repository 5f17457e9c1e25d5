// SPDX-License-Identifier: BSD-3-Clause

/// The main program of all unit tests: MPI and Kokkos around GoogleTest. The test fails if it fails on any
/// rank; progress is printed by rank 0, failures by the rank that meets them.

#include "Harmos_TestComm.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <Tpetra_Core.hpp>
#include <gtest/gtest.h>

#include <iostream>

namespace {

// Failures of ranks other than 0, which has the ordinary printer.
class FailurePrinter : public testing::EmptyTestEventListener {
  void OnTestPartResult(const testing::TestPartResult& result) override {
    if (result.failed())
      std::cerr << "rank " << Harmos::testComm()->getRank() << ": " << result.file_name() << ":"
                << result.line_number() << ": " << result.message() << std::endl;
  }
};

} // namespace

int main(int argc, char** argv) {
  const Tpetra::ScopeGuard guard(&argc, &argv);
  testing::InitGoogleTest(&argc, argv);
  const auto comm = Harmos::testComm();
  if (comm->getRank() != 0) {
    testing::TestEventListeners& listeners = testing::UnitTest::GetInstance()->listeners();
    delete listeners.Release(listeners.default_result_printer());
    listeners.Append(new FailurePrinter);
  }
  const int mine = RUN_ALL_TESTS();
  int all = 0;
  Teuchos::reduceAll<int, int>(*comm, Teuchos::REDUCE_MAX, 1, &mine, &all);
  return all;
}
