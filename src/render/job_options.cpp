#include "render/job_options.h"

#include <fmt/format.h>

#include <array>

namespace raio::core {
namespace {

using JobSet = std::expected<void, std::string>;

JobSet set_checkpoint(JobRequest& r, const JobOptionSpec&, std::string_view text) {
  if (text.empty()) return std::unexpected("expected a file name, found nothing");
  return r.checkpoint = text, JobSet();
}

JobSet set_shard(JobRequest& r, const JobOptionSpec&, std::string_view text) {
  std::array<uint32_t, 2> part{};
  if (!parse_list(text, '/', part) || part[0] < 1 || part[0] > part[1])
    return expected_but("a part and the number of parts, from 1/N to N/N, as in 2/5", text);
  return r.shard = part[0] - 1, r.shards = part[1], JobSet();
}

std::string shard_text(const JobRequest& r, const JobOptionSpec&) {
  return r.shards > 1 ? fmt::format("{}/{}", r.shard + 1, r.shards) : "";
}

JobSet set_sample_range(JobRequest& r, const JobOptionSpec&, std::string_view text) {
  std::array<uint32_t, 2> range{};
  if (!parse_list(text, ':', range) || range[0] >= range[1])
    return expected_but("the first sample and the end, as in 0:64 or 64:128", text);
  return r.sample_range = {range[0], range[1]}, JobSet();
}

using enum OptionGroup;
using table::option, table::usual, table::range;

template <auto member>
constexpr OptionValue<JobRequest> kJobValue = kMember<JobRequest, member>;

constexpr auto kJobTable = std::to_array<JobOptionSpec>({
    option(long_renders, "checkpoint", "FILE",
           "Save progress to this part file at intervals, on interruption and at the end",
           OptionValue<JobRequest>{OptionType::text, set_checkpoint,
                                   kJobValue<&JobRequest::checkpoint>.text}),
    option(long_renders, "checkpoint-interval", "SECONDS", "Seconds between writes of `checkpoint`",
           kJobValue<&JobRequest::checkpoint_interval_s>, usual("60"), range(0.01, 1e6)),
    option(long_renders, "resume", "", "Continue from the `checkpoint` file if it exists",
           kJobValue<&JobRequest::resume>),
    option(long_renders, "time-limit", "SECONDS",
           "Stop after about this many seconds; all pixels then have the same number of samples",
           kJobValue<&JobRequest::time_limit_s>, usual("none"), range(0.001, 1e9, "seconds")),
    option(long_renders, "shard", "I/N", "Render part I of N into a part file for raio merge",
           OptionValue<JobRequest>{OptionType::text, set_shard, shard_text}),
    option(long_renders, "sample-range", "A:B",
           "Render samples A to before B of every pixel, counted from 0, into a part file for raio "
           "merge",
           OptionValue<JobRequest>{
               OptionType::text, set_sample_range,
               [](const JobRequest& r, const JobOptionSpec&) { return text_of(r.sample_range); }}),
});

}  // namespace

std::span<const JobOptionSpec> job_option_table() { return kJobTable; }

}  // namespace raio::core
