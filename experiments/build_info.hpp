#pragma once
#include <string_view>
#include <utility>

namespace trigrain {

/// How this program was built; written by build_info.cmake at build time.
struct BuildInfo {
  std::string_view version;
  std::string_view commit; ///< full hash; empty outside of a git checkout
  bool dirty;              ///< tracked files differed from the commit
  std::string_view compiler, build_type;
  std::string_view flags;         ///< as given to the compiler
  std::string_view arch;          ///< value of -march
  std::string_view arch_resolved; ///< what the compiler makes of it on this machine; empty if it does not say
  std::pair<std::string_view, std::string_view> libraries[8]; ///< name, version
};

extern const BuildInfo build_info;

} // namespace trigrain
