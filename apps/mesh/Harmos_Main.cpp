// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_MeshProgram.hpp"

int main(int argc, char** argv) {
  return Harmos::app::meshMain(argc, argv);
}
