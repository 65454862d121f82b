/// Manual pages in the macros of man(7).
#pragma once

#include <string>
#include <string_view>

namespace ocm::generate {

/// One page, section by section.
class ManPage {
 public:
  /// `what` is half a sentence, for whatis(1).
  ManPage(std::string_view name, std::string_view what, std::string_view version);

  /// A section of running text; an empty line begins a paragraph.
  ManPage& text(std::string_view heading, std::string_view text);
  /// A section whose lines stay as they are.
  ManPage& literal(std::string_view heading, std::string_view text);

  [[nodiscard]] std::string make() const { return page_; }

 private:
  void section(std::string_view heading);

  std::string page_;
};

}  // namespace ocm::generate
