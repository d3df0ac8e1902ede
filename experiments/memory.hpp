#pragma once
#include <cstdint>
#include <optional>

namespace trigrain {

/// Bytes of the heap that are in use, in all threads' arenas of the C library; none where it cannot tell.
std::optional<std::int64_t> heap_in_use();

} // namespace trigrain
