#include <memory>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "cli/completion/completer.hpp"
#include "cli/verbs/verb.hpp"
#include "cli/words/suggestion.hpp"

// Each shell asks the tool itself, by `amiroctl completion --words -- WORD ...`, so that a script never grows
// old, and topics of another --spec are known. The answer's first line is "words" or "files" (then names of
// files are candidates, too); each further line a candidate, or a candidate, a tab and what it is.

namespace ocm::cli {
namespace {

constexpr std::string_view bash = R"sh(# Completion of amiroctl in bash. Made by: amiroctl completion bash
_amiroctl() {
  local line=${COMP_LINE:0:COMP_POINT} words=() word= begun= quote= redirected= before= c i kind candidate
  # Words as bash would make them: without quotes and redirections, ~/ in place.
  for ((i = 0; i < ${#line}; i++)); do
    c=${line:i:1}
    if [[ $quote && $c == "$quote" ]]; then quote=
    elif [[ $quote == "'" ]]; then word+=$c
    elif [[ $c == \\ ]]; then ((++i)); word+=${line:i:1} begun=1
    elif [[ $quote ]]; then word+=$c
    elif [[ $c == [\'\"] ]]; then quote=$c begun=1 before=$word
    elif [[ $c == [[:space:]\<\>] ]]; then
      [[ $c == [\<\>] && $word == [0-9\&] ]] && begun=
      if [[ $begun && ! $redirected ]]; then words+=("$word"); fi
      [[ $begun ]] && redirected=
      [[ $c == [\<\>] ]] && redirected=1
      word= begun=
    elif [[ ! $begun && ${line:i} == '~/'*[[:space:]]* ]]; then word=$HOME begun=1
    else word+=$c begun=1
    fi
  done
  COMPREPLY=()
  if [[ $redirected ]]; then compopt -o default; return 0; fi
  words+=("$word")
  [[ $quote ]] || before=${word%"${word##*[=:]}"}  # bash completes only what follows the last of = and :
  while IFS= read -r candidate; do
    if [[ -z $kind ]]; then kind=$candidate; continue; fi
    candidate=${candidate%%$'\t'*}
    COMPREPLY+=("${candidate#"$before"}")
  done < <("${words[0]}" completion --words -- "${words[@]:1}" 2>/dev/null)
  [[ $kind == files ]] && compopt -o default
  [[ ${#COMPREPLY[@]} == 1 && ${COMPREPLY[0]} == *[=:] ]] && compopt -o nospace
  return 0
}
complete -F _amiroctl amiroctl
)sh";

constexpr std::string_view zsh = R"sh(#compdef amiroctl
# Completion of amiroctl in zsh. Made by: amiroctl completion zsh
_amiroctl() {
  local -a lines names shown open opened
  local line name
  local -a typed
  typed=("${(@Q)${(@)words[1,CURRENT-1]/#\~\//${(q)HOME}/}}")  # without quotes, ~/ in place
  lines=("${(@f)$("${typed[1]}" completion --words -- "${(@)typed[2,-1]}" "$PREFIX" 2>/dev/null)}")
  for line in "${(@)lines[2,-1]}"; do
    name=${line%%$'\t'*}
    [[ -n $name ]] || continue
    if [[ $name == *[=:] ]]; then
      open+=("$name"); opened+=("${line/$'\t'/  -- }")
    else
      names+=("$name"); shown+=("${line/$'\t'/  -- }")
    fi
  done
  (( ${#names} )) && compadd -l -d shown -a -- names
  (( ${#open} )) && compadd -S '' -l -d opened -a -- open
  [[ ${lines[1]} == files ]] && _files
  return 0
}
if [[ ${funcstack[1]} == _amiroctl ]]; then
  _amiroctl "$@"
else
  compdef _amiroctl amiroctl
fi
)sh";

constexpr std::string_view fish = R"sh(# Completion of amiroctl in fish. Made by: amiroctl completion fish
function __amiroctl_complete
  set -l words (commandline -opc)
  set -l current (commandline -ct)
  set -l lines ($words[1] completion --words -- $words[2..-1] "$current" 2>/dev/null)
  if test (count $lines) -gt 1
    printf '%s\n' $lines[2..-1]
  end
  if test "$lines[1]" = files
    __fish_complete_path "$current"
  end
end
complete -c amiroctl -f -a '(__amiroctl_complete)'
)sh";

void print_words(Verb program, Session& session, const std::vector<std::string>& words) {
  const Completion completion = complete(program, session, words);
  fmt::print("{}\n", completion.files ? "files" : "words");
  for (const auto& candidate : completion.candidates)
    fmt::print("{}{}{}\n", candidate.word, candidate.what.empty() ? "" : "\t", candidate.what);
}

void print_script(const std::vector<std::string>& shells) {
  if (shells.size() == 1)
    for (const auto& [name, script] : {std::pair{"bash", bash}, {"zsh", zsh}, {"fish", fish}})
      if (shells.front() == name) return fmt::print("{}", script);
  const std::string form = "usage: amiroctl completion bash|zsh|fish";
  if (shells.empty()) fail({"completion: missing bash|zsh|fish", form}, exit_usage);
  if (shells.size() > 1)
    fail({fmt::format("completion: unexpected argument '{}'", shells[1]), form}, exit_usage);
  constexpr std::string_view known[] = {"bash", "zsh", "fish"};
  fail({fmt::format("completion: unknown shell '{}'", shells[0]), words::suggestion(shells[0], known)},
       exit_usage);
}

}  // namespace

void declare_completion(Verb verb, Session& session, int&) {
  verb.describe(
      "completion of commands, topics and options in a shell", help_group,
      "  source <(amiroctl completion bash)       for this bash; for good: put it into\n"
      "                                           ~/.local/share/bash-completion/completions/amiroctl\n"
      "  amiroctl completion zsh > ~/.zfunc/_amiroctl\n"
      "  amiroctl completion fish > ~/.config/fish/completions/amiroctl.fish");
  struct Options {
    std::vector<std::string> words;
    bool ask = false;
  };
  const auto options = std::make_shared<Options>();
  verb.add_option("shell", options->words, "the shell").type_name("bash|zsh|fish").in_usage("bash|zsh|fish");
  verb.add_flag("--words", options->ask,
                "what the scripts ask: candidates for the last of the words behind --");
  verb.callback([options, program = verb.parent(), &session] {
    options->ask ? print_words(program, session, options->words) : print_script(options->words);
  });
}

}  // namespace ocm::cli
