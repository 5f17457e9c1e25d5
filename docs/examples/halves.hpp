// SPDX-License-Identifier: BSD-3-Clause
/// What the embedding examples have in common: an application that owns MPI and Kokkos, splits its ranks into
/// two halves, and gives each half to Harmos for a problem of its own.
#pragma once

#include <Kokkos_Core.hpp>
#include <Teuchos_Comm.hpp>
#include <Teuchos_DefaultMpiComm.hpp>
#include <mpi.h>

#include <functional>
#include <iostream>
#include <string>
#include <vector>

/// Runs work(communicator of the half, number of the half) and prints the line of text of each half's first
/// rank.
inline int
runOnHalves(int argc, char** argv,
            const std::function<std::string(const Teuchos::RCP<const Teuchos::Comm<int>>&, int)>& work) {
  MPI_Init(&argc, &argv);
  Kokkos::initialize(argc, argv);
  int rank = 0, size = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  const int half = rank % 2;
  MPI_Comm comm = MPI_COMM_NULL;
  MPI_Comm_split(MPI_COMM_WORLD, half, rank, &comm);
  std::string line;
  {
    const auto wrapped = Teuchos::rcp(new Teuchos::MpiComm<int>(comm));
    line = work(wrapped, half);
  } // all that Harmos made is gone before the communicator
  line.resize(200, ' ');
  std::vector<char> lines(static_cast<std::size_t>(rank == 0 ? 200 * size : 0));
  MPI_Gather(line.data(), 200, MPI_CHAR, lines.data(), 200, MPI_CHAR, 0, MPI_COMM_WORLD);
  for (int k = 0; rank == 0 && k < std::min(size, 2); ++k) {
    std::string text(lines.data() + 200 * k, 200);
    text.erase(text.find_last_not_of(' ') + 1);
    std::cout << text << "\n";
  }
  MPI_Comm_free(&comm);
  Kokkos::finalize();
  MPI_Finalize();
  return 0;
}
