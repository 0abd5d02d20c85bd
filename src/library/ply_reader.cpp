// SPDX-License-Identifier: BSD-3-Clause
// PLY, ascii and binary (Greg Turk, "The PLY Polygon File Format", 1994). A file of n bytes costs O(n) time and memory,
// whatever its header claims.
#include <fcntl.h>
#include <locale.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <sstream>

#include "voxid/library/mesh_reader.h"

namespace voxid {
namespace {

constexpr std::size_t kMaxHeaderBytes = 1 << 16;
constexpr std::size_t kMaxNumberChars = 63;

enum class Type : std::uint8_t { I8, U8, I16, U16, I32, U32, F32, F64, None };
enum class Encoding : std::uint8_t { Ascii, Little, Big };

std::size_t sizeOf(Type type) {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8, 0};
  return kSizes[static_cast<int>(type)];
}

Type typeNamed(const std::string& name) {
  struct Named {
    const char *old_name, *new_name;
    Type type;
  };
  constexpr Named kTypes[] = {{"char", "int8", Type::I8},      {"uchar", "uint8", Type::U8},
                              {"short", "int16", Type::I16},   {"ushort", "uint16", Type::U16},
                              {"int", "int32", Type::I32},     {"uint", "uint32", Type::U32},
                              {"float", "float32", Type::F32}, {"double", "float64", Type::F64}};
  for (const Named& t : kTypes) {
    if (name == t.old_name || name == t.new_name) return t.type;
  }
  return Type::None;
}

struct Property {
  std::string name;
  Type type = Type::None;
  Type count_type = Type::None;  ///< of a list's length; None: a single value
  bool isList() const { return count_type != Type::None; }
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;

  int find(const char* property) const {
    for (std::size_t i = 0; i < properties.size(); ++i) {
      if (properties[i].name == property) return static_cast<int>(i);
    }
    return -1;
  }
  /// The least that one row takes, so that a count can be held against what is left of the file.
  std::uint64_t leastRowBytes(Encoding encoding) const {
    std::uint64_t bytes = 0;
    for (const Property& p : properties)
      bytes += encoding == Encoding::Ascii ? 2 : sizeOf(p.isList() ? p.count_type : p.type);
    return bytes;
  }
};

struct Header {
  Encoding encoding = Encoding::Ascii;
  std::vector<Element> elements;
  std::size_t bytes = 0;
};

/// The file's bytes, mapped.
class MappedFile {
 public:
  explicit MappedFile(const std::string& path) {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    struct stat about {};
    if (file < 0 || ::fstat(file, &about) != 0 || !S_ISREG(about.st_mode)) {
      error_ = file >= 0 && !S_ISREG(about.st_mode) ? EISDIR : errno;
    } else if (about.st_size > 0) {
      map(file, static_cast<std::size_t>(about.st_size));
    }
    if (file >= 0) ::close(file);
  }
  ~MappedFile() {
    if (data_ != nullptr) ::munmap(const_cast<char*>(data_), size_);
  }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  int error() const { return error_; }
  const char* begin() const { return data_; }
  const char* end() const { return data_ + size_; }
  std::size_t size() const { return size_; }

 private:
  void map(int file, std::size_t size) {
    void* const data = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file, 0);
    if (data == MAP_FAILED) {
      error_ = errno;
      return;
    }
    data_ = static_cast<const char*>(data);
    size_ = size;
  }

  int error_ = 0;
  const char* data_ = nullptr;
  std::size_t size_ = 0;
};

/// Reads the values of the body one by one; `failed()` sticks once something was missing or no number.
class Body {
 public:
  Body(const char* begin, const char* end, Encoding encoding) : at_(begin), end_(end), encoding_(encoding) {}

  bool failed() const { return failed_; }
  std::uint64_t left() const { return static_cast<std::uint64_t>(end_ - at_); }

  double next(Type type) { return encoding_ == Encoding::Ascii ? nextText() : nextBinary(type); }

  /// A list's length; a negative or broken one fails.
  std::uint64_t nextCount(Type type) {
    const double count = next(type);
    const bool whole = count >= 0 && count <= std::numeric_limits<std::uint32_t>::max() && count == std::floor(count);
    if (!whole) failed_ = true;
    return whole ? static_cast<std::uint64_t>(count) : 0;
  }

  void skip(Type type, std::uint64_t values) {
    if (encoding_ == Encoding::Ascii) {
      for (std::uint64_t i = 0; i < values && !failed_; ++i) nextText();
      return;
    }
    if (values > left() / sizeOf(type)) {
      failed_ = true;
      return;
    }
    at_ += values * sizeOf(type);
  }

 private:
  static bool isSpace(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }

  double nextText() {
    while (at_ != end_ && isSpace(*at_)) ++at_;
    const char* const first = at_;
    while (at_ != end_ && !isSpace(*at_)) ++at_;
    const std::size_t length = static_cast<std::size_t>(at_ - first);
    if (length == 0 || length > kMaxNumberChars) return fail();
    char text[kMaxNumberChars + 1];
    std::memcpy(text, first, length);
    text[length] = '\0';
    static const locale_t c_locale = ::newlocale(LC_ALL_MASK, "C", nullptr);
    char* stop = nullptr;
    const double value = ::strtod_l(text, &stop, c_locale);
    return stop == text + length ? value : fail();
  }

  double nextBinary(Type type) {
    const std::size_t size = sizeOf(type);
    if (left() < size) return fail();
    unsigned char bytes[8];
    std::memcpy(bytes, at_, size);
    at_ += size;
    if (encoding_ == Encoding::Big) std::reverse(bytes, bytes + size);
    return decode(type, bytes);
  }

  template <typename T>
  static double as(const unsigned char* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return static_cast<double>(value);
  }

  static double decode(Type type, const unsigned char* bytes) {
    switch (type) {
      case Type::I8:
        return as<std::int8_t>(bytes);
      case Type::U8:
        return as<std::uint8_t>(bytes);
      case Type::I16:
        return as<std::int16_t>(bytes);
      case Type::U16:
        return as<std::uint16_t>(bytes);
      case Type::I32:
        return as<std::int32_t>(bytes);
      case Type::U32:
        return as<std::uint32_t>(bytes);
      case Type::F32:
        return as<float>(bytes);
      case Type::F64:
        return as<double>(bytes);
      case Type::None:
        break;
    }
    return 0;
  }

  double fail() {
    failed_ = true;
    return 0;
  }

  const char *at_, *end_;
  Encoding encoding_;
  bool failed_ = false;
};

Status damaged(const std::string& what) { return Status::damaged("PLY: " + what); }
Status unsupported(const std::string& what) { return Status::cannotDo("PLY: " + what); }

Status addProperty(std::istringstream& words, Header& header) {
  if (header.elements.empty()) return damaged("a property before any element");
  Property property;
  std::string type;
  words >> type;
  if (type == "list") {
    std::string count_type;
    words >> count_type >> type;
    property.count_type = typeNamed(count_type);
    const bool whole = property.count_type != Type::None && property.count_type < Type::F32;
    if (!whole) return damaged("a list counted by '" + count_type + "'");
  }
  words >> property.name;
  property.type = typeNamed(type);
  if (property.type == Type::None || property.name.empty()) return damaged("a property of unknown type '" + type + "'");
  header.elements.back().properties.push_back(property);
  return {};
}

Status addElement(std::istringstream& words, Header& header) {
  Element element;
  std::string count;
  words >> element.name >> count;
  const bool digits =
      !count.empty() && count.size() <= 18 && count.find_first_not_of("0123456789") == std::string::npos;
  if (!digits) return damaged("element '" + element.name + "' counted by '" + count.substr(0, 40) + "'");
  element.count = std::stoull(count);
  header.elements.push_back(element);
  return {};
}

Status setFormat(std::istringstream& words, Header& header) {
  std::string encoding, version;
  words >> encoding >> version;
  if (version != "1.0") return unsupported("version '" + version.substr(0, 40) + "' instead of 1.0");
  if (encoding == "ascii")
    header.encoding = Encoding::Ascii;
  else if (encoding == "binary_little_endian")
    header.encoding = Encoding::Little;
  else if (encoding == "binary_big_endian")
    header.encoding = Encoding::Big;
  else
    return unsupported("unknown encoding '" + encoding.substr(0, 40) + "'");
  return {};
}

Status addHeaderLine(const std::string& line, Header& header) {
  std::istringstream words(line);
  std::string keyword;
  words >> keyword;
  if (keyword == "format") return setFormat(words, header);
  if (keyword == "element") return addElement(words, header);
  if (keyword == "property") return addProperty(words, header);
  const bool silent = keyword.empty() || keyword == "ply" || keyword == "comment" || keyword == "obj_info";
  return silent ? Status{} : damaged("unknown header line '" + keyword.substr(0, 40) + "'");
}

/// Takes the next line off [at, end); false if none ends there. Lines end by LF, CR LF, or (old Macs) CR.
bool takeLine(const char*& at, const char* end, std::string& line) {
  const char* const stop = std::find_if(at, end, [](char c) { return c == '\n' || c == '\r'; });
  if (stop == end) return false;
  line.assign(at, stop);
  at = stop + 1;
  if (*stop == '\r' && at != end && *at == '\n') ++at;
  return true;
}

Result<Header> readHeader(const MappedFile& file) {
  const bool ply = file.size() >= 4 && std::memcmp(file.begin(), "ply", 3) == 0 &&
                   (file.begin()[3] == '\n' || file.begin()[3] == '\r');
  if (!ply) return damaged("does not begin with 'ply'");
  const char* at = file.begin();
  const char* const end = at + std::min(file.size(), kMaxHeaderBytes);
  Header header;
  std::string line;
  while (takeLine(at, end, line)) {
    if (line.compare(0, 10, "end_header") == 0) {
      header.bytes = static_cast<std::size_t>(at - file.begin());
      return header;
    }
    const Status status = addHeaderLine(line, header);
    if (!status.ok()) return status;
  }
  return damaged("its header does not end within " + std::to_string(end - file.begin()) + " bytes");
}

Status cutInside(const Element& element, std::uint64_t row) {
  return damaged("cut, or no number, in " + element.name + " " + std::to_string(row) + " of " +
                 std::to_string(element.count));
}

void skipRest(Body& body, const Property& property) {
  if (!property.isList()) return body.skip(property.type, 1);
  body.skip(property.type, body.nextCount(property.count_type));
}

Status readVertices(const Element& element, Body& body, Mesh& mesh) {
  const int axes[3] = {element.find("x"), element.find("y"), element.find("z")};
  for (const int axis : axes) {
    if (axis < 0 || element.properties[axis].isList()) return damaged("its vertices have no x, y, z");
  }
  for (std::uint64_t row = 0; row < element.count; ++row) {
    Mesh::Vertex vertex{};
    for (int i = 0; i < static_cast<int>(element.properties.size()); ++i) {
      const int* const axis = std::find(axes, axes + 3, i);
      if (axis == axes + 3)
        skipRest(body, element.properties[i]);
      else
        vertex[axis - axes] = static_cast<float>(body.next(element.properties[i].type));
    }
    if (body.failed()) return cutInside(element, row);
    mesh.vertices.push_back(vertex);
  }
  return {};
}

/// A polygon as a fan of triangles round its first corner.
void readPolygon(const Property& property, Body& body, Mesh& mesh) {
  constexpr std::uint32_t kNoVertex = std::numeric_limits<std::uint32_t>::max();
  const std::uint64_t length = body.nextCount(property.count_type);
  std::uint32_t first = 0, previous = 0;
  for (std::uint64_t i = 0; i < length && !body.failed(); ++i) {
    const double value = body.next(property.type);
    const bool possible = value >= 0 && value < kNoVertex;
    const std::uint32_t corner = possible ? static_cast<std::uint32_t>(value) : kNoVertex;
    if (i == 0) first = corner;
    if (i >= 2) mesh.triangles.push_back({first, previous, corner});
    previous = corner;
  }
}

Status readFaces(const Element& element, Body& body, Mesh& mesh) {
  int corners = element.find("vertex_indices");
  if (corners < 0) corners = element.find("vertex_index");
  if (corners < 0 || !element.properties[corners].isList()) return damaged("its faces have no list vertex_indices");
  for (std::uint64_t row = 0; row < element.count; ++row) {
    for (int i = 0; i < static_cast<int>(element.properties.size()); ++i) {
      if (i == corners)
        readPolygon(element.properties[i], body, mesh);
      else
        skipRest(body, element.properties[i]);
    }
    if (body.failed()) return cutInside(element, row);
  }
  return {};
}

Status skipElement(const Element& element, Body& body) {
  for (std::uint64_t row = 0; row < element.count && !element.properties.empty(); ++row) {
    for (const Property& property : element.properties) skipRest(body, property);
    if (body.failed()) return cutInside(element, row);
  }
  return {};
}

Status readElement(const Element& element, Encoding encoding, Body& body, Mesh& mesh) {
  const std::uint64_t row_bytes = element.leastRowBytes(encoding);
  // The last value of an ascii file may lack its white space.
  const std::uint64_t left = body.left() + (encoding == Encoding::Ascii ? 1 : 0);
  if (row_bytes > 0 && element.count > left / row_bytes) {
    return damaged("its header promises " + std::to_string(element.count) + " of " + element.name + ", " +
                   std::to_string(body.left()) + " bytes are left");
  }
  if (element.name == "vertex") return readVertices(element, body, mesh);
  if (element.name == "face") return readFaces(element, body, mesh);
  if (element.name == "tristrips" && element.count > 0) return unsupported("triangle strips");
  return skipElement(element, body);
}

Status checkCorners(const Mesh& mesh) {
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const std::uint32_t corner : mesh.triangles[i]) {
      if (corner < mesh.vertices.size()) continue;
      return damaged("triangle " + std::to_string(i) + " refers to vertex " + std::to_string(corner) + " of " +
                     std::to_string(mesh.vertices.size()));
    }
  }
  return {};
}

}  // namespace

Result<Mesh> readPly(const std::string& path) {
  const MappedFile file(path);
  if (file.error() != 0) return Status::cannotDo(path + ": " + std::strerror(file.error()));
  const Result<Header> header = readHeader(file);
  if (!header.ok()) return header.status;

  Body body(file.begin() + header.value.bytes, file.end(), header.value.encoding);
  Mesh mesh;
  for (const Element& element : header.value.elements) {
    const Status status = readElement(element, header.value.encoding, body, mesh);
    if (!status.ok()) return status;
  }
  const Status status = checkCorners(mesh);
  if (!status.ok()) return status;
  return mesh;
}

}  // namespace voxid
