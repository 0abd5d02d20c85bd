// SPDX-License-Identifier: BSD-3-Clause
// The layout of a .vxi file, byte by byte; doc/index_format.md explains it. Little-endian, fixed widths, every section
// starts at a multiple of 64 bytes, all padding is zero.
#pragma once

#include <cstdint>

namespace voxid::format {

constexpr char kMagic[8] = {'V', 'O', 'X', 'I', 'D', 'X', '\r', '\n'};  ///< a copy in text mode breaks it
constexpr std::uint16_t kMajor = 1;                                     ///< a reader refuses any other
constexpr std::uint16_t kMinor = 1;                                     ///< of "default"; "paper" has 0
constexpr std::uint16_t kMinorSenses = 2;                               ///< of files with SYNS, at least
constexpr std::uint16_t kMinorConfidence = 2;                           ///< of files with CONF, at least
constexpr std::uint16_t kMinorHypernyms = 3;                            ///< of files with HYPR, at least
constexpr std::uint16_t kMinorSurfaces = 5;                             ///< of files with SURO and SURF, at least
constexpr std::uint64_t kAlignment = 64;
constexpr std::uint32_t kMaxSections = 64;

struct Header {
  char magic[8];
  std::uint16_t major, minor;
  std::uint32_t header_bytes;  ///< sizeof(Header); the section table follows
  std::uint64_t file_bytes;    ///< must equal the file's length
  std::uint32_t sections, categories, models, views, buckets;
  std::uint32_t descriptor_crc32c;  ///< of the PARM section: the settings a query must be made with
  std::uint32_t crc32c;             ///< of header (this field zero) and section table
  std::uint8_t zero[12];
};
static_assert(sizeof(Header) == 64, "header is 64 bytes");

struct Section {
  char tag[4];
  std::uint32_t crc32c;  ///< of its `length` bytes; checked by verify
  std::uint64_t offset, length;
  std::uint8_t zero[8];
};
static_assert(sizeof(Section) == 32, "section entry is 32 bytes");

/// PARM, once: the descriptor's settings.
struct Parameters {
  char profile[16];                 ///< "paper" or "default", NUL-padded
  std::uint32_t revision;           ///< of the descriptor's bytes; a change of any output byte raises it
  std::uint32_t pairs, seed;        ///< DescriptorParams
  std::uint32_t code_bytes;         ///< bytes a view in CODE
  std::uint32_t projection_crc32c;  ///< of PROJ; zero in "paper"
  std::uint8_t zero[28];
};
static_assert(sizeof(Parameters) == 64, "PARM is 64 bytes");

/// CATS, sorted by name (bytewise). Strings are offsets into STRS (NUL-terminated UTF-8; offset 0 is the empty string).
struct Category {
  std::uint32_t name;
  std::uint32_t synset;  ///< WordNet 3.0 noun offset; 0 = not known
  std::uint32_t first_model, models;
};
static_assert(sizeof(Category) == 16, "CATS entry is 16 bytes");

/// MODL, sorted by category, then name.
struct Model {
  std::uint32_t category, name, licence, origin;
  std::uint32_t first_view, views;
  std::uint8_t zero[8];
};
static_assert(sizeof(Model) == 32, "MODL entry is 32 bytes");

/// DIRS: the view directions that VIEW refers to, in the model's frame, unit vectors x 32,767.
struct Direction {
  std::int16_t to_camera[3];  ///< from the model's centre towards the camera
  std::int16_t up[3];         ///< the image's up before the roll
  std::uint8_t zero[4];
};
static_assert(sizeof(Direction) == 16, "DIRS entry is 16 bytes");

/// VIEW, sorted by model, then direction. In "paper".
struct View {
  std::uint32_t model;
  std::uint16_t extents[3];  ///< of the visible points along the camera's x, y, z, in 1/65,535 of the model's diagonal
  std::uint8_t direction;    ///< index into DIRS
  std::uint8_t zero;
  std::uint32_t points;  ///< visible pixels
};
static_assert(sizeof(View) == 16, "VIEW entry is 16 bytes");

/// VIE4, in "default": the same order, and short; the model follows from MODL.
struct ShortView {
  std::uint8_t direction;
  std::uint8_t extents[3];  ///< as in View, in 1/255
};
static_assert(sizeof(ShortView) == 4, "VIE4 entry is 4 bytes");

/// PROJ, once, in "default": a projection file as it is. After this header: matrix (int8, a row of `bins` for each of
/// the `numbers`), bias and factor (int32 each, one a number), centroids (`lists` rows of int8, one a number), a
/// Calibration.
struct Projection {
  char magic[8];
  std::uint32_t version;        ///< kProjectionVersion; a reader refuses any other
  std::uint32_t revision;       ///< of the depth descriptor
  std::uint32_t pairs, seed;    ///< of the depth descriptor
  std::uint32_t bins, numbers;  ///< from, to: 2,132 and 96; a reader refuses others
  std::uint32_t lists;
  std::uint32_t views, models, categories;  ///< that it was learnt from
  std::uint32_t crc32c;                     ///< of the whole, this field zero
  std::uint8_t zero[12];
};
static_assert(sizeof(Projection) == 64, "a projection's header is 64 bytes");
constexpr char kProjectionMagic[8] = {'V', 'O', 'X', 'I', 'D', 'P', '\r', '\n'};
constexpr std::uint32_t kProjectionVersion = 1;

/// CODE: code_bytes a view, in the order of the views.
/// MEAN, in "default": 96 signed bytes a category, the mean of its codes' numbers, rounded to nearest, halves away from
/// 0. KEYS: the distinct 52-bit keys ("default": numbers of lists), ascending, 8 bytes each. BKTO: buckets + 1 offsets
/// into BKTV, 4 bytes each. BKTV: view numbers by bucket, ascending inside a bucket, 4 bytes each.

/// CALB, once: the share of right labels by margin, measured with the query's own model left out.
struct Calibration {
  static constexpr int kBins = 32;
  std::uint32_t samples;                ///< queries behind the curve; 0 = the built-in curve was copied
  std::uint16_t score_permille[kBins];  ///< non-decreasing; bin = min(31, 32 x (d2 - d1) / d2), d1 the nearest
                                        ///< category's distance, d2 the next category's
  std::uint8_t zero[60];
};
static_assert(sizeof(Calibration) == 128, "CALB is 128 bytes");

/// SYNS, once, or not at all (no category has a sense, or made before format 1.2): 4 bytes a category, in the order of
/// CATS: offset into STRS of the synset's name as NLTK writes it ("mug.n.04"), 0 = not known.

/// HYPR, once, or not at all (no category has hypernyms, or made before format 1.3): 4 bytes a category, in the order
/// of CATS: offset into STRS of the synset's path from WordNet's root, the synset itself last, joined by slashes
/// ("entity.n.01/.../container.n.01/vessel.n.03/drinking_vessel.n.01/mug.n.04"), 0 = not known.

/// CONF, once, or not at all (an index of few models, or made before format 1.2): how likely an answer is right, as a
/// logistic function of voxid::ConfidenceFeatures, learnt from views of the index's own models, each asked for with its
/// own model left out. It takes the place of CALB.
struct Confidence {
  static constexpr int kFeatures = 9;
  static constexpr std::int32_t kUnit = 1 << 20;
  std::uint32_t samples;                  ///< views asked for, at least one
  std::uint32_t right;                    ///< of those that were named rightly by vote: the accuracy to expect
  std::int32_t bias, weights[kFeatures];  ///< log odds in 1/kUnit: bias + sum of weight x feature
  std::uint8_t zero[16];
};
static_assert(sizeof(Confidence) == 64, "CONF is 64 bytes");

/// SUMS, once, or not at all (small, of "default", or made before format 1.4): voxid/core/sketch.h.

/// SURO and SURF, both once, or not at all (made without --keep-points, or before format 1.5): the models' surfaces.
/// SURO: models + 1 offsets into SURF, 8 bytes each; a model whose offset is that of the next has none. SURF: a surface
/// after another: a Surface, `vertices` x 3 int16 (a coordinate in 1/65,534 of the box's diagonal, from the box's
/// centre), `triangles` x 3 uint16 (numbers of vertices).
struct Surface {
  std::uint32_t vertices, triangles;  ///< at most kMaxSurfaceVertices vertices
  std::uint8_t folds[3];              ///< of voxid::Symmetry
  std::uint8_t zero[1];
};
static_assert(sizeof(Surface) == 12, "a surface's header is 12 bytes");
constexpr std::uint32_t kMaxSurfaceVertices = 65536;
constexpr float kSurfaceUnits = 65534;  ///< in the diagonal of the model's box

}  // namespace voxid::format
