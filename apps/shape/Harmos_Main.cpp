// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ShapeProgram.hpp"

int main(int argc, char** argv) {
  return Harmos::app::main(argc, argv, Harmos::shape::shapeProgram());
}
