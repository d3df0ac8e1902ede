#pragma once
#include <stdexcept>
#include <string>
#include <string_view>

namespace trigrain {

/// Something from outside (a file, key, name, mesh) is wrong: one sentence "problem (where). what to do".
/// Programs print it and exit with 3.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The names of a table of variants as one list: "a, b, c". Rows of one name stand together and are named once.
template <class Table> std::string names_of(const Table& table) {
  std::string list;
  std::string_view last;
  for (const auto& row : table) {
    if (row.name != last) list += (list.empty() ? "" : ", ") + std::string(row.name);
    last = row.name;
  }
  return list;
}

/// The row of `table` called `name`; an unknown name is an InputError that lists the known ones.
/// `noun` says what kind of thing was asked for ("kernel", "grid", ...).
template <class Table> const auto& row_named(const Table& table, std::string_view noun, std::string_view name) {
  for (const auto& row : table)
    if (row.name == name) return row;
  throw InputError("unknown " + std::string(noun) + " '" + std::string(name) + "'. Known: " + names_of(table) + ".");
}

} // namespace trigrain
