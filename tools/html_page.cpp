// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/html_page.hpp"

#include "tools/markup.hpp"
#include "tools/results/output_folder.hpp"

namespace adit {
namespace {

constexpr std::string_view kStyle = R"(
:root { color-scheme: light dark; }
body { font: 14px/1.45 system-ui, sans-serif; max-width: 1000px; margin: 2em auto; padding: 0 1em; color: #222; background: #fff; }
h1 { font-size: 1.3em; } h2 { font-size: 1.1em; margin-top: 1.8em; }
table { border-collapse: collapse; width: 100%; }
th, td { text-align: right; padding: 0.2em 0.6em; border-bottom: 1px solid #e4e4e4; white-space: nowrap; }
th:first-child, td:first-child, th:nth-child(2), td:nth-child(2), th:nth-child(3), td:nth-child(3) { text-align: left; }
.finding { border-left: 4px solid #d98000; background: #fdf6ea; padding: 0.5em 0.8em; margin: 0.6em 0; }
.problem { border-color: #d1352b; background: #fcefee; }
.good { border-color: #2a9d3a; background: #eef8ef; }
.finding p { margin: 0.1em 0; } svg { max-width: 100%; height: auto; }
pre { font: 12.5px/1.5 ui-monospace, monospace; overflow-x: auto; }
@media (prefers-color-scheme: dark) {
  body { color: #eceff3; background: #15181c; }
  th, td { border-color: #2d3238; }
  .finding { background: #2e2613; } .problem { background: #331a18; } .good { background: #15291a; }
}
)";

}  // namespace

std::string html_page(std::string_view title, std::string_view body) {
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
         "<meta name=\"generator\" content=\"" +
         std::string(kGenerator) + "\"><title>" +
         escape_markup(title) + "</title><style>" + std::string(kStyle) +
         "</style></head><body>\n" + std::string(body) + "</body></html>\n";
}

}  // namespace adit
