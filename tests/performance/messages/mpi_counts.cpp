// SPDX-License-Identifier: BSD-3-Clause

/// Counts calls and bytes of MPI's functions in a program that is started with this library preloaded: each
/// rank writes them to $HARMOS_MPI_COUNTS/<rank>.json when MPI ends. Bytes are those that leave a rank in
/// messages, and of a collective call what comes to it. See communication.py.

#include <cstdlib>
#include <fstream>
#include <map>
#include <mpi.h>
#include <string>

namespace {

struct Count {
  long long calls = 0, bytes = 0;
};

std::map<std::string, Count>& counts() {
  static std::map<std::string, Count> all;
  return all;
}

long long sizeOf(MPI_Datatype type) {
  int size = 0;
  PMPI_Type_size(type, &size);
  return size;
}

void add(const char* what, long long bytes) {
  Count& count = counts()[what];
  ++count.calls;
  count.bytes += bytes;
}

long long sumOf(const int* numbers, MPI_Comm comm) {
  int ranks = 0;
  PMPI_Comm_size(comm, &ranks);
  long long sum = 0;
  for (int r = 0; r < ranks; ++r)
    sum += numbers[r];
  return sum;
}

} // namespace

extern "C" {
int MPI_Send(const void* data, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm) {
  add("message", count * sizeOf(type));
  return PMPI_Send(data, count, type, to, tag, comm);
}
int MPI_Isend(const void* data, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm,
              MPI_Request* request) {
  add("message", count * sizeOf(type));
  return PMPI_Isend(data, count, type, to, tag, comm, request);
}
int MPI_Rsend(const void* data, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm) {
  add("message", count * sizeOf(type));
  return PMPI_Rsend(data, count, type, to, tag, comm);
}
int MPI_Allreduce(const void* send, void* receive, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  add("allreduce", count * sizeOf(type));
  return PMPI_Allreduce(send, receive, count, type, op, comm);
}
int MPI_Reduce(const void* send, void* receive, int count, MPI_Datatype type, MPI_Op op, int root,
               MPI_Comm comm) {
  add("reduce", count * sizeOf(type));
  return PMPI_Reduce(send, receive, count, type, op, root, comm);
}
int MPI_Bcast(void* data, int count, MPI_Datatype type, int root, MPI_Comm comm) {
  add("broadcast", count * sizeOf(type));
  return PMPI_Bcast(data, count, type, root, comm);
}
int MPI_Barrier(MPI_Comm comm) {
  add("barrier", 0);
  return PMPI_Barrier(comm);
}
int MPI_Allgather(const void* send, int sendCount, MPI_Datatype sendType, void* receive, int count,
                  MPI_Datatype type, MPI_Comm comm) {
  int ranks = 0;
  PMPI_Comm_size(comm, &ranks);
  add("allgather", static_cast<long long>(ranks) * count * sizeOf(type));
  return PMPI_Allgather(send, sendCount, sendType, receive, count, type, comm);
}
int MPI_Allgatherv(const void* send, int sendCount, MPI_Datatype sendType, void* receive, const int* receives,
                   const int* places, MPI_Datatype type, MPI_Comm comm) {
  add("allgather", sumOf(receives, comm) * sizeOf(type));
  return PMPI_Allgatherv(send, sendCount, sendType, receive, receives, places, type, comm);
}
int MPI_Alltoall(const void* send, int sendCount, MPI_Datatype sendType, void* receive, int count,
                 MPI_Datatype type, MPI_Comm comm) {
  int ranks = 0;
  PMPI_Comm_size(comm, &ranks);
  add("alltoall", static_cast<long long>(ranks) * count * sizeOf(type));
  return PMPI_Alltoall(send, sendCount, sendType, receive, count, type, comm);
}
int MPI_Alltoallv(const void* send, const int* sends, const int* from, MPI_Datatype sendType, void* receive,
                  const int* receives, const int* places, MPI_Datatype type, MPI_Comm comm) {
  add("alltoall", sumOf(receives, comm) * sizeOf(type));
  return PMPI_Alltoallv(send, sends, from, sendType, receive, receives, places, type, comm);
}
int MPI_Scan(const void* send, void* receive, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  add("scan", count * sizeOf(type));
  return PMPI_Scan(send, receive, count, type, op, comm);
}
int MPI_Finalize() {
  const char* folder = std::getenv("HARMOS_MPI_COUNTS");
  int rank = 0;
  PMPI_Comm_rank(MPI_COMM_WORLD, &rank);
  if (folder != nullptr) {
    std::ofstream file(std::string(folder) + "/" + std::to_string(rank) + ".json");
    file << "{";
    const char* between = "";
    for (const auto& [name, count] : counts()) {
      file << between << "\"" << name << "\": {\"calls\": " << count.calls << ", \"bytes\": " << count.bytes
           << "}";
      between = ", ";
    }
    file << "}\n";
  }
  return PMPI_Finalize();
}
}
