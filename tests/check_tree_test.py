#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
"""Each rule of check_tree.py is broken once, alone, and must be what is reported."""

import unittest

import check_tree

SPDX = "// SPDX-FileCopyrightText: 2026 The adit authors\n// SPDX-License-Identifier: Apache-2.0\n"
HEADER = SPDX + "#pragma once\n"
SOUND = {
    "engine/buffer.hpp": HEADER + "#include <cstdint>\n",
    "engine/buffer.cpp": SPDX + '#include "adit/engine/buffer.hpp"\n#include <vulkan/vulkan_raii.hpp>\n',
    "engine/kernels/scan.hpp": HEADER + '#include "adit/engine/buffer.hpp"\n#include "adit/shaders/shared/scan.h"\n',
    "slam/core/types.hpp": HEADER,
    "slam/odometry/odometry.hpp": HEADER + '#include "adit/engine/kernels/scan.hpp"\n#include "adit/slam/core/types.hpp"\n',
    "tools/commands/main.cpp": SPDX + '#include <iostream>\n#include "adit/slam/odometry/odometry.hpp"\n',
    "tests/slam/odometry_test.cpp": SPDX + '#include "adit/slam/odometry/odometry.hpp"\n',
    "shaders/shared/scan.h": SPDX + "#ifndef SCAN_H\n#define SCAN_H\n#endif\n",
    "shaders/scan.comp": SPDX + '#version 460\n#include "adit/shaders/shared/scan.h"\n',
    "docs/page.md": "see [the header](../slam/odometry/odometry.hpp) and [docs](../docs)\n",
}


class CheckTree(unittest.TestCase):
    def expect(self, path, text, message):
        problems = check_tree.check({**SOUND, path: text})
        self.assertEqual(len(problems), 1, problems)
        self.assertIn(message, problems[0])

    def test_a_sound_tree_has_no_problem(self):
        self.assertEqual(check_tree.check(SOUND), [])

    def test_an_eighth_top_level_folder_is_found(self):
        self.expect("utils/a.hpp", HEADER, "not one of the top-level folders")

    def test_a_second_level_of_sub_folders_is_found(self):
        self.expect("slam/core/factors/a.hpp", HEADER, "more than one level")

    def test_a_file_of_501_lines_is_found(self):
        self.assertEqual(check_tree.check({**SOUND, "slam/core/a.cpp": SPDX + "\n" * 498}), [])
        self.expect("slam/core/a.cpp", SPDX + "\n" * 499, "501 lines")

    def test_a_missing_licence_line_is_found(self):
        self.expect("slam/core/a.cpp", SPDX.split("\n")[0] + "\n", "SPDX-License-Identifier")

    def test_a_missing_last_newline_is_found(self):
        self.expect("slam/core/a.cpp", SPDX + "int a;", "does not end with a newline")

    def test_trailing_white_space_is_found(self):
        self.expect("slam/core/a.cpp", SPDX + "int a; \n", "slam/core/a.cpp:3: white space")

    def test_a_machine_path_is_found(self):
        self.expect("slam/core/a.cpp", SPDX + "// in /" + "home/me/adit\n", "somebody's machine")

    def test_an_include_that_goes_up_a_layer_is_found(self):
        self.expect("engine/a.cpp", SPDX + '#include "adit/slam/odometry/odometry.hpp"\n', "may not use what lies above")
        self.expect("engine/a.cpp", SPDX + '#include "adit/engine/kernels/scan.hpp"\n', "may not use what lies above")

    def test_a_lower_group_that_includes_a_higher_one_is_found(self):
        self.expect("slam/core/a.hpp", HEADER + '#include "adit/slam/odometry/odometry.hpp"\n',
                    "slam/core may not use what lies above it")

    def test_a_long_line_of_text_is_found_and_one_of_a_table_or_of_code_is_not(self):
        long = "a word " * 20
        self.expect("docs/a.md", "# A\n" + long.strip() + "\n", "docs/a.md:2: 139 characters")
        self.assertEqual(check_tree.check({**SOUND, "docs/a.md": f"| {long.strip()} |\n```\n{long.strip()}\n```\n"}), [])

    def test_a_source_outside_of_the_groups_is_found(self):
        self.expect("slam/a.hpp", HEADER, "lies in none of the groups")

    def test_a_second_place_for_threads_is_found(self):
        self.expect("slam/core/a.cpp", SPDX + "#include <thread>\n", "threads are started in")
        self.assertEqual(check_tree.check({**SOUND, "slam/executor/live.cpp": SPDX + "#include <thread>\n"}), [])

    def test_an_include_that_is_not_from_the_root_is_found(self):
        self.expect("engine/a.cpp", SPDX + '#include "buffer.hpp"\n', "not \"adit/\" with a path")

    def test_an_include_of_a_test_is_found(self):
        self.expect("tools/run/a.cpp", SPDX + '#include "adit/tests/slam/odometry_test.cpp"\n', "may not use what lies above")

    def test_vulkan_outside_the_engine_is_found(self):
        self.expect("engine/kernels/a.cpp", SPDX + "#include <vulkan/vulkan.h>\n", "only engine/")

    def test_a_library_outside_its_file_is_found(self):
        self.expect("slam/gnss/world_fit.cpp", SPDX + "#include <GeographicLib/UTMUPS.hpp>\n", "only slam/gnss/world_frame.cpp")
        self.expect("slam/graph/pose_graph.hpp", HEADER + "#include <ceres/ceres.h>\n", "only slam/graph/solver.cpp")
        self.assertEqual(check_tree.check({**SOUND, "slam/graph/solver.cpp": SPDX + "#include <ceres/ceres.h>\n"}), [])

    def test_boost_outside_of_the_server_is_found(self):
        self.expect("tools/viewer/view_data.cpp", SPDX + "#include <boost/beast.hpp>\n", "only tools/publishing/status_server.cpp and tools/viewer/view_server.cpp do")

    def test_a_page_has_sources_of_its_own(self):
        self.assertEqual(check_tree.check({**SOUND, "tools/viewer/page/view.ts": SPDX}), [])
        self.expect("tools/viewer/page/view.ts", "// SPDX-FileCopyrightText: 2026 A\n", "no 'SPDX-License")
        self.expect("tools/viewer/page/deep/view.ts", SPDX, "more than one level")

    def test_cli11_outside_its_file_is_found(self):
        self.expect("tools/commands/a.cpp", SPDX + "#include <CLI/CLI.hpp>\n", "only tools/cli/command_line.cpp")

    def test_a_variable_that_is_not_listed_is_found_and_one_that_nothing_reads(self):
        reads = {"tools/run/a.cpp": SPDX + 'auto a = std::getenv("ADIT_A");\nconst char* b[] = {"ADIT_B", "no ADIT_C"};\n',
                 "tools/run/b.cpp": SPDX + 'auto a = fs::temp_directory_path();\nconst char* c = "ADIT_C";\n'}
        page = "# A\n\n## The environment\n\n| variable | what |\n|---|---|\n| `ADIT_A`, `ADIT_B` | `ADIT_D` |\n| `TMPDIR` | b |\n"
        self.assertEqual(check_tree.check({**SOUND, **reads, "docs/running.md": page}), [])
        self.assertEqual(len(check_tree.check({**SOUND, **reads})), 3)
        for old, new, message in (("`ADIT_A`, ", "", "tools/run/a.cpp: reads ADIT_A, which is not in the table of docs/running.md"),
                                  ("`TMPDIR`", "`TMPDIR`, `ADIT_C`", "docs/running.md: lists ADIT_C, which nothing reads")):
            problems = check_tree.check({**SOUND, **reads, "docs/running.md": page.replace(old, new)})
            self.assertEqual(len(problems), 1, problems)
            self.assertIn(message, problems[0])

    def test_vulkan_through_a_header_is_found(self):
        tree = {**SOUND, "engine/vulkan/leak.hpp": HEADER + "#include <vulkan/vulkan.h>\n",
                "slam/core/a.cpp": SPDX + '#include "adit/engine/vulkan/leak.hpp"\n'}
        self.assertEqual(len(check_tree.check(tree)), 1)
        self.assertIn("slam/core/a.cpp: includes, through another header", check_tree.check(tree)[0])

    def test_printing_in_slam_is_found(self):
        self.expect("slam/core/a.cpp", SPDX + "#include <iostream>\n", "does not print")

        self.expect("slam/core/a.cpp", SPDX + "void f() { printf(\"a\"); }\n", "slam/core/a.cpp:3: 'printf('")
        self.assertEqual(check_tree.check({**SOUND, "slam/core/a.cpp": SPDX + "// std::cout\n// snprintf(\n"}), [])

    def test_ending_the_process_in_the_engine_is_found(self):
        self.expect("engine/a.cpp", SPDX + "void f() { std::abort(); }\n", "engine/a.cpp:3: 'std::abort('")

    def test_a_header_without_a_guard_is_found(self):
        self.expect("slam/core/a.hpp", SPDX, "neither #pragma once")

    def test_using_namespace_in_a_header_is_found(self):
        self.expect("slam/core/a.hpp", HEADER + "using namespace std;\n", "'using namespace'")

    def test_a_shader_that_includes_host_code_is_found(self):
        tree = {**SOUND, "shaders/embedded.hpp": HEADER}
        problems = check_tree.check({**tree, "shaders/a.comp": SPDX + '#include "adit/shaders/embedded.hpp"\n'})
        self.assertEqual(len(problems), 1, problems)
        self.assertIn("shaders include only", problems[0])

    def test_a_dead_link_is_found(self):
        self.expect("docs/b.md", "[gone](gone.md)\n", "links to gone.md")


if __name__ == "__main__":
    unittest.main()
