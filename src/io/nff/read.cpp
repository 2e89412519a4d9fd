#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <new>

#include "base/executor.h"
#include "io/nff/nff.h"
#include "io/nff/parser.h"

namespace raio::core {
namespace nff {
namespace {

/// Larger numbers round to infinity as a float.
constexpr double kBeyondFloat = 0x1.ffffffp127;

}  // namespace

Parser::Parser(const TextBuffer& text, std::string_view file, TextReport& report)
    : text_(text), report_(report), p_(text.begin()), begin_(text.begin()) {
  if (text_.view().starts_with("\xef\xbb\xbf")) p_ += 3;  // the byte order mark of UTF-8
  scene_.name = std::filesystem::path(file).stem().string();
}

Scene Parser::run() {
  // Pieces rely on two facts that must be known before them: the origin, which may change up to the
  // first object, and the existence of a material.
  const char* cut = p_;
  do walk(cut = next_cut(cut));
  while (cut < text_.end() && !(seen.object && material_));
  read_pieces(cut);
  finish();
  return std::move(scene_);
}

/// Reads the entities up to `end`, a cut or the end of the text.
void Parser::walk(const char* end) {
  StopCheck look;
  while ((p_ = skip_blanks(p_)) < end) entity(), look();
}

/// Reads the entity at `p_` and returns its row; null for an unknown keyword.
const Entity* Parser::entity() {
  begin_ = p_;
  const std::string_view word = word_at(p_);
  const Entity* const entity = find_entity(word);
  if (!entity) {
    unknown(word);
    return nullptr;
  }
  p_ += word.size();
  entity_ = entity;
  entity->read(*this);
  return entity;
}

void Parser::unknown(std::string_view word) {
  p_ += word.size();
  const size_t numbers = numbers_left_in_line();
  p_ = begin_;
  if (const RefusedWord* refused = find_refused(word, numbers)) return refuse(*refused, false);
  std::string message;
  if (looks_like_number(word)) {
    message = fmt::format("expected a keyword, found {}", quoted(word));
    if (entity_) message += fmt::format(": {}", entity_->usage);
    if (entity_ && entity_->surplus.numbers == numbers_left_in_line())
      message += fmt::format("; {}", entity_->surplus.advice);
  } else if (find_camera_word(word) != CameraWord::none) {
    message = fmt::format("{} belongs to the camera: expected a line \"v\" before", quoted(word));
    seen.camera_lost = true;
  } else if (const std::string_view nearest = nearest_word(word, false); !nearest.empty()) {
    message = fmt::format("unknown keyword {}; did you mean \"{}\"?", quoted(word), nearest);
    seen.camera_lost |= nearest == kCameraKeyword;
  } else {
    message = fmt::format("unknown keyword {}, expected one of: {}", quoted(word), keyword_list());
  }
  report_.error(offset(begin_), std::move(message));
  p_ += word.size();
  skip_to_entity(false);
}

void Parser::refuse(const RefusedWord& word, bool in_camera) {
  const std::string_view found = word_at(p_);
  if (refused_.insert(word.what).second)
    report_.error(offset(p_), fmt::format("{} is {}", quoted(found), word.what));
  p_ += found.size();
  skip_to_entity(in_camera);
}

void Parser::skip_to_entity(bool in_camera) {
  // A misspelt keyword begins an entity, too; a number does not.
  const auto begins = [&](std::string_view word) {
    if (looks_like_number(word)) return false;
    if (find_camera_word(word) != CameraWord::none) return in_camera;
    return find_entity(word) || find_refused(word) || !nearest_word(word, false).empty();
  };
  for (;;) {
    p_ = skip_blanks(p_);
    if (*p_ == '\0') return;
    const char* before = p_;
    while (before > text_.begin() && is_char(before[-1], kBlank) && !is_char(before[-1], kLineEnd))
      --before;
    const bool first_in_line = before == text_.begin() || is_char(before[-1], kLineEnd);
    const std::string_view word = word_at(p_);
    if (first_in_line && begins(word)) return;
    seen.camera_lost |= word == kCameraKeyword;
    p_ += word.size();
  }
}

void Parser::finish() {
  if (!seen.camera && !seen.camera_lost)
    report_.error("there is no camera: expected v with from, at, up and angle");
  if (!seen.object) report_.warning("there is no object in the file");
  size_t count = 0;
  for_each_pool([&](auto pool) { count += (scene_.*pool.shapes).size(); });
  if (count > kMaxPrimitives ||
      std::max(scene_.positions.size(), scene_.normals.size()) >= kNoNormal)
    report_.error(
        fmt::format("the scene has too many objects or vertices, expected at most {} primitives",
                    kMaxPrimitives));
  if (scene_.materials.empty()) scene_.materials.emplace_back();
  // P3F's aperture is a diameter (camera.cpp).
  if (scene_.dialect == Dialect::p3f && scene_.camera.lens_radius) *scene_.camera.lens_radius /= 2;
}

bool Parser::numbers(std::span<double> out, Names names, Item item) {
  for (size_t i = 0; i < out.size(); ++i) {
    p_ = skip_blanks(p_);
    const char* const end = parse_number(p_, out[i]);
    if (!end || !(std::abs(out[i]) < kBeyondFloat)) [[unlikely]] {
      bad_number(names[i], item);
      return false;
    }
    p_ = end;
  }
  return true;
}

void Parser::bad_number(std::string_view name, Item item) {
  std::string expected(name);
  if (item.number > 0) expected += fmt::format(" of {} {}", item.noun, item.number);
  if (*p_ == '\0') {
    const char* end = p_;
    while (end > begin_ && is_char(end[-1], kBlank)) --end;
    report_.error(offset(end),
                  fmt::format("the file ends inside {} begun at line {}, expected {}",
                              entity_->noun, report_.line_of(offset(begin_)), expected));
    return;
  }
  const std::string_view word = word_at(p_);
  report_.error(offset(p_), fmt::format("expected a number for {} of {}, found {}{}", expected,
                                        entity_->noun, quoted(word), number_fault(word)));
  skip_to_entity(in_camera());
}

std::string Parser::number_fault(std::string_view word) const {
  const bool letter = !word.empty() && (word[0] | 32) >= 'a' && (word[0] | 32) <= 'z';
  if (letter && !entity_->if_word.empty() && word.size() > 2 && !find_entity(word))
    return fmt::format(": {}", entity_->if_word);
  const std::string_view unsigned_word =
      word.substr(word.starts_with('-') || word.starts_with('+'));
  for (const std::string_view name : {"nan", "inf", "NaN", "NAN", "Inf", "INF", "infinity"})
    if (unsigned_word == name) return ", which is not finite";
  if (!looks_like_number(word)) return "";
  double value;
  if (parse_number(word.data(), value)) return ", which is too large for a float (3.4e38)";
  const std::string_view mantissa = word.substr(0, word.find_first_of("eE"));
  if (std::count(mantissa.begin(), mantissa.end(), '.') > 1)
    return ", which has two decimal points";
  if (word.find(',') != std::string_view::npos) return ", which contains a comma";
  return ", which has text after the number";
}

const char* Parser::last_word() const {
  const char* word = p_;
  while (word > begin_ && !is_char(word[-1], kWordEnd)) --word;
  return word;
}

std::optional<int64_t> Parser::whole_number(std::string_view name, int64_t least, int64_t most) {
  double value;
  const std::string_view names[] = {name};
  if (!numbers({&value, 1}, names)) return std::nullopt;
  if (value == std::floor(value) && value >= double(least) && value <= double(most))
    return int64_t(value);
  const char* const word = last_word();
  report_.error(offset(word),
                fmt::format("expected {} of {} as a whole number from {} to {}, found {}", name,
                            entity_->noun, least, most, quoted(word_at(word))));
  skip_to_entity(in_camera());
  return std::nullopt;
}

std::optional<size_t> Parser::count(std::string_view name, size_t least, size_t least_bytes_each) {
  const auto n = whole_number(name, int64_t(least), 4'294'967'295);
  if (!n) return std::nullopt;
  const size_t left = size_t(text_.end() - p_);
  if (uint64_t(*n) * least_bytes_each <= left) return size_t(*n);
  const char* const word = last_word();
  report_.error(offset(word),
                fmt::format("{} of {} is {}, too large for the {} bytes left in the file", name,
                            entity_->noun, *n, left));
  skip_to_entity(false);
  return std::nullopt;
}

size_t Parser::numbers_left_in_line() const {
  size_t count = 0;
  const char* p = skip_blanks_in_line(p_);
  while (looks_like_number(word_at(p))) {
    ++count;
    p = skip_blanks_in_line(p + word_at(p).size());
  }
  return count;
}

std::string_view Parser::rest_of_line() {
  p_ = skip_blanks_in_line(p_);
  const char *end = p_, *rest = p_;
  for (; *rest != '\0' && *rest != '#' && !is_char(*rest, kLineEnd); ++rest)
    if (!is_char(*rest, kBlank)) end = rest + 1;
  const std::string_view found(p_, size_t(end - p_));
  p_ = rest;
  return found;
}

void Parser::warn_once(bool& warned, std::string message) {
  if (!warned) warn(std::move(message));
  warned = true;
}

MaterialId Parser::default_material() {
  warn_once(seen.no_material, "an object before any f: it gets a grey material");
  set_material({});
  return *material_;
}

MaterialId Parser::material_id(const Surface& surface) {
  const auto [entry, added] =
      material_ids_.try_emplace(surface, MaterialId(scene_.materials.size()));
  if (added) scene_.add_material(surface.material, surface.specular, surface.roughness);
  return entry->second;
}

size_t Parser::SurfaceHash::operator()(const Surface& s) const {
  const Material& m = s.material;
  uint64_t hash = 0;
  for (const float x : {m.color.x, m.color.y, m.color.z, m.kd, m.ks, m.shine, m.transmission, m.ior,
                        s.specular.x, s.specular.y, s.specular.z, s.roughness})
    // Adding zero turns -0 into 0, which compares equal.
    hash = (std::rotl(hash, 23) ^ std::bit_cast<uint32_t>(x + 0.0f)) * 0x9e3779b97f4a7c15u;
  return size_t(hash ^ hash >> 32);
}

}  // namespace nff

namespace {

Diagnostics about_file(std::string_view file, std::string message) {
  return {{Severity::error, std::string(file), 0, 0, std::move(message), ""}};
}

std::expected<ReadScene, Diagnostics> parse(const TextBuffer& text, std::string_view file) {
  if (text.view().empty()) return std::unexpected(about_file(file, "the file is empty"));
  if (std::string fault = not_text(text.view()); !fault.empty())
    return std::unexpected(about_file(file, std::move(fault)));
  TextReport report(text.view(), file, kMaxDiagnostics);
  Scene scene = nff::Parser(text, file, report).run();
  if (report.failed()) return std::unexpected(report.errors());
  return ReadScene{std::move(scene), report.warnings()};
}

template <class Text>
std::expected<ReadScene, Diagnostics> in_memory(std::string_view file, Text&& make_text) try {
  return make_text();
} catch (const std::bad_alloc&) {
  return std::unexpected(about_file(file, std::string(kNoMemory)));
}

}  // namespace

std::expected<ReadScene, Diagnostics> parse_nff(std::string_view text, std::string_view file) {
  return in_memory(file, [&] { return parse(TextBuffer(text), file); });
}

std::expected<ReadScene, Diagnostics> parse_nff(const TextBuffer& text, std::string_view file) {
  return in_memory(file, [&] { return parse(text, file); });
}

std::expected<ReadScene, Diagnostics> read_nff(const std::filesystem::path& path) {
  const std::string file = path.string();
  return in_memory(file, [&]() -> std::expected<ReadScene, Diagnostics> {
    const auto text = TextBuffer::read_file(path);
    if (!text) return std::unexpected(about_file(file, text.error()));
    return parse(*text, file);
  });
}

}  // namespace raio::core
