// Lessons beside the picture, whose commands are shown in the window.
#include <utility>

#include "integrate/camera.h"
#include "render/render.h"
#include "view/app_state.h"
#include "view/texts.h"

namespace raio::core::view {

void AppState::switch_lesson() {
  shows_lesson = !shows_lesson;
  if (shows_lesson) ask(request::OpenLesson{});
  say(shows_lesson ? tr("lesson shown") : tr("lesson hidden; F2 shows it"));
}

void AppState::use_lesson(const LessonResult& did) {
  if (did.page) {
    shows_lesson = true;
    ask(request::OpenLesson{*did.page});
    refresh();
  }
  if (did.copied) {
    ask(request::CopyText{*did.copied});
    say(trf("copied: {}", *did.copied));
  }
  if (did.show) show(*did.show);
  if (did.closes) switch_lesson();
}

void AppState::show(const app::ShownScene& what) {
  if (const auto why = window_conflict(what.options)) return complain(why->text("--"));
  wanted_show_ = what;
  wanted_show_->scene = short_path(what.scene);
  ReadOptions read = what.read;
  read.instances = kForWindow.instances, read.labels = kForWindow.labels;
  ask(request::OpenFile{wanted_show_->scene, read});
}

void AppState::take_shown(const app::ShownScene& what) {
  RenderOptions options = what.options;
  if (what.pixel) {
    // Of this size only, the pixel has the numbers of the lesson.
    if (what.size) options.width = (*what.size)[0], options.height = (*what.size)[1];
    const RenderSettings settings = resolve_options(options, *view.scene);
    options.width = settings.width, options.height = settings.height;
  }
  ViewState next(view.path, view.scene, options);
  next.grows = what.pixel.has_value();
  next.read_options = view.read_options, next.file = view.file;
  next.file_version = view.file_version;
  next.keep_habits(view);
  view = std::move(next);
  moving_until_ = 0;
  if (!what.pixel) return;
  const RenderSettings s = resolve_options(options, *view.scene);
  const auto [column, row] = *what.pixel;
  const Ray ray = EyeRays(s.camera, s.width, s.height, s.angle_to_centers)
                      .pinhole(float(column) + 0.5f, float(row) + 0.5f);
  const double far = length(Vec3d(s.camera.at) - Vec3d(s.camera.from));
  wanted_rays_ = Vec3d(ray.origin) + Vec3d(ray.dir) * far;
}

}  // namespace raio::core::view
