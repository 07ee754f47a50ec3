// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/drawing/html_page.hpp"

#include <algorithm>
#include "adit/tools/drawing/markup.hpp"
#include "adit/tools/drawing/svg.hpp"
#include "adit/tools/support/version.hpp"

namespace adit {
namespace {

constexpr std::string_view kStyle = R"(
:root { color-scheme: light dark; }
body { font: 15px/1.5 system-ui, "DejaVu Sans", sans-serif; max-width: 1000px; margin: 2em auto; padding: 0 1em; color: #222; background: #fff; overflow-wrap: break-word; }
h1 { font-size: 1.3em; } h2 { font-size: 1.1em; margin-top: 1.8em; } h1, h2, td, summary { overflow-wrap: anywhere; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: 14px; }
th, td { text-align: right; padding: 0.2em 0.7em; border-bottom: 1px solid #e4e4e4; white-space: nowrap; }
th:first-child, td:first-child, .left { text-align: left; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 0.1em 1em; } dt { color: #666; } dd { margin: 0; }
.finding { border-left: 4px solid #b86e00; background: #fdf6ea; padding: 0.5em 0.8em; margin: 0.6em 0; }
.problem { border-color: #a4262c; background: #fcefee; } .good { border-color: #009e73; background: #ecf8f4; }
.finding p { margin: 0.1em 0; } .wrong { color: #a4262c; } .best { font-weight: bold; } small { color: #666; }
svg { max-width: 100%; height: auto; display: block; } .phone { display: none; }
pre { font: 12.5px/1.5 ui-monospace, "DejaVu Sans Mono", monospace; overflow-x: auto; }
@media (min-width: 1000px) { pre { white-space: pre-wrap; } .scroll { width: max-content; min-width: 100%; max-width: calc(100vw - 3em); margin-left: 50%; transform: translateX(-50%); } }
@media (max-width: 640px) { .desk { display: none; } .phone { display: block; } body { margin: 1em auto; padding: 0 0.8em; } }
@media (prefers-color-scheme: dark) {
  body { color: #eceff3; background: #15181c; } dt, small { color: #a7adb5; } .wrong { color: #f2848a; }
  th, td { border-color: #2d3238; }
  .finding { background: #2e2613; } .problem { background: #331a18; } .good { background: #122b23; }
}
)";

}  // namespace

std::string html_page(std::string_view title, std::string_view body) {
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
         "<meta name=\"generator\" content=\"" +
         std::string(kGenerator) + "\"><title>" + escape_markup(title) + "</title><style>" +
         std::string(kStyle) + "</style></head><body>\n" + std::string(body) + "</body></html>\n";
}

std::string html_text(std::string_view text) {
  std::string html = "<pre>";
  // Line by line: what escapes markup has no line ends.
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    html += escape_markup(text.substr(begin, end - begin)) + "\n";
    begin = end + 1;
  }
  return html + "</pre>\n";
}

std::string html_drawing(const std::function<std::string(double width)>& draw) {
  const std::string desk = draw(kDeskWidth);
  return desk.empty() ? desk
                      : "<div class=\"desk\">" + desk + "</div><div class=\"phone\">" +
                            draw(kPhoneWidth) + "</div>\n";
}

}  // namespace adit
