#include "io/scene_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <memory>
#include <new>
#include <system_error>

#include "base/executor.h"
#include "base/memory.h"
#include "base/platform/files.h"
#include "io/atoms/read.h"
#include "io/cube_map.h"
#include "io/environment.h"
#include "io/mesh/read.h"
#include "io/mesh/smooth.h"
#include "io/mesh/write.h"
#include "io/nff/text_cursor.h"
#include "io/plain_scene.h"
#include "io/pov_write.h"
#include "io/raio/raio.h"

namespace raio::core {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kReads =
    "Raio reads NFF, P3F, .raio, PDB, CIF, GRO, XYZ, LAMMPS, PLY, STL, OBJ, OFF and glTF";
constexpr std::string_view kGzip = "\x1f\x8b", kByteOrderMark = "\xef\xbb\xbf";

/// Whether the path leads to a regular file that starts like a .raio scene. Does not read pipes and
/// standard input, since that consumes them.
bool leads_to_raio(const fs::path& path) {
  std::error_code error;
  if (path == "/dev/stdin" || !fs::is_regular_file(path, error)) return false;
  auto file = InputFile::open(path);
  char start[8];
  if (!file) return false;
  const auto count = file->read(start, sizeof start);
  return count && is_raio_scene({start, *count});
}

/// Decompresses all members of a gzip file; the error describes the damage.
std::expected<std::string, std::string> unpacked(std::string_view bytes) {
  z_stream stream{};
  constexpr int kGzipOnly = 15 + 16;
  if (inflateInit2(&stream, kGzipOnly) != Z_OK) return std::unexpected(std::string(kNoMemory));
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&stream, inflateEnd);
  const size_t most = available_memory_bytes() / 2;
  constexpr size_t kPiece = size_t(1) << 22;  // between checks for a stop
  std::string out(std::max<size_t>(4096, 4 * bytes.size()), '\0');
  size_t size = 0;
  for (;;) {
    check_stop();
    if (size == out.size()) out.resize(2 * out.size());
    const size_t room = std::min(out.size() - size, kPiece), left = std::min(bytes.size(), kPiece);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = uInt(left);
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + size);
    stream.avail_out = uInt(room);
    const int done = inflate(&stream, Z_NO_FLUSH);
    bytes.remove_prefix(left - stream.avail_in);
    size += room - stream.avail_out;
    if (size > most) return std::unexpected(std::string(kNoMemory));
    if (done == Z_STREAM_END) {
      if (bytes.empty()) break;
      if (inflateReset(&stream) != Z_OK) return std::unexpected("broken gzip file");
    } else if (done == Z_BUF_ERROR && bytes.empty()) {
      return std::unexpected("broken gzip file: it ends early");
    } else if (done != Z_OK && done != Z_BUF_ERROR) {
      return std::unexpected(
          fmt::format("broken gzip file: {}", stream.msg ? stream.msg : "damaged"));
    }
  }
  out.resize(size);
  return out;
}

/// `name`: of the file without compression.
std::string suffix_of(std::string_view name) { return lower_suffix(fs::path(name)); }

std::expected<ReadScene, Diagnostics> parse_raio(std::string_view bytes, std::string_view file,
                                                 const std::shared_ptr<const void>& keep) {
  auto scene = decode_raio_scene(bytes, keep);
  if (!scene) return failed(file, scene.error());
  return ReadScene{std::move(*scene), {}};
}

/// Reads the sky named by the scene, if any. Without it the scene can still be viewed, converted or
/// rendered on another background.
void add_sky(ReadScene& read, const fs::path& path, std::string_view file) {
  Scene& scene = read.scene;
  if (scene.requests.sky_folder.empty()) return;
  const auto warn = [&](const std::string& message) {
    read.notices.push_back({Severity::left_out, std::string(file), 0, 0,
                            message + "; the background is that of the scene (bclr)", ""});
  };
  const fs::path folder = find_sky(scene.requests.sky_folder, path);
  if (folder.empty())
    return warn(fmt::format("its sky: found no folder {} next to the file or in a parent folder",
                            scene.requests.sky_folder));
  auto sky = read_cube_map(folder, scene.requests.sky_folder);
  if (!sky) return warn("its sky: " + sky.error().text());
  scene.sky = std::move(*sky);
}

/// The first given option that has no effect on this file; empty: none.
std::string_view unfit_option(const ReadOptions& options, const FileKind& kind) {
  const ReadOptions usual;
  const bool points = kind.takes != FileKind::Takes::nothing;
  if (!points && options.radius != usual.radius) return "radius";
  if (!points && !options.color_by.empty()) return "color-by";
  if (!points && !options.colormap.empty()) return "colormap";
  if (!points && options.color_range) return "color-range";
  if (!kind.is_mesh && options.smooth) return "smooth";
  if (!options.atom_style.empty() && kind.read != read_lammps_data) return "atom-style";
  if (kind.takes == FileKind::Takes::all) return {};
  if (options.style) return "style";
  if (!options.only.empty()) return "only";
  if (!options.hide.empty()) return "hide";
  if (!options.show.empty()) return "show";
  if (!options.color_atoms.empty()) return "color-atoms";
  if (options.assembly) return "assembly";
  if (options.cell.value_or(false)) return "cell";
  if (options.images != usual.images) return "images";
  return options.frame != usual.frame ? "frame" : "";
}

std::unexpected<Diagnostics> unfit(std::string_view file, std::string_view option) {
  return failed(file, fmt::format("`{}` has no effect on this file; leave it out", option));
}

/// Converts instances to primitives, unless they are kept. Returns the error, or nothing.
std::string apply_instances(const ReadOptions& options, Scene& scene) {
  if (options.instances) return {};
  const bool any = !scene.instances.empty();
  if (std::string wrong = flatten_instances(scene); !wrong.empty() || !any) return wrong;
  // Transformed primitives may exceed the range of numbers.
  const auto problems = validate(scene);
  return problems.empty() ? "" : "its instances as primitives: " + problems.front();
}

/// What all files need once they are read: instances as the options say, and the environment.
std::expected<ReadScene, Diagnostics> finished(ReadScene read, std::string_view file, Vec3f up,
                                               const ReadOptions& options) {
  if (std::string wrong = apply_instances(options, read.scene); !wrong.empty())
    return failed(file, std::move(wrong));
  const std::string_view light = options.sky ? "sky" : "environment";
  if (options.environment.empty() && !options.sky) {
    if (options.environment_rotation != 0)
      return failed(file,
                    "`env-rotate` has no effect without `environment` or `sky`; leave it "
                    "out");
    return read;
  }
  if (!options.environment.empty() && options.sky)
    return failed(file, "`sky` cannot be combined with `environment`; leave one of them out");
  if (!read.scene.environment.empty())
    read.notices.push_back({Severity::left_out, std::string(file), 0, 0,
                            fmt::format("its own environment; `{}` replaces it", light), ""});
  const auto rotation = double(options.environment_rotation);
  if (options.sky) {
    const auto [turbidity, elevation, azimuth] = *options.sky;
    set_clear_sky(read.scene, double(turbidity), double(elevation), double(azimuth), up, rotation);
  } else if (const auto done = set_environment(read.scene, options.environment, up, rotation);
             !done) {
    return failed(done.error().subject, done.error().message);
  }
  return read;
}

/// Parses a file in memory, compressed or not. `name` is the file without folder; both become those
/// of the decompressed file.
std::expected<ReadScene, Diagnostics> parse(std::shared_ptr<const TextBuffer>& text,
                                            std::string_view file, fs::path& name,
                                            const ReadOptions& options) {
  if (text->view().starts_with(kGzip)) {
    const auto plain = unpacked(text->view());
    if (!plain) return failed(file, plain.error());
    text = std::make_shared<const TextBuffer>(*plain);
    if (suffix_of(name.string()) == ".gz") name = name.stem();
  }
  // Editors do not show the mark and do not count a column for it.
  if (text->view().starts_with(kByteOrderMark))
    text = std::make_shared<const TextBuffer>(text->view().substr(kByteOrderMark.size()));
  const std::string_view bytes = text->view();
  const FileKind kind = file_kind(bytes, suffix_of(name.string()), bytes.size());
  if (!kind.name.empty() && !kind.read)
    return failed(file, fmt::format("this looks like {}; {}", kind.name, kReads));
  if (const auto option = unfit_option(options, kind); !option.empty()) return unfit(file, option);
  auto read = kind.read              ? kind.read(*text, file, options)
              : is_raio_scene(bytes) ? parse_raio(bytes, file, text)
                                     : parse_nff(*text, file);
  if (!read) return read;
  read->scene.name = name.stem().string();
  read->choices.atoms = kind.takes == FileKind::Takes::all;
  read->choices.points = kind.takes != FileKind::Takes::nothing;
  read->choices.mesh =
      kind.is_mesh && !(read->scene.meshes.empty() && read->scene.prototypes.empty());
  if (kind.is_mesh) smooth_meshes(read->scene, options.smooth.value_or(kind.smooth));
  // glTF says which direction is up; in other files the camera does.
  const Vec3f up = kind.read == read_gltf ? Vec3f(0, 1, 0) : read->scene.camera.up;
  return finished(std::move(*read), file, up, options);
}

}  // namespace

std::expected<ReadScene, Diagnostics> parse_scene(std::string_view bytes, std::string_view file,
                                                  const ReadOptions& options) try {
  auto text = std::make_shared<const TextBuffer>(bytes);
  fs::path name = fs::path(file).filename();
  return parse(text, file, name, options);
} catch (const std::bad_alloc&) {
  return failed(file, std::string(kNoMemory));
} catch (const Stopped&) {
  return failed(file, std::string(kStopped));
}

std::expected<ReadScene, Diagnostics> read_scene(const fs::path& path, const ReadOptions& options) {
  return SceneFrames(path).read_one(options);
}

std::expected<ReadScene, Diagnostics> SceneFrames::read_one(const ReadOptions& options) try {
  begin_stage(Stage::reading, 0);
  check_stop();
  const bool standard_input = path_ == "-";
  const fs::path opened = standard_input ? fs::path("/dev/stdin") : path_;
  const std::string file = standard_input ? "standard input" : path_.string();
  if (leads_to_raio(opened)) {
    if (const auto option = unfit_option(options, {}); !option.empty()) return unfit(file, option);
    auto scene = read_raio_scene(opened);
    if (!scene) return std::unexpected(std::move(scene.error()));
    const Vec3f up = scene->camera.up;
    auto read = finished({std::move(*scene), {}}, file, up, options);
    if (read) add_sky(*read, opened, file);
    return read;
  }
  if (!text_) {
    auto text = TextBuffer::read_file(opened);
    if (!text) return failed(file, text.error());
    text_ = std::make_shared<const TextBuffer>(std::move(*text));
    name_ = opened.filename();
  }
  ReadOptions here = options;
  if (!standard_input) here.folder = opened.parent_path();
  auto read = parse(text_, file, name_, here);
  // For standard input, in the current folder.
  if (read) add_sky(*read, opened == "/dev/stdin" ? fs::path("-") : opened, file);
  return read;
} catch (const std::bad_alloc&) {
  return failed(path_.string(), std::string(kNoMemory));
} catch (const Stopped&) {
  return failed(path_.string(), std::string(kStopped));
}

std::expected<SceneFormat, Error> scene_format(const fs::path& path) {
  const std::string suffix = lower_suffix(path);
  if (path == "-" || suffix == ".nff" || suffix == ".p3f") return SceneFormat::nff;
  if (suffix == ".raio") return SceneFormat::raio;
  if (suffix == ".pov") return SceneFormat::pov;
  if (suffix == ".ply") return SceneFormat::ply;
  if (suffix == ".glb" || suffix == ".gltf") return SceneFormat::gltf;
  return std::unexpected(
      Error{ErrorKind::bad_input, "",
            fmt::format("expected a file that ends with .nff, .p3f, .raio, .pov, .ply, .glb or "
                        ".gltf, found '{}'",
                        path.string())});
}

std::string lost_features(const Scene& scene, SceneFormat format) {
  if (format == SceneFormat::raio) return "";
  if (format == SceneFormat::gltf) return not_in_gltf(scene);
  std::string lost = format == SceneFormat::ply ? not_in_ply(scene) : text_of(scene, kNotPlain);
  const auto add = [&](std::string_view more) {
    lost += (lost.empty() || more.empty() ? "" : ", ") + std::string(more);
  };
  if (const size_t count = count_standard_surfaces(scene); count > 0)
    add(fmt::format("glTF's parameters of {} material{}", count, count == 1 ? "" : "s"));
  if (format == SceneFormat::ply) return lost;
  if (format == SceneFormat::nff && scene.dialect == Dialect::nff)
    add(text_of(scene, {Feature::specular_colors, Feature::roughness, Feature::sky}));
  add(text_of(scene, {Feature::all_directions}));
  if (format == SceneFormat::nff && scene.camera.is_parallel()) add("the camera's parallel rays");
  if (format == SceneFormat::nff && scene.dialect == Dialect::data)
    add("the light of figures and their background");
  // In POV-Ray mirrors have colours, but highlights only those of lights.
  if (format == SceneFormat::pov) {
    const std::string colors = text_of(scene, {Feature::specular_colors});
    add(colors.empty() ? "" : "in highlights, " + colors);
    add(text_of(scene,
                {Feature::roughness, Feature::light_extents, Feature::sky, Feature::movement}));
    if (scene.camera.lens_radius.value_or(0) > 0) add("the camera's lens");
    if (const Vec3d& o = scene.origin; o != Vec3d())
      add(fmt::format("its distance from 0; coordinates are relative to {} {} {}", o.x, o.y, o.z));
  }
  return lost;
}

std::expected<void, Error> write_scene(const Scene& scene, const fs::path& path,
                                       std::string_view comment) try {
  const auto format = scene_format(path);
  if (!format) return std::unexpected(format.error());
  const bool keeps_copies =
      *format == SceneFormat::raio || (*format == SceneFormat::gltf && gltf_keeps_copies(scene));
  if (!keeps_copies && !scene.instances.empty()) {
    Scene flat = scene;
    if (std::string wrong = apply_instances({}, flat); !wrong.empty())
      return std::unexpected(Error{ErrorKind::bad_input, "", std::move(wrong)});
    return write_scene(flat, path, comment);
  }
  switch (*format) {
    case SceneFormat::nff:
      return write_file(path, write_nff(scene, comment));
    case SceneFormat::raio:
      return write_raio_scene(scene, path);
    case SceneFormat::ply:
      if (scene.spheres.empty() && !has_faces(scene))
        return std::unexpected(
            Error{ErrorKind::bad_input, "",
                  "PLY stores faces or spheres, and the scene has neither; choose "
                  "another format"});
      return write_file(path, write_ply(scene, comment));
    case SceneFormat::gltf: {
      const auto form = lower_suffix(path) == ".glb" ? GltfForm::binary : GltfForm::text;
      const auto bytes = write_gltf(scene, form, comment);
      if (!bytes) return std::unexpected(Error{ErrorKind::bad_input, "", bytes.error()});
      return write_file(path, *bytes);
    }
    case SceneFormat::pov:
      break;
  }
  PovPicture picture{.name = path.stem().string()};
  if (scene.camera.width > 0)
    picture.width = scene.camera.width, picture.height = scene.camera.height;
  return write_file(path, write_pov(scene, picture, comment));
} catch (const std::bad_alloc&) {
  return std::unexpected(memory_error(path));
}

}  // namespace raio::core
