#pragma once
#include "dem/runtime.hpp"
#include "kernels/name_table.hpp"

namespace trigrain {

/// The calling thread alone.
inline Team& one_thread() {
  static Team team(row_named(runtimes(), "runtime", "serial"), 1);
  return team;
}

} // namespace trigrain
