#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <new>
#include <set>

#include "base/platform/files.h"
#include "io/nff/text_cursor.h"
#include "io/raio/format.h"
#include "io/raio/raio.h"

namespace raio::core {
namespace {

using namespace scene_file;

using Checked = std::expected<void, std::string>;

constexpr std::string_view kBroken = "broken .raio scene: ";

template <class... Args>
std::unexpected<std::string> broken(fmt::format_string<Args...> format, Args&&... args) {
  return std::unexpected(std::string(kBroken) + fmt::format(format, std::forward<Args>(args)...));
}

constexpr std::string_view kNewer = "a newer Raio can read it, and write it as NFF";

/// A valid header and table: every column is in the file, after the previous one.
class Table {
 public:
  Checked check(std::string_view file);

  size_t size() const { return entries_.size(); }
  const Entry& operator[](size_t i) const { return entries_[i]; }
  std::string_view name(size_t i) const { return entries_[i].name; }
  std::string_view bytes(size_t i) const {
    const Entry& e = entries_[i];
    return file_.substr(e.offset, e.count * e.numbers * bytes_of(e.number));
  }
  /// Its name for messages.
  std::string column(size_t i) const {
    if (name(i) == kPrototype) return fmt::format("prototype {}", entries_[i].mesh);
    const std::string text = "column " + quoted(name(i));
    return entries_[i].mesh == kNoMesh ? text : text + fmt::format(" of mesh {}", entries_[i].mesh);
  }
  uint32_t minor() const { return header_.minor; }

 private:
  Checked check_header();
  Checked check_entry(size_t i, size_t end);

  std::string_view file_;
  Header header_;
  std::vector<Entry> entries_;
};

Checked Table::check(std::string_view file) {
  file_ = file;
  if (auto sound = check_header(); !sound) return sound;
  const std::string_view table = file.substr(sizeof(Header), header_.columns * sizeof(Entry));
  if (table_hash(header_, table) != header_.hash)
    return broken("the checksum of its table is wrong");
  entries_.resize(header_.columns);
  if (!entries_.empty()) std::memcpy(entries_.data(), table.data(), table.size());
  size_t end = sizeof(Header) + table.size();
  for (size_t i = 0; i < entries_.size(); ++i) {
    if (auto sound = check_entry(i, end); !sound) return sound;
    end = entries_[i].offset + bytes(i).size();
  }
  if (end != file.size()) return broken("it does not end with its last column");
  return {};
}

Checked Table::check_header() {
  if (!is_raio_scene(file_)) return std::unexpected("not a .raio scene");
  if (file_.size() < sizeof(Header)) return broken("it ends early");
  std::memcpy(&header_, file_.data(), sizeof(Header));
  if (header_.byte_order != kByteOrder) return broken("its byte order differs, or it is damaged");
  if (header_.major != kMajor)
    return std::unexpected(fmt::format("a .raio scene of format {}, expected format {}; {}",
                                       header_.major, kMajor, kNewer));
  if (header_.file_size != file_.size())
    return broken("it has {} bytes, expected {}", file_.size(), header_.file_size);
  if (header_.columns > (file_.size() - sizeof(Header)) / sizeof(Entry))
    return broken("it ends within its table of {} columns", header_.columns);
  if (std::ranges::any_of(header_.zeros, [](char c) { return c != 0; }))
    return broken("its header is followed by nonzero padding");
  return {};
}

// `end`: of the previous column.
Checked Table::check_entry(size_t i, size_t end) {
  const Entry& e = entries_[i];
  const char* const name_end = std::ranges::find(e.name, '\0');
  if (name_end == std::end(e.name) ||
      std::any_of(name_end, std::end(e.name), [](char c) { return c != 0; }))
    return broken("entry {} of its table has no name", i);
  const size_t element = bytes_of(e.number) * e.numbers;
  if (element == 0 || e.numbers > 64 || e.zero != 0)
    return broken("{} has elements of {} numbers of type {}", column(i), e.numbers,
                  uint32_t(e.number));
  if (e.offset != aligned(end) || e.offset > file_.size() ||
      e.count > (file_.size() - e.offset) / element || e.count == 0)
    return broken(
        "{} has {} elements at byte {}, which overlaps the previous column or exceeds the file",
        column(i), e.count, e.offset);
  const std::string_view gap = file_.substr(end, e.offset - end);
  if (gap.find_first_not_of('\0') != std::string_view::npos)
    return broken("the padding before {} is not zero", column(i));
  return {};
}

std::set<std::string_view> known_names() {
  std::set<std::string_view> names;
  Settings settings;
  Scene scene;
  scene.meshes.resize(1), settings.prototypes.resize(1);
  for_each_file_column(std::as_const(settings), std::as_const(scene),
                       [&](std::string_view name, uint32_t, const auto&) { names.insert(name); });
  return names;
}

/// Assigns the columns of the table to those of `settings` and `scene`, in the same order.
class SectionReader {
 public:
  SectionReader(const Table& table, const std::shared_ptr<const void>& keep)
      : table_(table), keep_(keep) {}

  template <class Elements>
  void operator()(std::string_view name, uint32_t mesh, Elements& array) {
    using T = Elements::value_type;
    if (at_ == table_.size() || table_[at_].mesh != mesh || table_.name(at_) != name) return;
    const Entry& e = table_[at_];
    if (e.number == Element<T>::number && e.numbers == Element<T>::numbers) {
      array = Array<T>::borrow(table_.bytes(at_).data(), e.count, keep_);
    } else if (wrong_.empty()) {
      wrong_ = fmt::format("{} has elements of {} numbers of type {}, expected {} of type {}",
                           table_.column(at_), e.numbers, uint32_t(e.number), Element<T>::numbers,
                           uint32_t(Element<T>::number));
    }
    ++at_;
  }

  Checked done() const {
    if (!wrong_.empty()) return broken("{}", wrong_);
    if (at_ == table_.size()) return {};
    if (known_names().contains(table_.name(at_)))
      return broken("{} is out of order", table_.column(at_));
    return std::unexpected(fmt::format(
        "a .raio scene of format {}.{} with a {}, which is unknown to this Raio; it reads format "
        "{}.{}; {}",
        kMajor, table_.minor(), table_.column(at_), kMajor, kMinor, kNewer));
  }

 private:
  const Table& table_;
  const std::shared_ptr<const void>& keep_;
  size_t at_ = 0;
  std::string wrong_;
};

// The number of meshes, or prototypes, with columns in the table. Each has at least one column, so
// their number does not exceed that of the columns.
std::expected<size_t, std::string> count_of(const Table& table, bool prototypes) {
  size_t count = 0;
  for (size_t i = 0; i < table.size(); ++i)
    if (table[i].mesh != kNoMesh && (table.name(i) == kPrototype) == prototypes)
      count = std::max(count, size_t(table[i].mesh) + 1);
  if (count > table.size())
    return broken("{} {} of {} columns", prototypes ? "prototype" : "mesh", count - 1,
                  table.size());
  return count;
}

// Whether the scene of a prototype has only geometry and the materials of the scene around it.
bool is_prototype_of(const Scene& around, const Scene& decoded) {
  const auto columns = [](const Scene& scene) {
    std::vector<std::string> out;
    const auto add = [&](ColumnName, const auto& array) {
      const auto elements = packed(array);
      out.emplace_back(reinterpret_cast<const char*>(elements.data()), elements.bytes());
    };
    const Settings settings = settings_of(scene);
    for_each_settings_column(settings, add);
    Scene without = scene;
    static_cast<Object&>(without) = {};
    for_each_own_column(std::as_const(without), add);
    return out;
  };
  return columns(decoded) == columns(standalone(around, decoded));
}

// A scene with numbers yet to be validated; `depth`: the number of enclosing prototypes.
std::expected<Scene, std::string> decode(std::string_view bytes,
                                         const std::shared_ptr<const void>& keep, int depth) {
  Table table;
  if (auto sound = table.check(bytes); !sound) return std::unexpected(sound.error());
  for (size_t i = 0; i < table.size(); ++i)
    if (column_hash(table.bytes(i)) != table[i].hash)
      return broken("the checksum of {} is wrong", table.column(i));

  Scene scene;
  Settings settings;
  const auto meshes = count_of(table, false), prototypes = count_of(table, true);
  if (!meshes || !prototypes) return std::unexpected((meshes ? prototypes : meshes).error());
  if (*prototypes > 0 && depth == kMaxNested)
    return broken("prototypes are nested more than {} deep", kMaxNested);
  scene.meshes.resize(*meshes), settings.prototypes.resize(*prototypes);
  SectionReader take(table, keep);
  for_each_file_column(settings, scene, take);
  if (auto done = take.done(); !done) return std::unexpected(done.error());
  if (const std::string wrong = apply(settings, scene); !wrong.empty()) return broken("{}", wrong);
  for (size_t i = 0; i < settings.prototypes.size(); ++i) {
    const auto& object = std::as_const(settings.prototypes[i]);
    auto decoded = decode({object.data(), object.size()}, keep, depth + 1);
    if (!decoded) {
      std::string_view why = decoded.error();
      if (why.starts_with(kBroken)) why.remove_prefix(kBroken.size());
      return broken("prototype {}: {}", i, why);
    }
    if (!is_prototype_of(scene, *decoded))
      return broken(
          "prototype {}: it has more than an object's geometry with the scene's materials", i);
    scene.prototypes.push_back(std::move(*decoded));
  }
  return scene;
}

}  // namespace

bool is_raio_scene(std::string_view start) { return start.starts_with(kMagic); }

std::expected<Scene, std::string> decode_raio_scene(std::string_view bytes,
                                                    const std::shared_ptr<const void>& keep) {
  if (!keep) {
    const auto begin = reinterpret_cast<const std::byte*>(bytes.data());
    const auto copy = std::make_shared<const Column<std::byte>>(begin, begin + bytes.size());
    return decode_raio_scene({reinterpret_cast<const char*>(copy->data()), copy->size()}, copy);
  }
  auto scene = decode(bytes, keep, 0);
  if (!scene) return scene;
  if (const auto problems = validate(*scene); !problems.empty())
    return broken("{}", problems.front());
  return scene;
}

std::expected<Scene, Diagnostics> read_raio_scene(const std::filesystem::path& path) {
  const auto failed = [&](std::string message) {
    return std::unexpected(
        Diagnostics{{Severity::error, path.string(), 0, 0, std::move(message), ""}});
  };
  try {
    auto bytes = read_bytes(path);
    if (!bytes) return failed("cannot read the file: " + bytes.error());
    const auto file = std::make_shared<const Column<std::byte>>(std::move(*bytes));
    auto scene =
        decode_raio_scene({reinterpret_cast<const char*>(file->data()), file->size()}, file);
    if (!scene) return failed(scene.error());
    scene->name = path.stem().string();
    return std::move(*scene);
  } catch (const std::bad_alloc&) {
    return failed(std::string(kNoMemory));
  }
}

}  // namespace raio::core
