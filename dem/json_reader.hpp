#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace trigrain {

/// One value of a JSON file that knows its place in it. All that read a value throw an InputError "expected ..., found
/// ... (file: bodies[3].density_kg_m3). ..." if it is of another type or out of range.
class JsonReader {
 public:
  /// The file's outermost value. InputError if it cannot be read or is not JSON, with line and column; keys that appear
  /// twice in an object and numbers too large for a double are refused.
  static JsonReader open(const std::filesystem::path& file);

  /// The value of a key of this object, if it is there.
  std::optional<JsonReader> find(std::string_view key) const;
  /// The value of a key that must be there.
  JsonReader at(std::string_view key) const;
  /// Refuses this value unless it is an object without other keys than these; a mistyped key is told its nearest.
  void allow(std::initializer_list<std::string_view> keys) const;
  /// The elements of this array.
  std::vector<JsonReader> items() const;

  double number() const; ///< finite
  double positive() const;
  double not_negative() const;
  std::vector<double> numbers(std::size_t count) const;
  Eigen::Vector3d vector() const;
  int integer(int lowest, int highest) const;
  std::uint64_t seed() const;
  bool flag() const;
  std::string text() const;
  /// Text that is one of the names.
  std::string one_of(std::initializer_list<std::string_view> names) const;

  [[noreturn]] void refuse(const std::string& problem, const std::string& what_to_do) const;
  /// "scene.json: bodies[3].density_kg_m3".
  std::string place() const;
  /// The value as JSON text.
  std::string dump() const;

 private:
  JsonReader(std::shared_ptr<const nlohmann::json> document, const nlohmann::json* value, std::string file,
             std::string path);
  [[noreturn]] void refuse_unless(const std::string& expected) const;

  std::shared_ptr<const nlohmann::json> document_; ///< keeps value_ alive
  const nlohmann::json* value_;
  std::string file_, path_;
};

} // namespace trigrain
