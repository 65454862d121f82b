/// The bus as a table that changes while one looks: values, rates and what is missing, live or from a log.
#include "cli/top/top.hpp"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "cli/logs/format.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/values.hpp"
#include "cli/verbs/verb.hpp"
#include "cli/watch/chosen_topics.hpp"
#include "cli/watch/watching.hpp"
#include "cli/words/quantity.hpp"
#include "cli/words/topics.hpp"

namespace ocm::cli {
namespace {

struct Given {
  std::vector<std::string> words;
  top::TopOptions options;
};

void run(Session& session, Given& given, int& exit_code) {
  const auto& catalogue = session.catalogue();
  const Words words = split_words("top", given.words, [&catalogue](std::string_view word) {
    return std::any_of(catalogue.topics.begin(), catalogue.topics.end(), [&](const protocol::Topic& topic) {
      return words::find_topic(catalogue, word) == &topic || words::is_in_group(topic, word);
    });
  });
  if (words.files.size() > 1)
    fail({fmt::format("top: {} and {} are two logs", words.files[0], words.files[1]),
          "name one; amiroctl convert puts several into one"},
         exit_usage);
  if (words.files.empty() && !given.options.format.empty())
    fail({"--from " + given.options.format + " is the format of a log, and there is none",
          "name the log, or drop --from"},
         exit_usage);
  if (given.options.interval < top::shortest_interval)
    fail({"top: --interval " + words::to_text(given.options.interval) +
              ": twenty pictures a second are the most",
          "write --interval 50ms, or longer"},
         exit_usage);
  given.options.topics = chosen_topics("top", catalogue, words.others);
  if (!words.files.empty()) given.options.log = words.files[0];
  exit_code = top::run(session, given.options);
}

}  // namespace

void declare_top(Verb verb, Session& session, int& exit_code) {
  verb.describe("the bus as a table that changes while you look, live or from a log", watch_group,
                "  amiroctl top                       all that is on the bus; ? shows the keys, q quits\n"
                "  amiroctl top gyro odom\n"
                "  amiroctl top drive.log             played, with a bar to wind it\n"
                "  amiroctl top --spec car.dbc --bitrate 500k");
  const auto given = std::make_shared<Given>();
  verb.add_option("words", given->words,
                  "a log, any format; none, or live: the bus. Topics to show; default: all")
      .type_name("[FILE|live] [TOPIC ...]");
  verb.add_option("--from", given->options.format, "format of the log; default: what it begins with says it")
      .type_name("FORMAT")
      .takes(accepted_words(logs::readable_formats()));
  add_bit_rate(verb, "--bitrate", given->options.bit_rate,
               "for the load, such as 500k; default: what the bus says, else the spec");
  add_data_bit_rate(verb, "--data-bitrate", given->options.data_bit_rate,
                    "of CAN FD behind its bit-rate switch, such as 2M; default: the spec's");
  add_duration(verb, "--interval", given->options.interval, "from one picture to the next, at least 50ms");
  verb.add_flag("--mouse", given->options.mouse,
                "a click chooses a row, and the wheel moves; Shift still marks text");
  verb.callback([given, &session, &exit_code] { run(session, *given, exit_code); });
}

}  // namespace ocm::cli
