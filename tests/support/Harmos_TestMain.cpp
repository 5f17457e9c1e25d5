// SPDX-License-Identifier: BSD-3-Clause

/// The main program of all unit tests: MPI and Kokkos around GoogleTest. The test fails if it fails on any
/// rank; progress is printed by rank 0, failures by the rank that meets them. Tests run in a temporary
/// directory, so that no file with a relative path stays behind.

#include "Harmos_MpiStart.hpp"
#include "Harmos_TestComm.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <Tpetra_Core.hpp>
#include <gtest/gtest.h>

#include <filesystem>
#include <iostream>
#include <string>
#include <unistd.h>

namespace {

// Failures of ranks other than 0, which has the ordinary printer.
class FailurePrinter : public testing::EmptyTestEventListener {
  void OnTestPartResult(const testing::TestPartResult& result) override {
    if (result.failed())
      std::cerr << "rank " << Harmos::testComm()->getRank() << ": " << result.file_name() << ":"
                << result.line_number() << ": " << result.message() << std::endl;
  }
};

// The working directory of all ranks during the tests; removed with its files afterwards.
class WorkingDirectory {
 public:
  explicit WorkingDirectory(const Teuchos::Comm<int>& comm) : comm_(comm) {
    long long process = getpid(); // of rank 0
    Teuchos::broadcast<int, long long>(comm_, 0, 1, &process);
    directory_ = std::filesystem::temp_directory_path() / ("harmos_tests_" + std::to_string(process));
    std::filesystem::create_directories(directory_);
    std::filesystem::current_path(directory_);
  }
  ~WorkingDirectory() {
    std::error_code ignored;
    std::filesystem::current_path(before_, ignored);
    comm_.barrier();
    std::filesystem::remove_all(directory_, ignored);
  }
  WorkingDirectory(const WorkingDirectory&) = delete;
  WorkingDirectory& operator=(const WorkingDirectory&) = delete;

 private:
  const Teuchos::Comm<int>& comm_;
  std::filesystem::path before_ = std::filesystem::current_path(), directory_;
};

} // namespace

int main(int argc, char** argv) {
  Harmos::prepareMpiStart();
  const Tpetra::ScopeGuard guard(&argc, &argv);
  testing::InitGoogleTest(&argc, argv);
  const auto comm = Harmos::testComm();
  if (comm->getRank() != 0) {
    testing::TestEventListeners& listeners = testing::UnitTest::GetInstance()->listeners();
    delete listeners.Release(listeners.default_result_printer());
    listeners.Append(new FailurePrinter);
  }
  const WorkingDirectory directory(*comm);
  const int mine = RUN_ALL_TESTS();
  int all = 0;
  Teuchos::reduceAll<int, int>(*comm, Teuchos::REDUCE_MAX, 1, &mine, &all);
  return all;
}
