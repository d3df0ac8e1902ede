#include "dem/mesh.hpp"
#include "kernels/name_table.hpp"
#include <algorithm>
#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <string_view>

// The library that reads the files takes words for the number 0, skips what it does not know and clamps indices. So the
// text is first read line by line against the grammar of its format, which also tells the line of a mistake.

namespace trigrain {
namespace {

using Eigen::Vector3d;
using Words = std::vector<std::string_view>;

std::optional<double> number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) return {};
  return value;
}

std::optional<long> integer(std::string_view word) {
  long value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return {};
  return value;
}

bool numbers(const Words& words, std::size_t first, std::size_t count) {
  return words.size() >= first + count && std::all_of(words.begin() + first, words.begin() + first + count,
                                                      [](std::string_view w) { return number(w).has_value(); });
}

/// A text file as lines of words, without blank lines and what follows `comment`.
class Lines {
 public:
  Lines(std::string_view text, std::string file, char comment)
      : text_(text), file_(std::move(file)), comment_(comment) {}

  /// The next line's words; none at the end of the file.
  const Words& next() {
    words_.clear();
    while (words_.empty() && at_ < text_.size()) {
      const std::size_t end = std::min(text_.find_first_of("\r\n", at_), text_.size());
      line_ = text_.substr(at_, end - at_);
      line_ = line_.substr(0, line_.find(comment_));
      at_ = end + (text_.substr(end).starts_with("\r\n") ? 2 : 1);
      ++number_;
      for (std::size_t i = 0; (i = line_.find_first_not_of(" \t", i)) < line_.size();) {
        const std::size_t stop = std::min(line_.find_first_of(" \t", i), line_.size());
        words_.push_back(line_.substr(i, stop - i));
        i = stop;
      }
    }
    return words_;
  }
  [[noreturn]] void refuse(const std::string& expected) const {
    std::string found = words_.empty() ? "the end of the file" : "'" + std::string(line_.substr(0, 60)) + "'";
    std::erase_if(found, [](unsigned char c) { return c < ' '; });
    throw InputError("expected " + expected + ", found " + found + " (" + file_ + ": line " + std::to_string(number_) +
                     "). Correct the line or export the mesh again.");
  }
  void require(bool fits, const char* expected) const {
    if (!fits) refuse(expected);
  }
  int line() const { return number_; }
  std::size_t offset() const { return std::min(at_, text_.size()); }

 private:
  std::string_view text_, line_;
  std::string file_;
  char comment_;
  std::size_t at_ = 0;
  int number_ = 0;
  Words words_;
};

bool is(const Words& words, std::initializer_list<std::string_view> start) {
  return words.size() >= start.size() && std::equal(start.begin(), start.end(), words.begin());
}

void check_stl(Lines& lines) {
  const Words& words = lines.next();
  lines.require(is(words, {"solid"}), "'solid'");
  for (lines.next(); !words.empty(); lines.next()) {
    if (is(words, {"endsolid"}) || is(words, {"solid"})) continue;
    lines.require(is(words, {"facet", "normal"}), "'facet normal' or 'endsolid'"); // the normal is not used
    lines.next(), lines.require(is(words, {"outer", "loop"}), "'outer loop'");
    for (int k = 0; k < 3; ++k)
      lines.next(), lines.require(is(words, {"vertex"}) && words.size() == 4 && numbers(words, 1, 3),
                                  "'vertex' and three finite numbers");
    lines.next(), lines.require(is(words, {"endloop"}), "'endloop'");
    lines.next(), lines.require(is(words, {"endfacet"}), "'endfacet'");
  }
}

void check_obj(Lines& lines) {
  constexpr std::string_view known[] = {"vt", "vn", "vp", "o", "g", "s", "l", "p", "usemtl", "mtllib"};
  long vertices = 0, faces = 0, highest = 0;
  Lines at_highest = lines;
  for (const Words* words = &lines.next(); !words->empty(); words = &lines.next()) {
    if (is(*words, {"v"})) {
      lines.require(numbers(*words, 1, 3), "'v' and three finite numbers");
      ++vertices;
    } else if (is(*words, {"f"})) {
      lines.require(words->size() >= 4, "'f' and at least three corners");
      ++faces;
      for (std::size_t k = 1; k < words->size(); ++k) {
        const auto index = integer((*words)[k].substr(0, (*words)[k].find('/')));
        lines.require(index && *index != 0 && *index >= -vertices, "vertex numbers from 1 up, or from -1 back");
        if (*index > highest) highest = *index, at_highest = lines;
      }
    } else {
      lines.require(std::find(std::begin(known), std::end(known), (*words)[0]) != std::end(known),
                    "v, f, vt, vn, vp, o, g, s, l, p, usemtl or mtllib");
    }
  }
  lines.require(faces > 0, "a face: 'f' and at least three corners");
  if (highest > vertices)
    at_highest.refuse("vertex numbers up to " + std::to_string(vertices) + ", which is how many there are");
}

void check_off(Lines& lines) {
  Words words = lines.next();
  lines.require(is(words, {"OFF"}), "'OFF'");
  words.erase(words.begin());
  if (words.empty()) words = lines.next();
  const auto vertices = words.size() >= 2 ? integer(words[0]) : std::nullopt;
  const auto faces = words.size() >= 2 ? integer(words[1]) : std::nullopt;
  lines.require(vertices && faces && *vertices > 0 && *faces > 0, "the numbers of vertices, faces and edges");
  for (long i = 0; i < *vertices; ++i) lines.require(numbers(lines.next(), 0, 3), "three finite coordinates");
  for (long i = 0; i < *faces; ++i) {
    words = lines.next();
    const auto corners = words.empty() ? std::nullopt : integer(words[0]);
    lines.require(corners && *corners >= 3 && words.size() > static_cast<std::size_t>(*corners),
                  "a number of corners, at least 3, and so many vertex numbers");
    for (long k = 1; k <= *corners; ++k) {
      const auto index = integer(words[k]);
      if (!index || *index < 0 || *index >= *vertices)
        lines.refuse("vertex numbers from 0 to " + std::to_string(*vertices - 1));
    }
  }
}

struct PlyProperty {
  std::string name;
  int count_bytes, value_bytes; ///< count_bytes > 0: a list
};
struct PlyElement {
  std::string name;
  long count;
  std::vector<PlyProperty> properties;
};

int bytes_of_ply_type(std::string_view type) {
  constexpr std::pair<std::string_view, int> types[] = {{"char", 1},  {"uchar", 1},   {"int8", 1},   {"uint8", 1},
                                                        {"short", 2}, {"ushort", 2},  {"int16", 2},  {"uint16", 2},
                                                        {"int", 4},   {"uint", 4},    {"int32", 4},  {"uint32", 4},
                                                        {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
  for (const auto& [name, bytes] : types)
    if (name == type) return bytes;
  return 0;
}

struct PlyHeader {
  std::string format;
  std::vector<PlyElement> elements;
};

PlyHeader read_ply_header(Lines& lines) {
  const Words& words = lines.next();
  lines.require(words.size() == 1 && words[0] == "ply", "'ply'");
  lines.next();
  lines.require(words.size() == 3 && words[0] == "format" &&
                    (words[1] == "ascii" || words[1] == "binary_little_endian" || words[1] == "binary_big_endian"),
                "'format ascii', 'format binary_little_endian' or 'format binary_big_endian', and a version");
  PlyHeader header{std::string(words[1]), {}};
  for (lines.next(); !is(words, {"end_header"}); lines.next()) {
    if (is(words, {"comment"}) || is(words, {"obj_info"})) continue;
    if (is(words, {"element"}) && words.size() == 3) {
      const auto count = integer(words[2]);
      lines.require(count && *count >= 0, "'element', its name and how many there are");
      header.elements.push_back({std::string(words[1]), *count, {}});
      continue;
    }
    const bool list = is(words, {"property", "list"}) && words.size() == 5,
               scalar = is(words, {"property"}) && words.size() == 3;
    lines.require((list || scalar) && !header.elements.empty(), "'element', 'property' or 'end_header'");
    const int count_bytes = list ? bytes_of_ply_type(words[2]) : 0;
    const int value_bytes = bytes_of_ply_type(words[list ? 3 : 1]);
    lines.require(value_bytes && (!list || (count_bytes && count_bytes <= 4)), "a type such as float, int or uchar");
    header.elements.back().properties.push_back({std::string(words.back()), count_bytes, value_bytes});
  }
  return header;
}

void check_ascii_ply(Lines& lines, const PlyHeader& header) {
  long vertices = 0;
  for (const PlyElement& element : header.elements)
    if (element.name == "vertex") vertices = element.count;
  for (const PlyElement& element : header.elements)
    for (long i = 0; i < element.count; ++i) {
      const Words& words = lines.next();
      std::size_t at = 0;
      for (const PlyProperty& property : element.properties) {
        const bool indices = property.name == "vertex_indices" || property.name == "vertex_index";
        long count = 1;
        if (property.count_bytes > 0) {
          count = at < words.size() ? integer(words[at++]).value_or(-1) : -1;
          lines.require(count >= (indices ? 3 : 0), "the length of a list, for faces at least 3");
        }
        for (long k = 0; k < count; ++k, ++at) {
          lines.require(numbers(words, at, 1), "a finite number for every property");
          const auto index = indices ? integer(words[at]) : 0;
          if (!index || *index < 0 || *index >= std::max(vertices, 1L))
            lines.refuse("vertex numbers from 0 to " + std::to_string(vertices - 1));
        }
      }
    }
}

/// Number of bytes that the body of a binary PLY file needs; stops counting beyond its end.
std::size_t binary_ply_size(const PlyHeader& header, std::string_view body) {
  const bool little = header.format == "binary_little_endian";
  std::size_t at = 0;
  for (const PlyElement& element : header.elements)
    for (long i = 0; i < element.count && at <= body.size(); ++i)
      for (const PlyProperty& property : element.properties) {
        std::size_t count = 1;
        if (property.count_bytes > 0) {
          count = 0;
          if (at + property.count_bytes > body.size()) return body.size() + 1;
          for (int b = 0; b < property.count_bytes; ++b)
            count = count << 8 | static_cast<unsigned char>(body[at + (little ? property.count_bytes - 1 - b : b)]);
          at += property.count_bytes;
        }
        at += count * property.value_bytes;
      }
  return at;
}

void check_ply(Lines& lines, std::string_view content, const std::string& file) {
  const PlyHeader header = read_ply_header(lines);
  const auto has = [&](std::string_view name) {
    return std::any_of(header.elements.begin(), header.elements.end(),
                       [&](const PlyElement& e) { return e.name == name && e.count > 0; });
  };
  lines.require(has("vertex") && has("face"), "elements 'vertex' and 'face' before 'end_header'");
  if (header.format == "ascii") return check_ascii_ply(lines, header);
  const std::string_view body = content.substr(lines.offset());
  if (binary_ply_size(header, body) > body.size())
    throw InputError("the file ends before its last face (" + file + ": " + std::to_string(content.size()) +
                     " bytes). Copy it again or export the mesh again.");
}

/// A binary STL holds 84 bytes and 50 for each triangle; its text form begins with 'solid', which binary ones may, too.
void check_any_stl(Lines& lines, std::string_view content, const std::string& file) {
  std::uint32_t triangles = 0; // little endian
  for (int b = 3; b >= 0 && content.size() >= 84; --b)
    triangles = triangles << 8 | static_cast<unsigned char>(content[80 + b]);
  if (content.size() >= 84 && content.size() == 84 + 50 * static_cast<std::size_t>(triangles)) return;
  if (content.substr(0, 512).find('\0') == content.npos) return check_stl(lines);
  throw InputError("a binary STL of " + std::to_string(triangles) + " triangles needs " +
                   std::to_string(84 + 50 * static_cast<std::size_t>(triangles)) + " bytes and this one has " +
                   std::to_string(content.size()) + " (" + file + "). Copy it again or export the mesh again.");
}

void check_content(const std::string& extension, std::string_view content, const std::string& file) {
  Lines lines(content, file, extension == ".obj" || extension == ".off" ? '#' : '\0');
  if (extension == ".stl") check_any_stl(lines, content, file);
  if (extension == ".obj") check_obj(lines);
  if (extension == ".off") check_off(lines);
  if (extension == ".ply") check_ply(lines, content, file);
}

std::string read_all(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string content;
  if (in && !std::filesystem::is_directory(file)) content.assign(std::istreambuf_iterator<char>(in), {});
  if (!in || std::filesystem::is_directory(file))
    throw InputError("cannot read the mesh (" + file.string() + "). Check the path and the right to read it.");
  if (content.empty()) throw InputError("the mesh file is empty (" + file.string() + "). Export the mesh again.");
  return content;
}

} // namespace

Mesh load_mesh(const std::filesystem::path& file, double scale) {
  if (!(std::isfinite(scale) && scale > 0))
    throw InputError("the scale is " + std::to_string(scale) + " (" + file.string() +
                     "). Give a positive number: m per unit of the file.");
  std::string extension = file.extension().string();
  for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  if (extension != ".stl" && extension != ".obj" && extension != ".ply" && extension != ".off")
    throw InputError("unknown mesh format (" + file.string() + "). Known: .stl, .obj, .ply, .off.");
  const std::string content = read_all(file);
  check_content(extension, content, file.string());

  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFileFromMemory(
      content.data(), content.size(), aiProcess_Triangulate | aiProcess_ValidateDataStructure, extension.c_str() + 1);
  if (!scene) {
    std::string reason = importer.GetErrorString();
    for (char& c : reason) c = c < ' ' ? ' ' : c;
    throw InputError("cannot read the mesh: " + reason.substr(0, 100) + " (" + file.string() +
                     "). Export the mesh again.");
  }
  std::vector<Vector3d> vertices;
  std::vector<std::array<int, 3>> faces;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& part = *scene->mMeshes[m];
    const int first = static_cast<int>(vertices.size());
    for (unsigned i = 0; i < part.mNumVertices; ++i)
      vertices.push_back(scale * Vector3d(part.mVertices[i].x, part.mVertices[i].y, part.mVertices[i].z));
    for (unsigned i = 0; i < part.mNumFaces; ++i) {
      const aiFace& f = part.mFaces[i];
      if (f.mNumIndices != 3) continue; // points and lines
      const auto corner = [&](int k) { return first + static_cast<int>(f.mIndices[k]); };
      faces.push_back({corner(0), corner(1), corner(2)});
    }
  }
  return make_mesh(file.string(), std::move(vertices), std::move(faces));
}

} // namespace trigrain
