// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: Apache-2.0
#include "adit/tools/commands/command_generate.hpp"

#include <iostream>
#include <memory>
#include <system_error>
#include <utility>
#include <vector>

#include "adit/tools/cli/command_guard.hpp"
#include "adit/tools/cli/command_line.hpp"
#include "adit/tools/cli/completion.hpp"
#include "adit/tools/cli/manual_page.hpp"
#include "adit/tools/support/input_error.hpp"
#include "adit/tools/support/output_file.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& file, const std::string& text) {
  std::error_code failed;
  fs::create_directories(file.parent_path(), failed);
  if (failed) {
    throw OutputError(file.parent_path(), file.parent_path().string() +
                                              " could not be made: " + failed.message() +
                                              ". Name a folder that you may write to.");
  }
  write_text_file(file, text);
}

}  // namespace

int generate_command(const CommandDescription& program, const fs::path& folder, std::ostream& out,
                     std::ostream& err) {
  return guarded("adit generate", out, err, [&] {
    const std::vector<ManualPage> pages = manual_pages(program);
    for (const ManualPage& page : pages) {
      write(folder / "man" / "man1" / (page.name + ".1"), page.text);
    }
    write(folder / "bash-completion" / "completions" / "adit", bash_completion(program));
    write(folder / "zsh" / "site-functions" / "_adit", zsh_completion(program));
    write(folder / "fish" / "vendor_completions.d" / "adit.fish", fish_completion(program));
    out << "wrote  " << pages.size()
        << " manual pages, completions for bash, zsh and fish: " << folder.string() << "\n";
    return 0;
  });
}

void add_generate_command(Command app, std::function<CommandDescription()> program,
                          std::function<void(int)> done) {
  const Command command =
      app.add_command("generate", "Write manual pages, and completions for bash, zsh and fish");
  const auto folder = std::make_shared<fs::path>();
  command.footer(
      "Packages have them already; this is for programs from a checkout or a wheel. Of FOLDER\n"
      "~/.local/share, man, bash and fish know by themselves; zsh's `fpath` needs\n"
      "FOLDER/zsh/site-functions.\n\n"
      "Example:\n"
      "  adit generate ~/.local/share\n\n"
      "Exit codes: 0 done, 1 a file cannot be written, 2 usage.");
  command.option("folder", *folder, "Where to; made if need be").required().value_name("FOLDER");
  command.action([folder, program = std::move(program), done = std::move(done)] {
    done(generate_command(program(), *folder, std::cout, std::cerr));
  });
}

}  // namespace adit
