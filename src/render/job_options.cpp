#include "render/job_options.h"

#include <fmt/format.h>

#include <array>

namespace raio::core {
namespace {

<<<<<<< HEAD
using JobSet = std::expected<void, std::string>;
||||||| afb95cb
using Set = std::expected<void, std::string>;
=======
using Outcome = std::expected<void, std::string>;
>>>>>>> facade

JobSet set_checkpoint(JobRequest& r, const JobOptionSpec&, std::string_view text) {
  if (text.empty()) return std::unexpected("expected a file name, found nothing");
  return r.checkpoint = text, JobSet();
}

<<<<<<< HEAD
JobSet set_shard(JobRequest& r, const JobOptionSpec&, std::string_view text) {
  std::array<uint32_t, 2> part{};
  if (!parse_list(text, '/', part) || part[0] < 1 || part[0] > part[1])
    return expected_but("a part and the number of parts, as in 2/5", text);
  return r.shard = part[0] - 1, r.shards = part[1], JobSet();
||||||| afb95cb
Set set_seconds(double& out, double least, double most, std::string_view text) {
  const auto value = parse_number<double>(text);
  if (!value || !(*value >= least && *value <= most))
    return std::unexpected(
        fmt::format("expected a number from {} to {}, found '{}'", least, most, text));
  return out = *value, Set();
=======
Outcome set_seconds(double& out, double least, double most, std::string_view text) {
  const auto value = parse_number<double>(text);
  if (!value || !(*value >= least && *value <= most))
    return std::unexpected(
        fmt::format("expected a number from {} to {}, found '{}'", least, most, text));
  return out = *value, Outcome();
>>>>>>> facade
}

<<<<<<< HEAD
std::string shard_text(const JobRequest& r, const JobOptionSpec&) {
  return r.shards > 1 ? fmt::format("{}/{}", r.shard + 1, r.shards) : "";
||||||| afb95cb
Set set_shard(JobRequest& r, std::string_view text) {
  const auto pair = parse_pair(text, '/');
  if (!pair || pair->first < 1 || pair->first > pair->second)
    return std::unexpected(
        fmt::format("expected a part and the number of parts, as in 2/5, found '{}'", text));
  return r.shard = pair->first - 1, r.shards = pair->second, Set();
=======
Outcome set_shard(JobRequest& r, std::string_view text) {
  const auto pair = parse_pair(text, '/');
  if (!pair || pair->first < 1 || pair->first > pair->second)
    return std::unexpected(
        fmt::format("expected a part and the number of parts, as in 2/5, found '{}'", text));
  return r.shard = pair->first - 1, r.shards = pair->second, Outcome();
>>>>>>> facade
}

<<<<<<< HEAD
JobSet set_sample_range(JobRequest& r, const JobOptionSpec&, std::string_view text) {
  std::array<uint32_t, 2> range{};
  if (!parse_list(text, ':', range) || range[0] >= range[1])
    return expected_but("the first sample and the end, as in 0:64 or 64:128", text);
  return r.sample_range = {range[0], range[1]}, JobSet();
||||||| afb95cb
Set set_sample_range(JobRequest& r, std::string_view text) {
  const auto pair = parse_pair(text, ':');
  if (!pair || pair->first >= pair->second)
    return std::unexpected(fmt::format(
        "expected the first sample and the end, as in 0:64 or 64:128, found '{}'", text));
  return r.sample_range = {pair->first, pair->second}, Set();
=======
Outcome set_sample_range(JobRequest& r, std::string_view text) {
  const auto pair = parse_pair(text, ':');
  if (!pair || pair->first >= pair->second)
    return std::unexpected(fmt::format(
        "expected the first sample and the end, as in 0:64 or 64:128, found '{}'", text));
  return r.sample_range = {pair->first, pair->second}, Outcome();
>>>>>>> facade
}

<<<<<<< HEAD
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
||||||| afb95cb
constexpr auto kTable = std::to_array<JobOptionSpec>({
    {"checkpoint", "FILE",
     "Save progress to this part file at intervals, on interruption and at the end",
     [](JobRequest& r, std::string_view text) {
       if (text.empty()) return Set(std::unexpected("expected a file name, found nothing"));
       return r.checkpoint = text, Set();
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
     [](JobRequest& r, std::string_view text) { return r.resume = text == "true", Set(); },
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
=======
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
>>>>>>> facade
});

}  // namespace

<<<<<<< HEAD
std::span<const JobOptionSpec> job_option_table() { return kJobTable; }
||||||| afb95cb
std::span<const JobOptionSpec> job_option_table() { return kTable; }
=======
std::span<const JobOptionSpec> job_option_table() { return kJobOptions; }
>>>>>>> facade

}  // namespace raio::core
