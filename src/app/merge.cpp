#include <fmt/core.h>

#include <algorithm>
#include <expected>
#include <utility>

#include "app/commands.h"
#include "app/output.h"
#include "app/terminal.h"
#include "render/part.h"
#include "render/picture.h"
#include "render/warnings.h"

namespace raio::core::app {

int run(const MergeCommand& command) {
  const std::string& output = command.output;
  const bool to_part = is_part_path(output);
  if (const auto why = output_problem(output)) return fail(*why);

  // One part at a time is in memory, beside the result.
  NamedPart part;
  uint32_t shards = 1;
  const auto read = [&](size_t i) -> std::expected<NamedPart*, Error> {
    part = {command.parts[i], {}};
    auto next = read_part(command.parts[i]);
    if (!next) return std::unexpected(std::move(next.error()));
    part.part = std::move(*next);
    shards = std::max(shards, part.part.header.shards);
    if (i == 0) {
      const auto channels = channels_of(part.part);
      if (!channels) return std::unexpected(channels.error());
      if (const auto why = output_problem(output, *channels)) return std::unexpected(*why);
    }
    return &part;
  };
  const size_t count = command.parts.size();
  const auto merged = merge_parts(count, read);
  if (!merged) return fail(merged.error());
  const std::string missing = missing_samples(*merged, shards);
  if (!missing.empty() && !to_part)
    return bad_input(missing +
                     "; add the parts that have them, finish parts with --checkpoint and --resume, "
                     "or merge to a part (-o NAME.raio)");

  const auto notes = write_result(output, *merged);
  if (!notes) return fail(notes.error());
  if (!command.quiet)
    for (const std::string& note : *notes) print_line("raio: " + note);
  const auto options = options_from(merged->header.settings, false);
  for (const std::string& why :
       fault_warnings(*merged->film, options ? options->crop : std::nullopt))
    print_line("raio: warning: " + why);
  if (!command.quiet)
    print_line(fmt::format("{}: {}x{}, {} part{}{}",
                           is_standard_output(output) ? "picture" : output, merged->film->width(),
                           merged->film->height(), count, count == 1 ? "" : "s",
                           missing.empty() ? "" : ", " + missing));
  return kDone;
}

}  // namespace raio::core::app
