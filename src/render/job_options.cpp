#include "render/job_options.h"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "render/option_text.h"

namespace raio::core {
namespace {

using Outcome = std::expected<void, std::string>;

// Two numbers with a mark between them.
std::optional<std::pair<uint32_t, uint32_t>> parse_pair(std::string_view text, char mark) {
  const size_t at = text.find(mark);
  if (at == std::string_view::npos) return std::nullopt;
  const auto first = parse_number<uint32_t>(text.substr(0, at)),
             second = parse_number<uint32_t>(text.substr(at + 1));
  if (!first || !second) return std::nullopt;
  return std::pair(*first, *second);
}

Outcome set_seconds(double& out, double least, double most, std::string_view text) {
  const auto value = parse_number<double>(text);
  if (!value || !(*value >= least && *value <= most))
    return std::unexpected(
        fmt::format("expected a number from {} to {}, found '{}'", least, most, text));
  return out = *value, Outcome();
}

Outcome set_shard(JobRequest& r, std::string_view text) {
  const auto pair = parse_pair(text, '/');
  if (!pair || pair->first < 1 || pair->first > pair->second)
    return std::unexpected(
        fmt::format("expected a part and the number of parts, as in 2/5, found '{}'", text));
  return r.shard = pair->first - 1, r.shards = pair->second, Outcome();
}

Outcome set_sample_range(JobRequest& r, std::string_view text) {
  const auto pair = parse_pair(text, ':');
  if (!pair || pair->first >= pair->second)
    return std::unexpected(fmt::format(
        "expected the first sample and the end, as in 0:64 or 64:128, found '{}'", text));
  return r.sample_range = {pair->first, pair->second}, Outcome();
}

constexpr auto kJobOptions = std::to_array<JobOptionSpec>({
    {"checkpoint", "FILE",
     "Save progress to this part file at intervals, on interruption and at the end",
     [](JobRequest& r, std::string_view text) {
       if (text.empty()) return Outcome(std::unexpected("expected a file name, found nothing"));
       return r.checkpoint = text, Outcome();
     },
     [](const JobRequest& r) { return r.checkpoint; }},
    {"checkpoint-interval", "SECONDS", "Seconds between writes of `checkpoint` (default: 60)",
     [](JobRequest& r, std::string_view text) {
       return set_seconds(r.checkpoint_interval_s, 0.01, 1e6, text);
     },
     [](const JobRequest& r) {
       const bool usual = r.checkpoint_interval_s == JobRequest().checkpoint_interval_s;
       return usual ? "" : fmt::format("{}", r.checkpoint_interval_s);
     }},
    {"resume", "", "Continue from the `checkpoint` file if it exists",
     [](JobRequest& r, std::string_view text) { return r.resume = text == "true", Outcome(); },
     [](const JobRequest& r) { return std::string(r.resume ? "true" : ""); }},
    {"time-limit", "SECONDS",
     "Stop after about this many seconds; all pixels then have the same number of samples",
     [](JobRequest& r, std::string_view text) {
       return set_seconds(r.time_limit_s, 0.001, 1e9, text);
     },
     [](const JobRequest& r) {
       return r.time_limit_s > 0 ? fmt::format("{}", r.time_limit_s) : "";
     }},
    {"shard", "I/N", "Render part I of N into a part file for raio merge", set_shard,
     [](const JobRequest& r) {
       return r.shards > 1 ? fmt::format("{}/{}", r.shard + 1, r.shards) : "";
     }},
    {"sample-range", "A:B",
     "Render samples A to before B of every pixel, counted from 0, into a part file for raio merge",
     set_sample_range, [](const JobRequest& r) { return text_of(r.sample_range); }},
});

}  // namespace

std::span<const JobOptionSpec> job_option_table() { return kJobOptions; }

}  // namespace raio::core
