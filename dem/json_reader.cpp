#include "dem/json_reader.hpp"
#include "kernels/name_table.hpp"
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

namespace trigrain {
namespace {

using nlohmann::json;

std::string read_all(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string content;
  if (in && !std::filesystem::is_directory(file)) content.assign(std::istreambuf_iterator<char>(in), {});
  if (!in || std::filesystem::is_directory(file))
    throw InputError("cannot read the file (" + file.string() + "). Check the path and the right to read it.");
  return content;
}

/// "line 3, column 14" of a byte, counted from 1.
std::string line_and_column(const std::string& text, std::size_t byte) {
  const std::string_view before = std::string_view(text).substr(0, std::min(byte, text.size()));
  const auto line = std::count(before.begin(), before.end(), '\n') + 1;
  const std::size_t start = before.rfind('\n') == before.npos ? 0 : before.rfind('\n') + 1;
  return "line " + std::to_string(line) + ", column " + std::to_string(before.size() - start + 1);
}

std::string after(const std::string& text, std::string_view mark) {
  const std::size_t at = text.find(mark);
  return at == text.npos ? text : text.substr(at + mark.size());
}

json parse(const std::string& text, const std::string& file) {
  std::vector<std::set<std::string>> open_objects;
  const auto watch_keys = [&](int, json::parse_event_t event, json& parsed) {
    if (event == json::parse_event_t::object_start) open_objects.emplace_back();
    if (event == json::parse_event_t::object_end) open_objects.pop_back();
    if (event == json::parse_event_t::key && !open_objects.back().insert(parsed.get<std::string>()).second)
      throw InputError("the key '" + parsed.get<std::string>() + "' appears twice in one object (" + file +
                       "). Keep one of them.");
    return true;
  };
  try {
    return json::parse(text, watch_keys);
  } catch (const json::parse_error& e) {
    const std::size_t byte = e.byte > 0 ? e.byte - 1 : 0; // the library counts from 1
    std::string reason = after(e.what(), "syntax error ");
    std::replace_if(
        reason.begin(), reason.end(), [](unsigned char c) { return c < ' '; }, ' ');
    throw InputError("not valid JSON: " + reason.substr(0, 150) + " (" + file + ": " + line_and_column(text, byte) +
                     "). Correct the syntax there.");
  } catch (const json::out_of_range& e) {
    const std::string literal = after(e.what(), "parsing '");
    const std::string shown = literal.substr(0, literal.find('\''));
    throw InputError("the number " + shown + " is too large (" + file + ": " + line_and_column(text, text.find(shown)) +
                     "). Give a finite number.");
  }
}

/// Number of letters to insert, delete or replace (Levenshtein 1966).
int edit_distance(std::string_view a, std::string_view b) {
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    int diagonal = row[0];
    row[0] = static_cast<int>(i) + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const int replaced = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

std::string listed(std::initializer_list<std::string_view> names) {
  std::string list;
  for (const auto name : names) list += (list.empty() ? "" : ", ") + std::string(name);
  return list;
}

} // namespace

JsonReader::JsonReader(std::shared_ptr<const json> document, const json* value, std::string file, std::string path)
    : document_(std::move(document)), value_(value), file_(std::move(file)), path_(std::move(path)) {}

JsonReader JsonReader::open(const std::filesystem::path& file) {
  auto document = std::make_shared<const json>(parse(read_all(file), file.string()));
  const json* value = document.get();
  return {std::move(document), value, file.string(), ""};
}

std::optional<JsonReader> JsonReader::find(std::string_view key) const {
  if (!value_->is_object()) refuse_unless("an object");
  const auto found = value_->find(key);
  if (found == value_->end()) return {};
  return JsonReader{document_, &*found, file_, path_ + (path_.empty() ? "" : ".") + std::string(key)};
}

JsonReader JsonReader::at(std::string_view key) const {
  if (auto found = find(key)) return *found;
  refuse("the key '" + std::string(key) + "' is missing", "Add it.");
}

void JsonReader::allow(std::initializer_list<std::string_view> keys) const {
  if (!value_->is_object()) refuse_unless("an object with " + listed(keys));
  for (const auto& [key, value] : value_->items()) {
    if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
    const auto nearest =
        std::min_element(keys.begin(), keys.end(), [&, &key = key](std::string_view a, std::string_view b) {
          return edit_distance(key, a) < edit_distance(key, b);
        });
    const bool near = 2 * edit_distance(key, *nearest) <= static_cast<int>(nearest->size());
    find(key)->refuse("unknown key '" + key + "'",
                      near ? "Did you mean '" + std::string(*nearest) + "'?" : "Known: " + listed(keys) + ".");
  }
}

std::vector<JsonReader> JsonReader::items() const {
  if (!value_->is_array()) refuse_unless("a list");
  std::vector<JsonReader> list;
  for (std::size_t i = 0; i < value_->size(); ++i)
    list.push_back({document_, &(*value_)[i], file_, path_ + "[" + std::to_string(i) + "]"});
  return list;
}

double JsonReader::number() const {
  if (!value_->is_number()) refuse_unless("a number");
  return value_->get<double>();
}

double JsonReader::positive() const {
  if (!value_->is_number() || !(value_->get<double>() > 0)) refuse_unless("a positive number");
  return value_->get<double>();
}

double JsonReader::not_negative() const {
  if (!value_->is_number() || !(value_->get<double>() >= 0)) refuse_unless("a number that is not negative");
  return value_->get<double>();
}

std::vector<double> JsonReader::numbers(std::size_t count) const {
  if (!value_->is_array() || value_->size() != count) refuse_unless("a list of " + std::to_string(count) + " numbers");
  std::vector<double> list;
  for (const JsonReader& item : items()) list.push_back(item.number());
  return list;
}

Eigen::Vector3d JsonReader::vector() const {
  const std::vector<double> c = numbers(3);
  return {c[0], c[1], c[2]};
}

int JsonReader::integer(int lowest, int highest) const {
  const double value = value_->is_number() ? value_->get<double>() : NAN; // 2.0 is an integer, as in JSON Schema
  if (!(value >= lowest && value <= highest && value == std::floor(value)))
    refuse_unless("an integer from " + std::to_string(lowest) + " to " + std::to_string(highest));
  return static_cast<int>(value);
}

std::uint64_t JsonReader::seed() const {
  if (!value_->is_number_unsigned()) refuse_unless("an integer from 0 to 2^64 - 1");
  return value_->get<std::uint64_t>();
}

bool JsonReader::flag() const {
  if (!value_->is_boolean()) refuse_unless("true or false");
  return value_->get<bool>();
}

std::string JsonReader::text() const {
  if (!value_->is_string()) refuse_unless("text");
  const std::string text = value_->get<std::string>();
  if (text.empty() || std::any_of(text.begin(), text.end(), [](unsigned char c) { return c < ' '; }))
    refuse_unless("text without control characters");
  return text;
}

std::string JsonReader::one_of(std::initializer_list<std::string_view> names) const {
  const std::string name = text();
  if (std::find(names.begin(), names.end(), name) == names.end())
    refuse("unknown name '" + name + "'", "Known: " + listed(names) + ".");
  return name;
}

void JsonReader::refuse(const std::string& problem, const std::string& what_to_do) const {
  std::string message = problem + " (" + place() + "). " + what_to_do;
  std::replace_if(
      message.begin(), message.end(), [](unsigned char c) { return c < ' '; }, '?'); // keys may hold any
  throw InputError(message);
}

void JsonReader::refuse_unless(const std::string& expected) const {
  std::string found = dump();
  if (found.size() > 40) found = found.substr(0, 37) + "...";
  refuse("expected " + expected + ", found " + found, "Correct the value.");
}

std::string JsonReader::place() const { return path_.empty() ? file_ : file_ + ": " + path_; }

std::string JsonReader::dump() const { return value_->dump(-1, ' ', true); }

} // namespace trigrain
