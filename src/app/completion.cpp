// Completion scripts, with one generator per shell. All know the same: the current command, the
// options of each command, and for each value its words or file types.
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "app/manual.h"
#include "app/outline.h"
#include "io/scene_file.h"

namespace raio::core::app {
namespace {

// Suffixes of the files allowed for a value, by its name in the help; "*" for any.
std::vector<std::string> file_suffixes(const CLI::Option& option) {
  const std::string name = value_name(option);
  if (name == "OUT") return {"nff", "p3f", "raio", "ply", "pov"};
  if (name == "SCENE" || name == "IN") {
    const std::vector<std::string_view> suffixes = scene_suffixes();
    return {suffixes.begin(), suffixes.end()};
  }
  if (name == "A" || name == "B" || name == "STUDENT")
    return {"png", "jpg", "jpeg", "exr", "ppm", "pfm"};
  if (name == "IMAGE") return {"png", "exr", "npz", "npy", "ppm", "pfm", "raio"};
  if (name == "PART") return {"raio"};
  if (name == "FILE") return {"*"};
  return {};
}

bool is_any(const std::vector<std::string>& suffixes) {
  return suffixes == std::vector<std::string>{"*"};
}

// " spd verify"; empty for the program itself.
std::string spaced_path(const CLI::App& command) {
  const std::string name = full_name(command);
  return name.substr(std::min(name.find(' '), name.size()));
}

// Escapes characters that are special to a shell with backslashes.
std::string escaped(std::string_view text, std::string_view special) {
  std::string out;
  for (const char c : text) {
    if (special.find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

std::string all_names(const CLI::App& command) {
  std::vector<std::string> out;
  for (const CLI::Option* option : named_options(command))
    for (const std::string& name : option_names(*option)) out.push_back(name);
  return fmt::format("{}", fmt::join(out, " "));
}

// The cases ` spd'|' spd verify' with which bash and zsh find the current command.
std::string known_paths(const CLI::App& app) {
  std::vector<std::string> paths;
  for (const CLI::App* command : all_commands(app))
    if (command != &app) paths.push_back(fmt::format("'{}'", spaced_path(*command)));
  return fmt::format("{}", fmt::join(paths, "|"));
}

std::string bash_offer(const std::vector<std::string>& words,
                       const std::vector<std::string>& suffixes) {
  std::string out;
  if (!words.empty()) out += fmt::format(" words='{}'", fmt::join(words, " "));
  if (!suffixes.empty()) out += fmt::format(" files='{}'", fmt::join(suffixes, " "));
  return out.empty() ? " return" : out;
}

constexpr std::string_view kBashBegin =
    R"(# Completion of raio for bash; made by: raio completion bash
_raio() {
  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]}
  local command='' words='' options='' files='' suffix i
  # --option=value comes as three words.
  if [[ $cur == = ]]; then
    cur=''
  elif [[ $prev == = ]] && ((COMP_CWORD > 1)); then
    prev=${COMP_WORDS[COMP_CWORD-2]}
  fi
  for ((i = 1; i < COMP_CWORD; i++)); do
    case "$command ${COMP_WORDS[i]}" in
)";

constexpr std::string_view kBashEnd = R"(      esac
      if [[ $cur == -* ]]; then words=$options files=''; fi ;;
  esac
  COMPREPLY=()
  [[ $words ]] && mapfile -t COMPREPLY < <(compgen -W "$words" -- "$cur")
  [[ $files ]] || return
  compopt -o filenames
  if [[ $files == '*' ]]; then
    mapfile -t COMPREPLY < <(compgen -f -- "$cur")
    return
  fi
  # Where no file is of the kind, readline offers what there is.
  ((${#COMPREPLY[@]})) || compopt -o default
  mapfile -t -O ${#COMPREPLY[@]} COMPREPLY < <(
    compgen -d -- "$cur"
    for suffix in $files; do compgen -f -X "!*.$suffix" -- "$cur"; done)
}
complete -F _raio raio
)";

std::string bash(const CLI::App& app) {
  std::string out(kBashBegin), of_commands;
  out += fmt::format("      {}) command+=\" ${{COMP_WORDS[i]}}\" ;;\n      *) break ;;\n",
                     known_paths(app));
  out += "    esac\n  done\n  case \"$command $prev\" in\n";
  std::map<std::string, std::vector<std::string>> cases;  // by their completions
  for (const CLI::App* command : all_commands(app)) {
    const std::string path = spaced_path(*command);
    for (const CLI::Option* option : named_options(*command))
      if (takes_value(*option))
        for (const std::string& name : option_names(*option))
          cases[bash_offer(value_words(*option), file_suffixes(*option))].push_back(
              fmt::format("'{} {}'", path, name));
    std::vector<std::string> words, suffixes;
    for (const CLI::App* c : commands(*command)) words.push_back(c->get_name());
    for (const CLI::Option* option : positionals(*command)) {
      for (const std::string& word : value_words(*option)) words.push_back(word);
      for (std::string& suffix : file_suffixes(*option))
        if (std::ranges::count(suffixes, suffix) == 0) suffixes.push_back(std::move(suffix));
    }
    of_commands += fmt::format("        '{}') options='{}'", path, all_names(*command));
    if (!words.empty() || !suffixes.empty()) of_commands += bash_offer(words, suffixes);
    of_commands += " ;;\n";
  }
  for (const auto& [offer, names] : cases)
    out += fmt::format("    {}){} ;;\n", fmt::join(names, "|"), offer);
  return out + "    *)\n      case \"$command\" in\n" + of_commands + std::string(kBashEnd);
}

// The value specification of _arguments: ":NAME:ACTION", in single quotes.
std::string zsh_value(const CLI::Option& option) {
  const std::vector<std::string> words = value_words(option), suffixes = file_suffixes(option);
  std::string files = "_files";
  if (!suffixes.empty() && !is_any(suffixes))
    files += fmt::format(" -g \"*.({})\"", fmt::join(suffixes, "|"));
  std::string action = " ";
  if (!words.empty() && !suffixes.empty())
    action = fmt::format("{{ compadd - {}; {} }}", fmt::join(words, " "), files);
  else if (!words.empty())
    action = fmt::format("({})", fmt::join(words, " "));
  else if (!suffixes.empty())
    action = files;
  return fmt::format(":{}:{}", escaped(value_name(option), ":\\"), action);
}

// A word of zsh in single quotes.
std::string zsh_quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string zsh_option(const CLI::Option& option) {
  const std::vector<std::string> names = option_names(option);
  std::string out;
  for (const std::string& name : names) {
    std::string spec = names.size() > 1 ? fmt::format("({})", fmt::join(names, " ")) : "";
    spec += name;
    if (takes_value(option)) spec += name.starts_with("--") ? "=" : "+";
    spec += fmt::format("[{}]", escaped(first_clause(option), "[]:\\"));
    if (takes_value(option)) spec += (needs_value(option) ? "" : ":") + zsh_value(option);
    out += " \\\n        " + zsh_quoted(spec);
  }
  return out;
}

constexpr std::string_view kZshBegin = R"(#compdef raio
# Completion of raio for zsh; made by: raio completion zsh
_raio() {
  local command='' i
  local -a names
  for ((i = 2; i < CURRENT; i++)); do
    case "$command $words[i]" in
)";

std::string zsh(const CLI::App& app) {
  std::string out(kZshBegin);
  out +=
      fmt::format("      ({}) command+=\" $words[i]\" ;;\n      (*) break ;;\n", known_paths(app));
  // _arguments takes the first word as the command.
  out += "    esac\n  done\n  shift $((i - 2)) words\n  ((CURRENT -= i - 2))\n  case $command in\n";
  for (const CLI::App* command : all_commands(app)) {
    const std::string path = spaced_path(*command);
    out += fmt::format("    ('{}')\n", path);
    std::string specs;
    for (const CLI::Option* option : named_options(*command)) specs += zsh_option(*option);
    if (const auto below = commands(*command); !below.empty()) {
      out += "      names=(";
      for (const CLI::App* c : below)
        out +=
            "\n        " + zsh_quoted(c->get_name() + ":" + escaped(c->get_description(), ":\\"));
      out +=
          ")\n      if [[ $words[CURRENT] != -* ]]; then\n        _describe -t commands command "
          "names\n"
          "        return\n      fi\n";
    }
    for (const CLI::Option* option : positionals(*command))
      specs += " \\\n        " + zsh_quoted((is_list(*option) ? "*" : "") + zsh_value(*option));
    out += fmt::format("      _arguments -s -S{} ;;\n", specs);
  }
  return out + "  esac\n}\n_raio \"$@\"\n";
}

std::string fish_quoted(std::string_view text) { return "'" + escaped(text, "'\\") + "'"; }

// " -x -a 'auto none'", for a value or an argument.
std::string fish_value(const CLI::Option& option) {
  const std::vector<std::string> words = value_words(option), suffixes = file_suffixes(option);
  if (is_any(suffixes)) return " -r -F";
  std::string offered = fmt::format("{}", fmt::join(words, " "));
  if (!suffixes.empty())
    offered +=
        fmt::format("{}(__raio_files {})", words.empty() ? "" : " ", fmt::join(suffixes, " "));
  return offered.empty() ? " -x" : " -x -k -a " + fish_quoted(offered);
}

constexpr std::string_view kFishBegin =
    R"(# Completion of raio for fish; made by: raio completion fish
# Is the line in the command that the arguments name?
function __raio_in
    set -l words (commandline -opc)
    set -e words[1]
    test (count $words) -ge (count $argv); or return 1
    for i in (seq (count $argv))
        test "$words[$i]" = "$argv[$i]"; or return 1
    end
end
# And does its own command come next?
function __raio_before
    __raio_in $argv; and test (count (commandline -opc)) -eq (math (count $argv) + 1)
end
# Folders, and files with these suffixes; where there are none, all files.
function __raio_files
    set -l word (string replace -r '^--[^=]*=' '' -- (commandline -ct))
    set -l found (complete -C "__fish_command_without_completions $word")
    string match -r -- '^.*(?:/|\.(?:'(string join '|' $argv)'))$' $found
    or printf '%s\n' $found
end
complete -c raio -f
)";

std::string fish(const CLI::App& app) {
  std::string out(kFishBegin);
  for (const CLI::App* command : all_commands(app)) {
    const std::string path = spaced_path(*command);
    const bool leaf = commands(*command).empty();
    const std::string begin =
        fmt::format("complete -c raio -n '{}{}'", leaf ? "__raio_in" : "__raio_before", path);
    for (const CLI::App* c : commands(*command))
      out +=
          fmt::format("{} -a {} -d {}\n", begin, c->get_name(), fish_quoted(c->get_description()));
    for (const CLI::Option* option : positionals(*command))
      if (const std::string value = fish_value(*option); value != " -x")
        out += begin + value.substr(value.find(" -k") == std::string_view::npos ? 0 : 3) + "\n";
    for (const CLI::Option* option : named_options(*command)) {
      out += begin;
      for (const std::string& name : option->get_snames()) out += " -s " + name;
      for (const std::string& name : option->get_lnames()) out += " -l " + name;
      if (takes_value(*option)) out += fish_value(*option);
      out += " -d " + fish_quoted(first_clause(*option)) + "\n";
    }
  }
  return out;
}

}  // namespace

std::string completion(const CLI::App& app, std::string_view shell) {
  return shell == "bash" ? bash(app) : shell == "zsh" ? zsh(app) : fish(app);
}

}  // namespace raio::core::app
